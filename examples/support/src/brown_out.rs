//! The brown-out reset of the STM32F405/407: its level stands in the option bytes, which keep it
//! without power (RM0090, 3.6 and 3.8).

use crate::registers::Registers;

/// FLASH_OPTKEYR, FLASH_SR and FLASH_OPTCR.
const OPTKEYR: u32 = 0x4002_3C08;
const SR: u32 = 0x4002_3C0C;
const OPTCR: u32 = 0x4002_3C14;

const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];

/// In FLASH_SR.
const BSY: u32 = 1 << 16;
/// In FLASH_OPTCR: lock, start, level.
const OPTLOCK: u32 = 1;
const OPTSTRT: u32 = 1 << 1;
const LEVEL: u32 = 3 << 2;

/// Looks at the status before the flash has failed; a change takes up to a second (data sheet).
const PATIENCE: u32 = 100_000_000;

/// Level 1 to 3 of the option bytes, from the word of FLASH_OPTCR; 3 is the highest, none is off.
#[must_use]
pub const fn brown_out_level(optcr: u32) -> Option<u8> {
    match (optcr >> 2) & 3 {
        0 => Some(3),
        1 => Some(2),
        2 => Some(1),
        _ => None,
    }
}

/// What became of the level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// It was so already; nothing was written.
    Kept,
    /// It was written, and counts from the next start on.
    Written,
    /// The chip did not take it: its option bytes are protected, or the flash is busy or broken.
    Refused,
}

/// Sets the level, 1 to 3, where it is another one; no other bit of the option bytes changes.
pub fn set_brown_out_level(registers: &mut impl Registers, level: u8) -> Setting {
    if brown_out_level(registers.read(OPTCR)) == Some(level) {
        return Setting::Kept;
    }
    if !(1..=3).contains(&level) || !idle(registers) {
        return Setting::Refused;
    }
    for key in KEYS {
        registers.write(OPTKEYR, key);
    }
    let before = registers.read(OPTCR);
    if before & OPTLOCK == 0 {
        let word = (before & !LEVEL) | (u32::from(3 - level) << 2);
        registers.write(OPTCR, word);
        registers.write(OPTCR, word | OPTSTRT);
    }
    let done = idle(registers);
    let now = registers.read(OPTCR);
    registers.write(OPTCR, (now & !OPTSTRT) | OPTLOCK);
    if done && brown_out_level(now) == Some(level) {
        Setting::Written
    } else {
        Setting::Refused
    }
}

fn idle(registers: &mut impl Registers) -> bool {
    (0..PATIENCE).any(|_| registers.read(SR) & BSY == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The option bytes behind their lock: writes count after both keys only, the start bit takes
    /// over what was written before it, and a wrong key locks until the next reset.
    #[derive(Clone, Debug)]
    struct Flash {
        /// What is kept without power.
        kept: u32,
        register: u32,
        keys: usize,
        dead: bool,
        busy: u32,
        programmed: u32,
    }

    /// The reset value: brown-out off, locked, no protection.
    const BLANK: u32 = 0x0FFF_AAED;

    impl Flash {
        const fn new(kept: u32) -> Self {
            Self {
                kept,
                register: kept | OPTLOCK,
                keys: 0,
                dead: false,
                busy: 0,
                programmed: 0,
            }
        }
    }

    impl Registers for Flash {
        fn read(&mut self, address: u32) -> u32 {
            match address {
                SR => {
                    self.busy = self.busy.saturating_sub(1);
                    if self.busy > 0 { BSY } else { 0 }
                }
                OPTCR => self.register,
                other => panic!("{other:x}"),
            }
        }

        fn write(&mut self, address: u32, word: u32) {
            assert_eq!(self.busy, 0, "a write while the flash is busy");
            match address {
                OPTKEYR => {
                    self.dead |= KEYS.get(self.keys) != Some(&word);
                    self.keys += 1;
                    if self.keys == 2 && !self.dead {
                        self.register &= !OPTLOCK;
                    }
                }
                OPTCR if self.register & OPTLOCK == 0 => {
                    let before = core::mem::replace(&mut self.register, word);
                    if word & OPTSTRT != 0 {
                        self.kept = before & !(OPTSTRT | OPTLOCK);
                        self.busy = 50;
                        self.programmed += 1;
                    }
                }
                OPTCR => {}
                other => panic!("{other:x}"),
            }
        }

        fn write_byte(&mut self, address: u32, _: u8) {
            panic!("{address:x}");
        }
    }

    #[test]
    fn levels_count_downwards() {
        assert_eq!(brown_out_level(BLANK), None);
        assert_eq!(brown_out_level(0x0FFF_AAE9), Some(1));
        assert_eq!(brown_out_level(0x0FFF_AAE5), Some(2));
        assert_eq!(brown_out_level(0x0FFF_AAE1), Some(3));
    }

    #[test]
    fn the_level_is_written_once_and_nothing_else_changes() {
        for level in 1..=3 {
            let mut flash = Flash::new(BLANK);
            assert_eq!(set_brown_out_level(&mut flash, level), Setting::Written);
            assert_eq!(brown_out_level(flash.kept), Some(level));
            let others = !(LEVEL | OPTLOCK | OPTSTRT);
            assert_eq!(flash.kept & others, BLANK & others);
            assert_eq!(
                flash.register & (OPTLOCK | OPTSTRT),
                OPTLOCK,
                "locked again"
            );
            // The next start finds it and leaves the flash alone.
            let mut flash = Flash::new(flash.kept);
            assert_eq!(set_brown_out_level(&mut flash, level), Setting::Kept);
            assert_eq!((flash.programmed, flash.keys), (0, 0));
        }
    }

    #[test]
    fn option_bytes_that_cannot_be_changed_are_left_as_they_are() {
        let mut protected = Flash::new(BLANK);
        protected.dead = true;
        assert_eq!(set_brown_out_level(&mut protected, 3), Setting::Refused);
        assert_eq!((protected.kept, protected.programmed), (BLANK, 0));
        for level in [0, 4, 255] {
            let mut flash = Flash::new(BLANK);
            assert_eq!(set_brown_out_level(&mut flash, level), Setting::Refused);
            assert_eq!((flash.kept, flash.keys), (BLANK, 0));
        }
    }
}
