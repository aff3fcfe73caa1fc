//! A pulse width whose zero counts at once, on TIM4 of the STM32F405/407.

use embedded_hal::pwm::{ErrorType, SetDutyCycle};

use crate::registers::Registers;
use crate::safe_output::stop_pulse;

/// The pulse width of a timer that takes a compare value over when its period ends, as channel 1 of
/// TIM4 does under the HAL: zero is written and taken over in the call.
///
/// A valve whose direction changes behind it has no pulse of the old width then.
#[derive(Debug)]
pub struct PromptZero<P, R> {
    pulse: P,
    registers: R,
}

impl<P: SetDutyCycle, R: Registers> PromptZero<P, R> {
    /// The channel of the HAL, and the registers of its chip.
    pub const fn new(pulse: P, registers: R) -> Self {
        Self { pulse, registers }
    }
}

impl<P: SetDutyCycle, R> ErrorType for PromptZero<P, R> {
    type Error = P::Error;
}

impl<P: SetDutyCycle, R: Registers> SetDutyCycle for PromptZero<P, R> {
    fn max_duty_cycle(&self) -> u16 {
        self.pulse.max_duty_cycle()
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), P::Error> {
        self.pulse.set_duty_cycle(duty)?;
        if duty == 0 {
            stop_pulse(&mut self.registers);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;
    use core::convert::Infallible;

    use embedded_hal::digital::{self, OutputPin};
    use trendid::hardware::{PwmValve, Valve};

    use super::*;
    use crate::random::Random;

    /// A timer that buffers its compare value, and the direction beside it.
    #[derive(Default)]
    struct Timer {
        compare: Cell<u32>,
        in_force: Cell<u32>,
        forward: Cell<bool>,
    }

    struct Channel<'a>(&'a Timer);
    struct Direction<'a>(&'a Timer);
    struct Chip<'a>(&'a Timer);

    impl ErrorType for Channel<'_> {
        type Error = Infallible;
    }

    impl SetDutyCycle for Channel<'_> {
        fn max_duty_cycle(&self) -> u16 {
            4200
        }

        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            self.0.compare.set(duty.into());
            Ok(())
        }
    }

    impl digital::ErrorType for Direction<'_> {
        type Error = Infallible;
    }

    impl Direction<'_> {
        fn set(&self, forward: bool) -> Result<(), Infallible> {
            let Timer {
                in_force,
                forward: now,
                ..
            } = self.0;
            assert!(
                in_force.get() == 0 || now.get() == forward,
                "a pulse of the wrong sign"
            );
            now.set(forward);
            Ok(())
        }
    }

    impl OutputPin for Direction<'_> {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.set(false)
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.set(true)
        }
    }

    impl Registers for Chip<'_> {
        fn read(&mut self, address: u32) -> u32 {
            panic!("{address:x}");
        }

        fn write(&mut self, address: u32, word: u32) {
            match address {
                0x4000_0834 => self.0.compare.set(word),
                0x4000_0814 => self.0.in_force.set(self.0.compare.get()),
                other => panic!("{other:x}"),
            }
        }

        fn write_byte(&mut self, address: u32, _: u8) {
            panic!("{address:x}");
        }
    }

    #[test]
    fn no_pulse_has_the_wrong_sign_on_a_timer_that_buffers() {
        let timer = Timer::default();
        let pulse = PromptZero::new(Channel(&timer), Chip(&timer));
        let mut valve = PwmValve::new(pulse, Direction(&timer));
        let mut dice = Random::new(7);
        for _ in 0..1000 {
            let command = 2.0 * dice.unit() - 1.0;
            let set = valve.drive(command).unwrap();
            assert!((set - command).abs() < 1e-3);
            // The period ends before the next command.
            timer.in_force.set(timer.compare.get());
            let sign = if timer.forward.get() { 1.0 } else { -1.0 };
            let flow = sign * timer.in_force.get() as f32 / 4200.0;
            assert!((flow - set).abs() < 1e-6);
        }
        assert!(valve.safe().is_ok() && timer.in_force.get() == 0);
    }
}
