//! The independent watchdog of the STM32F405/407 with another period while it runs (RM0090, 21.3
//! and 21.4).
//!
//! A period goes over into the domain of the slow oscillator, which takes some of its cycles.
//! Meanwhile another one is not taken, and a reload begins the period before.

use crate::registers::Registers;

/// IWDG_KR, IWDG_PR, IWDG_RLR and IWDG_SR.
const KR: u32 = 0x4000_3000;
const PR: u32 = 0x4000_3004;
const RLR: u32 = 0x4000_3008;
const SR: u32 = 0x4000_300C;

const ACCESS: u32 = 0x5555;
const RELOAD: u32 = 0xAAAA;
const START: u32 = 0xCCCC;

/// In IWDG_SR: prescaler and reload value are on their way.
const UPDATING: u32 = 3;

/// Largest reload value.
const LONGEST: u32 = 0xFFF;

/// Looks at the status before the oscillator has failed: five of its cycles are 0.3 ms at most.
const PATIENCE: u32 = 20_000;

/// Prescaler and reload value of a period in ms: in ms up to 4 s, in 8 ms up to 32 s.
const fn count(ms: u32) -> (u32, u32) {
    let (prescaler, counts) = if ms <= LONGEST { (3, ms) } else { (6, ms / 8) };
    let counts = if counts > LONGEST { LONGEST } else { counts };
    (prescaler, counts.saturating_sub(1))
}

/// Starts the watchdog, or lets it go on, with this period in ms at 32 kHz, which begins now;
/// whether the chip has taken it.
///
/// Waits for the oscillator, 0.6 ms at most: not while the axis moves.
pub fn set_period(registers: &mut impl Registers, ms: u32) -> bool {
    // Without its oscillator nothing goes over.
    registers.write(KR, START);
    let before = settled(registers);
    let (prescaler, reload) = count(ms);
    registers.write(KR, ACCESS);
    registers.write(PR, prescaler);
    registers.write(RLR, reload);
    let taken = settled(registers);
    registers.write(KR, RELOAD);
    before && taken
}

fn settled(registers: &mut impl Registers) -> bool {
    (0..PATIENCE).any(|_| registers.read(SR) & UPDATING == 0)
}

/// Shortest time in ms that is left of a period: the oscillator has 17 to 47 kHz (data sheet).
#[must_use]
pub const fn at_least(ms: u32) -> u32 {
    ms / 47 * 32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The registers and their other half behind the oscillator.
    #[derive(Debug)]
    struct Double {
        runs: bool,
        dead: bool,
        unlocked: bool,
        /// Looks at the status until a register has gone over.
        left: [u32; 2],
        written: [u32; 2],
        in_force: [u32; 2],
        /// What the counter began with.
        period: u32,
    }

    impl Double {
        const fn new() -> Self {
            Self {
                runs: false,
                dead: false,
                unlocked: false,
                left: [0; 2],
                written: [0, LONGEST],
                in_force: [0, LONGEST],
                period: 0,
            }
        }

        fn take(&mut self, place: usize, word: u32) {
            if self.unlocked && self.left[place] == 0 {
                self.written[place] = word;
                self.left[place] = 40;
            }
        }
    }

    impl Registers for Double {
        fn read(&mut self, address: u32) -> u32 {
            assert_eq!(address, SR);
            let mut status = 0;
            for place in 0..2 {
                if self.left[place] == 0 {
                    continue;
                }
                status |= 1 << place;
                if self.runs && !self.dead {
                    self.left[place] -= 1;
                    if self.left[place] == 0 {
                        self.in_force[place] = self.written[place];
                    }
                }
            }
            status
        }

        fn write(&mut self, address: u32, word: u32) {
            match (address, word) {
                (KR, key) => {
                    self.unlocked = key == ACCESS;
                    self.runs |= key == START;
                    if key == RELOAD {
                        let [prescaler, reload] = self.in_force;
                        self.period = (reload + 1) * (4 << prescaler) / 32;
                    }
                }
                (PR, word) => self.take(0, word),
                (RLR, word) => self.take(1, word),
                other => panic!("a register that nobody asked for: {other:x?}"),
            }
        }

        fn write_byte(&mut self, address: u32, _: u8) {
            panic!("{address:x}");
        }
    }

    #[test]
    fn each_period_is_in_force_when_it_was_set_however_soon_after_another() {
        let mut double = Double::new();
        for ms in [100, 10_000, 10, 500, 10, 4095, 4096, 10, 32_000, 1] {
            assert!(set_period(&mut double, ms));
            assert_eq!(double.period, ms);
        }
        assert!(set_period(&mut double, u32::MAX) && double.period == 32_760);
    }

    #[test]
    fn an_oscillator_that_does_not_start_is_not_waited_for() {
        let mut double = Double::new();
        double.dead = true;
        assert!(!set_period(&mut double, 10));
        assert!(double.runs);
    }

    #[test]
    fn a_quick_oscillator_leaves_less() {
        assert!(at_least(47_000) == 32_000 && at_least(0) == 0);
    }
}
