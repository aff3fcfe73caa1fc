//! The motion in which control begins, and the rest in which a commissioning does.

use crate::hardware::{PositionSensor, Valve};
use crate::math::sqrt;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::servo_loop::takeover::Halt;
use crate::servo::supervision::state::{Reason, State};

/// Time over that in which an axis loses its speed, after which one that still moves drifts or
/// cycles.
const HALT_MOST: u32 = 12;
/// Speed that a load and the place may give a drive over that of its model, as for the monitors.
const FASTEST: f32 = 1.3;
/// Grains of the sensor by which the positions of an axis that stands differ.
const STANDS: f32 = 3.0;

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// The motion with which control can begin on a model: the observed one in control, else what
    /// the measured positions show of it beyond the resolution of the sensor and its `noise`;
    /// `None` where readings that were off have left what no drive has.
    pub(crate) fn present_motion(&self, model: &Model, noise: f32) -> Option<Motion> {
        if self.observes() {
            Some(self.controller.motion())
        } else {
            self.measured_motion(model, noise)
        }
    }

    /// Outside of control nobody judges the readings. Of one that was off the filter makes a motion
    /// that no drive has, later one that it might have, and control would follow it.
    ///
    /// With `v'' + a2 v' + a1 v = b0 q` and speeds up to the fastest one, V, the jerk is at most
    /// `b0 + a1 V + a2 V sqrt(a1)`, and the filter is behind the reading by that over its rate
    /// cubed: so much in front of it, too. What has been within that, and is no faster than V, is a
    /// motion of the drive for all that can be known.
    fn measured_motion(&self, model: &Model, noise: f32) -> Option<Motion> {
        let grain = self.grain(noise);
        let seen = self.moves.tracking.significant(grain);
        let y = self.sensed.position;
        let rate = self.moves.tracking.rate();
        let fastest = FASTEST * model.b0 / model.a1;
        let jerk = model.b0 + fastest * (model.a1 + model.a2 * sqrt(model.a1));
        let behind = jerk / (rate * rate * rate) + STANDS * grain;
        let astray = (y - seen.position).abs() > behind || self.moves.astray > behind;
        (seen.velocity.abs() <= fastest && !astray).then_some(Motion {
            position: y,
            ..seen
        })
    }

    /// What one code of the sensor and its noise leave unknown of a position.
    fn grain(&self, noise: f32) -> f32 {
        self.axis.resolution() + 2.0 * noise
    }

    /// Standard deviation of the position: stated, found, or what is taken for it before.
    pub(crate) fn noise(&self) -> f32 {
        self.config.noise_beside(self.drive.noise)
    }

    /// Whether control was asked for before anybody knew how the axis moves: its valve is in its
    /// middle until that is known.
    #[inline]
    pub(crate) const fn awaits_motion(&self) -> bool {
        self.moves.unsettled > 0 && self.supervisor.state().is_controlling()
    }

    /// Whether the observer of the controller knows the motion; else that is for the filter of the
    /// measured positions.
    pub(crate) const fn observes(&self) -> bool {
        self.supervisor.state().is_controlling() && self.moves.unsettled == 0
    }

    /// Whether a commissioning waits: an axis in motion has to come to rest. In control its
    /// reference does, where an excitation has room to both ends: a verified model leads it there
    /// as none of the stages could. The monitors see to it that the axis follows. Without control
    /// the valve closes.
    ///
    /// It stands when it stays about a place for the time in which a swing behind a closed valve
    /// ends: a swing, or what is left of an error, passes for an answer to the commands to come.
    /// One that does not come to rest does not put off what was asked for.
    #[cold]
    #[inline(never)]
    pub(crate) fn comes_to_rest(&mut self) -> bool {
        let grain = self.grain(self.noise());
        let y = self.sensed.position;
        let state = self.supervisor.state();
        let unknown = self.awaits_motion();
        let controls = state.is_controlling() && !unknown;
        let arrived = !controls || self.moves.trajectory.is_finished();
        let middles = self.commissioning.middles();
        let bounds = self.guard.monitors.bounds();
        let most = bounds.stop.closing;
        let halt = &mut self.takeover.halt;
        let waits = match halt.since {
            0 => {
                let speed = self.moves.tracking.significant(grain).velocity;
                let inside = !controls || middles.contains(y);
                let slow = speed.abs() <= self.config.min_speed();
                unknown || !(arrived && inside && slow)
            }
            since => halt.stood < most && since < HALT_MOST.saturating_mul(most),
        };
        if !waits {
            *halt = Halt::default();
            return false;
        }
        if halt.since == 0 && controls {
            self.moves.trajectory.stop(&middles);
        }
        if halt.since == 0 || arrived {
            halt.since = halt.since.saturating_add(1);
        }
        let time = most as f32 * self.config.sample_time;
        let slip = self.config.creep() * time + STANDS * grain;
        if arrived && (y - halt.place).abs() <= slip {
            halt.stood += 1;
        } else {
            (halt.place, halt.stood) = (y, 0);
        }
        if state.is_commissioning() {
            self.supervisor.abort();
        }
        true
    }

    /// The state, which is that of a commissioning from the request on.
    #[inline]
    pub(crate) const fn reported_state(&self) -> State {
        if self.start_requested && self.takeover.halt.since > 0 {
            State::Exciting
        } else {
            self.supervisor.state()
        }
    }

    /// One sample in which control awaits the motion; it begins with the last one. What no drive
    /// has counts as rest by then: readings may be off for ever.
    #[cold]
    #[inline(never)]
    pub(crate) fn watch_motion(&mut self) {
        self.moves.settle();
        if self.moves.unsettled > 0 {
            return;
        }
        let Some(model) = self.supervisor.verified_model() else {
            return;
        };
        let measured = self.measured_motion(&model, self.noise());
        let motion = measured.unwrap_or(Motion::at(self.sensed.position));
        if self.config.travel.admits(motion.position).is_ok() {
            return self.take_over(model, motion);
        }
        match self.start_requested {
            // A commissioning may begin there.
            true => self.supervisor.abort(),
            false => self.fail(Reason::Implausible),
        }
    }
}
