//! Valve driven by pulse width and a direction pin.

use embedded_hal::digital::{OutputPin, PinState};
use embedded_hal::pwm::SetDutyCycle;

use super::{Valve, limited};

/// Which part of the output failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PwmError<P, D> {
    /// The pulse width.
    Pulse(P),
    /// The direction pin.
    Direction(D),
}

/// A proportional valve on a bridge with a PWM and a direction input; direction high is a positive
/// command.
///
/// The command is rounded to the steps of the timer and the rounded value is returned, so that the
/// identifier sees the command that was set. The pulse is taken to zero before the direction
/// changes: no pulse ever has the wrong sign, where a width of zero counts when it is set. A timer
/// that takes a width over at the end of its period keeps the old one until then; `examples/servo`
/// ends that period (`examples/support/src/pulse.rs`).
#[derive(Debug)]
pub struct PwmValve<P, D> {
    pulse: P,
    direction: D,
    forward: Option<bool>,
}

impl<P: SetDutyCycle, D: OutputPin> PwmValve<P, D> {
    /// A valve whose output is not touched before the first command.
    pub fn new(pulse: P, direction: D) -> Self {
        Self {
            pulse,
            direction,
            forward: None,
        }
    }

    /// Gives the outputs back.
    pub fn release(self) -> (P, D) {
        (self.pulse, self.direction)
    }
}

impl<P: SetDutyCycle, D: OutputPin> Valve for PwmValve<P, D> {
    type Error = PwmError<P::Error, D::Error>;

    fn drive(&mut self, command: f32) -> Result<f32, Self::Error> {
        let command = limited(command);
        let full = f32::from(self.pulse.max_duty_cycle());
        // A conversion saturates and never wraps; one half makes it round.
        let duty = (command.abs() * full + 0.5) as u16;
        let forward = command >= 0.0;
        if duty != 0 && self.forward != Some(forward) {
            self.pulse.set_duty_cycle(0).map_err(PwmError::Pulse)?;
            // Of a pin that fails it is not known.
            self.forward = None;
            self.direction
                .set_state(PinState::from(forward))
                .map_err(PwmError::Direction)?;
            self.forward = Some(forward);
        }
        self.pulse.set_duty_cycle(duty).map_err(PwmError::Pulse)?;
        // A timer without steps can set nothing.
        let set = if duty == 0 {
            0.0
        } else {
            f32::from(duty) / full
        };
        Ok(if forward { set } else { -set })
    }
}

#[cfg(test)]
mod tests {
    use embedded_hal_mock::eh1::MockError;
    use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Set};
    use embedded_hal_mock::eh1::pwm::{Mock as Pulse, Transaction as Duty};

    use super::*;

    fn check(pulses: &[Duty], pins: &[Set], run: impl FnOnce(&mut PwmValve<Pulse, Pin>)) {
        let mut pulse = Pulse::new(pulses);
        let mut pin = Pin::new(pins);
        run(&mut PwmValve::new(pulse.clone(), pin.clone()));
        pulse.done();
        pin.done();
    }

    #[test]
    fn the_direction_changes_only_without_pulse() {
        check(
            &[
                Duty::max_duty_cycle(1000),
                Duty::set_duty_cycle(0),
                Duty::set_duty_cycle(250),
                Duty::max_duty_cycle(1000),
                Duty::set_duty_cycle(500),
                Duty::max_duty_cycle(1000),
                Duty::set_duty_cycle(0),
                Duty::set_duty_cycle(1000),
            ],
            &[Set::set(State::High), Set::set(State::Low)],
            |valve| {
                assert_eq!(valve.drive(0.25), Ok(0.25));
                assert_eq!(valve.drive(0.5), Ok(0.5), "no change, no gap");
                assert_eq!(valve.drive(-7.0), Ok(-1.0), "limited");
            },
        );
    }

    #[test]
    fn what_was_set_is_what_is_returned() {
        check(
            &[
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
                Duty::set_duty_cycle(3),
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
            ],
            &[Set::set(State::Low)],
            |valve| {
                assert_eq!(valve.drive(-0.26), Ok(-0.3));
                assert_eq!(valve.drive(0.04), Ok(0.0), "below one step");
            },
        );
    }

    #[test]
    fn no_number_and_safe_are_no_pulse() {
        check(
            &[
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
            ],
            &[],
            |valve| {
                assert_eq!(valve.drive(f32::NAN), Ok(0.0));
                assert_eq!(valve.safe(), Ok(()));
            },
        );
    }

    #[test]
    fn errors_name_the_part() {
        let error = || MockError::Io(super::super::std::io::ErrorKind::NotConnected);
        check(
            &[
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0).with_error(error()),
            ],
            &[],
            |valve| assert_eq!(valve.drive(1.0), Err(PwmError::Pulse(error()))),
        );
        check(
            &[Duty::max_duty_cycle(10), Duty::set_duty_cycle(0)],
            &[Set::set(State::High).with_error(error())],
            |valve| assert_eq!(valve.drive(1.0), Err(PwmError::Direction(error()))),
        );
    }

    /// The pin may have taken the level and reported an error nevertheless.
    #[test]
    fn a_direction_that_is_not_known_is_set_again() {
        let error = || MockError::Io(super::super::std::io::ErrorKind::NotConnected);
        check(
            &[
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
                Duty::set_duty_cycle(10),
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
                Duty::max_duty_cycle(10),
                Duty::set_duty_cycle(0),
                Duty::set_duty_cycle(10),
            ],
            &[
                Set::set(State::High),
                Set::set(State::Low).with_error(error()),
                Set::set(State::High),
            ],
            |valve| {
                assert_eq!(valve.drive(1.0), Ok(1.0));
                assert_eq!(valve.drive(-1.0), Err(PwmError::Direction(error())));
                assert_eq!(valve.drive(1.0), Ok(1.0));
            },
        );
    }
}
