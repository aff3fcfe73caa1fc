//! The requests of the user.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::design::constants::REOPENED_STD;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::servo_loop::ServoLoop;

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// Takes a model that is known to be good: control begins with the next sample, at the actual
    /// position. Searches the poles at once, some million instructions: not for the 1 ms path.
    ///
    /// How stiff the axis is near its ends is no part of a [`Model`]: it is that of the settings
    /// ([`dead_volume`](crate::servo::ControllerSettings::dead_volume)), or of a commissioning
    /// before.
    ///
    /// # Errors
    /// [`Error::Model`] with the reason, when it does not pass what every candidate must: finite,
    /// of the right sign, stable, in range of the settings.
    pub fn install(&mut self, model: Model) -> Result<(), Error> {
        self.supervisor.install(model).map_err(Error::Model)?;
        self.stop_building();
        self.start_requested = false;
        self.controller.search(&model);
        self.take_over(model, Motion::at(self.sensed.position));
        self.identify_from(&model, REOPENED_STD);
        Ok(())
    }

    /// Commissions the axis with the next sample, around the position it then has.
    pub fn commission(&mut self) {
        self.start_requested = true;
    }

    /// Stops commissioning or control: the valve closes at its rate limit, the verified model is
    /// kept.
    pub fn abort(&mut self) {
        self.start_requested = false;
        self.supervisor.abort();
    }

    /// Moves to `target`, limited to the travel, as fast as the limits of motion allow; may be
    /// called in any sample, in motion too: it begins where the motion then is.
    ///
    /// # Errors
    /// [`Error::Setting`] for NaN and infinity; the reference goes on as before.
    pub fn move_to(&mut self, target: f32) -> Result<(), Error> {
        self.moves.trajectory.move_to(target)
    }

    /// Oscillates with `frequency` in Hz about the present reference, in motion about the place
    /// where it comes to rest; the amplitude grows over one period, over two or four where the
    /// limits of motion require it.
    ///
    /// # Errors
    /// [`Error::Setting`], with the largest amplitude or frequency for which travel and limits of
    /// motion have room; the reference goes on as before.
    pub fn oscillate(&mut self, amplitude: f32, frequency: f32) -> Result<(), Error> {
        self.moves.trajectory.oscillate(amplitude, frequency)
    }
}
