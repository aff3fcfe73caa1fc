//! Why the chip restarted: the flags of the STM32F405/407 as a cause (RM0090, RCC_CSR).

use crate::registers::Registers;

/// RCC_CSR, and its bit that clears the flags.
const CSR: u32 = 0x4002_3874;
const RMVF: u32 = 1 << 24;

/// A cause of a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The supply came.
    PowerOn,
    /// The supply fell below the level of the option bytes.
    BrownOut,
    /// The reset pin, and nothing else.
    Pin,
    /// The program or a debugger.
    Software,
    /// The independent watchdog was not fed.
    IndependentWatchdog,
    /// The window watchdog was not fed, or too early.
    WindowWatchdog,
    /// An entry into stop or standby that the option bytes forbid.
    LowPower,
    /// No flag, as in an emulator that does not model them.
    Unknown,
}

impl Cause {
    /// Every cause, in the order of the counters.
    pub const ALL: [Self; 8] = [
        Self::PowerOn,
        Self::BrownOut,
        Self::Pin,
        Self::Software,
        Self::IndependentWatchdog,
        Self::WindowWatchdog,
        Self::LowPower,
        Self::Unknown,
    ];

    /// The name in a log.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PowerOn => "power-on",
            Self::BrownOut => "brown-out",
            Self::Pin => "reset pin",
            Self::Software => "software",
            Self::IndependentWatchdog => "independent watchdog",
            Self::WindowWatchdog => "window watchdog",
            Self::LowPower => "low-power management",
            Self::Unknown => "unknown",
        }
    }

    /// The flag in RCC_CSR.
    const fn flag(self) -> u32 {
        match self {
            Self::BrownOut => 1 << 25,
            Self::Pin => 1 << 26,
            Self::PowerOn => 1 << 27,
            Self::Software => 1 << 28,
            Self::IndependentWatchdog => 1 << 29,
            Self::WindowWatchdog => 1 << 30,
            Self::LowPower => 1 << 31,
            Self::Unknown => 0,
        }
    }
}

/// The flags since they were cleared last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Causes(u32);

impl Causes {
    /// From the word of RCC_CSR.
    #[must_use]
    pub const fn from_csr(csr: u32) -> Self {
        Self(csr & 0xFE00_0000)
    }

    /// The flags where they stand in RCC_CSR.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether the flag of a cause is set.
    #[must_use]
    pub const fn contains(self, cause: Cause) -> bool {
        self.0 & cause.flag() != 0
    }

    /// Whether a watchdog is among the causes.
    #[must_use]
    pub const fn contain_watchdog(self) -> bool {
        self.contains(Cause::IndependentWatchdog) || self.contains(Cause::WindowWatchdog)
    }

    /// Whether there is a cause, and none that says that power was away.
    #[must_use]
    pub const fn kept_power(self) -> bool {
        self.0 != 0 && !self.contains(Cause::PowerOn) && !self.contains(Cause::BrownOut)
    }

    /// The cause behind the flags.
    ///
    /// Every reset pulls the pin and sets its flag, and a power-on sets that of the brown-out, so
    /// these two count only where nothing else is set.
    #[must_use]
    pub fn main(self) -> Cause {
        [
            Cause::PowerOn,
            Cause::IndependentWatchdog,
            Cause::WindowWatchdog,
            Cause::LowPower,
            Cause::Software,
            Cause::BrownOut,
            Cause::Pin,
        ]
        .into_iter()
        .find(|&cause| self.contains(cause))
        .unwrap_or(Cause::Unknown)
    }
}

/// Gives the flags to `keep` and clears them, which collect until then.
///
/// In this order: a reset in between counts one cause twice, where the other order loses it.
pub fn take<T>(registers: &mut impl Registers, keep: impl FnOnce(Causes) -> T) -> T {
    let word = registers.read(CSR);
    let kept = keep(Causes::from_csr(word));
    registers.write(CSR, word | RMVF);
    kept
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use super::*;

    /// RCC_CSR, whose flags go with its bit.
    struct Csr<'a>(&'a Cell<u32>);

    impl Registers for Csr<'_> {
        fn read(&mut self, address: u32) -> u32 {
            assert_eq!(address, CSR);
            self.0.get()
        }

        fn write(&mut self, address: u32, word: u32) {
            assert_eq!((address, word & RMVF), (CSR, RMVF));
            self.0.set(word & 3);
        }

        fn write_byte(&mut self, address: u32, _: u8) {
            panic!("{address:x}");
        }
    }

    #[test]
    fn the_flags_are_cleared_when_they_are_kept_and_no_sooner() {
        // The slow oscillator, which the watchdog runs on, stays on.
        let csr = Cell::new(0x2400_0003);
        let kept = take(&mut Csr(&csr), |causes| {
            assert_eq!(csr.get(), 0x2400_0003, "a reset would forget them");
            causes
        });
        assert!(kept.contain_watchdog() && csr.get() == 3);
        assert_eq!(take(&mut Csr(&csr), Causes::main), Cause::Unknown);
    }

    #[test]
    fn what_the_chip_sets_with_each_reset_is_one_cause() {
        // The flags that go together: the pin with each, the brown-out with the power-on.
        let cases = [
            (0x0E00_0000, Cause::PowerOn),
            (0x0600_0000, Cause::BrownOut),
            (0x0400_0000, Cause::Pin),
            (0x1400_0000, Cause::Software),
            (0x2400_0000, Cause::IndependentWatchdog),
            (0x4400_0000, Cause::WindowWatchdog),
            (0x8400_0000, Cause::LowPower),
            (0x0000_0000, Cause::Unknown),
        ];
        for (flags, cause) in cases {
            // The oscillator bits below and the clear bit do not matter.
            assert_eq!(Causes::from_csr(flags | 0x0100_0003).main(), cause);
        }
        assert!(
            Cause::ALL
                .iter()
                .all(|cause| cases.iter().any(|(_, other)| other == cause))
        );
    }

    #[test]
    fn flags_that_were_not_cleared_hide_no_watchdog() {
        let causes = Causes::from_csr(0x2E00_0000);
        assert_eq!(causes.main(), Cause::PowerOn);
        assert!(causes.contain_watchdog());
        assert!(Causes::from_csr(0x4400_0000).contain_watchdog());
        assert!(!Causes::from_csr(0x9E00_0000).contain_watchdog());
    }
}
