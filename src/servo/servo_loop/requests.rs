//! The requests of the user.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::building::{carried_out, rough};
use crate::servo::design::constants::REOPENED_STD;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::motion::ends::EndApproach;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::servo_loop::takeover::Halt;

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// Takes a model that is known to be good: control begins with the next sample, with the motion
    /// that the axis then has, and lets it run out. Before the first reading and soon behind it
    /// nobody knows that motion, nor behind readings that were off: the valve is then in its middle
    /// until the readings show it, for less than 1/w of the axis. Searches the poles at once, some
    /// million instructions: not for the 1 ms path.
    ///
    /// What is no part of a [`Model`] is that of the settings, or of a commissioning before: the
    /// sign of the valve ([`reversed`](crate::servo::Config::reversed)), its delay, the noise, how
    /// stiff the axis is near its ends
    /// ([`dead_volume`](crate::servo::ControllerSettings::dead_volume)), and by what it is quicker
    /// one way ([`imbalance`](crate::servo::ControllerSettings::imbalance)). Of a stored model
    /// [`resume`](Self::resume) takes them from the record.
    ///
    /// An axis that stands a little beyond an end of its travel is led back to it, slowly. One that
    /// stands further out is not moved: before the first reading nobody knows, and control then
    /// ends with it in [`State::Failed`](crate::servo::State::Failed) with
    /// [`Reason::Implausible`](crate::servo::Reason::Implausible).
    ///
    /// # Errors
    /// [`Error::Model`] with the reason, when it does not pass what every candidate must: finite,
    /// of the right sign, stable, in range of the settings. [`Error::Setting`] with the position of
    /// an axis that stands beyond its travel by more than a hundredth of it; the loop is as before.
    pub fn install(&mut self, model: Model) -> Result<(), Error> {
        self.may_take_over()?;
        let motion = self.present_motion(&model, self.noise());
        self.install_in(model, motion)?;
        let w = self.config.bandwidth.unwrap_or(rough(&model));
        if let Ok(limits) = self.config.motion_limits(w) {
            let limits = carried_out(&self.config, limits, &model);
            self.moves.trajectory.limit(limits);
        }
        Ok(())
    }

    /// The same in a motion; one that is not known is awaited.
    pub(crate) fn install_in(&mut self, model: Model, motion: Option<Motion>) -> Result<(), Error> {
        self.supervisor.install(model).map_err(Error::Model)?;
        self.stop_building();
        self.start_requested = false;
        self.controller.search(&model);
        self.takeover.watching = 0;
        self.take_over(model, motion.unwrap_or(Motion::at(self.sensed.position)));
        if motion.is_none() {
            self.moves.disbelieve(self.config.sample_time);
        }
        self.identify_from(&model, REOPENED_STD);
        Ok(())
    }

    /// Commissions the axis with the next sample, around the position it then has; this
    /// acknowledges a fault before. An axis in motion first comes to rest: in control within the
    /// limits of motion, at a place with room to both ends, else behind the closed valve. It is
    /// reported as [`State::Exciting`](crate::servo::State::Exciting) from then on.
    ///
    /// While the sensor is lost there is no such position: the request does not wait for the
    /// sensor, it ends in [`State::Failed`](crate::servo::State::Failed) with
    /// [`Reason::SensorFault`](crate::servo::Reason::SensorFault), counted in
    /// [`FaultCounters::stops`](crate::servo::FaultCounters::stops). So does one whose sample finds
    /// a fault, with the reason of that.
    pub fn commission(&mut self) {
        if !self.start_requested {
            self.takeover.halt = Halt::default();
        }
        self.start_requested = true;
    }

    /// Stops commissioning or control, or the brake behind a fault: the valve closes at its rate
    /// limit, the verified model is kept.
    pub fn abort(&mut self) {
        self.start_requested = false;
        self.guard.release();
        self.supervisor.abort();
    }

    /// Moves to `target`, limited to the travel, as fast as the limits of motion allow; may be
    /// called in any sample, in motion too: it begins where the motion then is. Nearer to an end of
    /// the travel than the axis may be ahead of its reference it ends with a gentle brake.
    ///
    /// # Errors
    /// [`Error::NotControlling`] outside of control, and after [`install`](Self::install) or
    /// [`resume`](Self::resume) until the motion of the axis is known; [`Error::Setting`] for NaN
    /// and infinity. The reference goes on as before.
    pub fn move_to(&mut self, target: f32) -> Result<(), Error> {
        self.is_under_control()?;
        Error::unless_within("target", target, f32::MIN, f32::MAX)?;
        let bounds = self.guard.monitors.bounds();
        self.moves.trajectory.approach(EndApproach {
            time: 1.0 / bounds.frequency,
            speed: bounds.end_speed,
        });
        self.moves.trajectory.move_to(target)
    }

    /// Oscillates with `frequency` in Hz about the present reference, in motion about the place
    /// where it comes to rest; the amplitude grows over one period, over two or four where the
    /// limits of motion require it.
    ///
    /// # Errors
    /// [`Error::NotControlling`] as [`move_to`](Self::move_to); [`Error::Setting`], with the
    /// largest amplitude or frequency for which travel and limits of motion have room. The
    /// reference goes on as before.
    pub fn oscillate(&mut self, amplitude: f32, frequency: f32) -> Result<(), Error> {
        self.is_under_control()?;
        self.moves.trajectory.oscillate(amplitude, frequency)
    }

    /// Whether the axis stands where control may begin, as far as that is known.
    pub(crate) fn may_take_over(&self) -> Result<(), Error> {
        if self.sensed.begun {
            self.config.travel.admits(self.sensed.position)
        } else {
            Ok(())
        }
    }

    /// What control begins with replaces every reference before.
    const fn is_under_control(&self) -> Result<(), Error> {
        let begun = self.sensed.begun && !self.awaits_motion();
        let stays = begun && !self.start_requested;
        if stays && self.supervisor.state().is_controlling() {
            Ok(())
        } else {
            Err(Error::NotControlling)
        }
    }
}
