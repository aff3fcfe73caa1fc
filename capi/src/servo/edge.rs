//! Sensor and valve of a loop without callbacks: a code that is put in, a command that is taken
//! out.

use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::ServoLoop;
use trendid::servo::store::Identity;

use crate::memory::Inside;

/// The loop behind a `trendid_loop`.
pub(crate) type Servo = ServoLoop<Code, Output>;

/// What a `trendid_loop` holds.
pub(crate) struct Body {
    pub(crate) servo: Servo,
    /// What its records belong to, for the machine 0.
    pub(crate) identity: Identity,
}

impl Inside for Body {
    const MAGIC: u32 = 0x7E7E_7E7E;
}

/// The code that the caller read; `None` for a reading that failed.
pub(crate) struct Code(pub(crate) Option<i32>);

impl PositionSensor for Code {
    type Error = ();

    #[inline]
    fn counts(&mut self) -> Result<i32, ()> {
        self.0.ok_or(())
    }
}

/// The command that the caller writes to the valve after the sample.
pub(crate) struct Output {
    /// Steps of the output from zero to full command; 0 for an output without steps.
    pub(crate) steps: f32,
    /// Whether the caller reported that the valve does not answer.
    pub(crate) fault: bool,
}

impl Valve for Output {
    type Error = ();

    /// The command as the output will have it: within -1..=1, on a step, zero for NaN.
    #[inline]
    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        if self.fault {
            return Err(());
        }
        let command = if command > 1.0 {
            1.0
        } else if command >= -1.0 {
            command
        } else if command < -1.0 {
            -1.0
        } else {
            0.0
        };
        if self.steps <= 0.0 {
            return Ok(command);
        }
        let wanted = command * self.steps;
        let half = if wanted < 0.0 { -0.5 } else { 0.5 };
        Ok((wanted + half) as i32 as f32 / self.steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_limited_and_on_a_step() {
        let mut smooth = Output {
            steps: 0.0,
            fault: false,
        };
        for (command, set) in [(0.3, 0.3), (9.0, 1.0), (-9.0, -1.0), (f32::NAN, 0.0)] {
            assert_eq!(smooth.drive(command), Ok(set));
        }
        let mut coarse = Output {
            steps: 8.0,
            fault: false,
        };
        for (command, set) in [
            (0.3, 0.25),
            (-0.32, -0.375),
            (2.0, 1.0),
            (-2.0, -1.0),
            (0.05, 0.0),
        ] {
            assert_eq!(coarse.drive(command), Ok(set));
        }
        coarse.fault = true;
        assert_eq!(coarse.drive(0.0), Err(()));
    }
}
