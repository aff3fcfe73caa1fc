//! Instructions (in the emulator) or cycles (on a board) between two points.
//!
//! QEMU with `-icount shift=0` executes one instruction per nanosecond of its clock, and models no
//! pipeline, no flash wait states and no cycle counter. A counter of the emulated chip therefore
//! counts instructions:
//!
//! | counter | ticks per instruction | resolution |
//! |---|---|---|
//! | SysTick of any core | 0.168 at 168 MHz | 6 instructions |
//! | TIM2 of the STM32F405, which QEMU clocks with 1 GHz | 1 | 1 instruction |
//! | DWT cycle counter | stands still in QEMU; on a board the cycles | 1 cycle |
//!
//! The ratio of each counter is measured in the same run on a loop of two instructions.

use core::arch::asm;
use core::fmt;

use cortex_m::Peripherals;
use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// Passes of the calibration loop.
const PASSES: u32 = 50_000;

/// What a [`Clock`] counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Executed instructions, in the emulator.
    Instructions,
    /// Processor cycles, on a board.
    Cycles,
}

/// The counter with the finest resolution that runs.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    now: fn() -> u32,
    mask: u32,
    /// Units per tick.
    scale: f32,
    /// Name of the counter.
    pub name: &'static str,
    /// What it counts.
    pub unit: Unit,
}

impl Clock {
    /// Starts all counters; gives the one to measure with and SysTick to compare it with.
    pub fn start(core: &mut Peripherals) -> [Self; 2] {
        cycles::start(core);
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(0xFF_FFFF);
        core.SYST.clear_current();
        core.SYST.enable_counter();
        timer::start();
        let before = cycles::now();
        passes(PASSES);
        let unit = if cycles::now() == before {
            Unit::Instructions
        } else {
            Unit::Cycles
        };
        // SysTick counts down.
        let systick = Self::calibrated(|| !SYST::get_current(), 0xFF_FFFF, "SysTick", unit);
        let fine = match unit {
            Unit::Cycles => Self::calibrated(cycles::now, u32::MAX, "DWT", unit),
            Unit::Instructions if timer::PRESENT => {
                Self::calibrated(timer::now, u32::MAX, "TIM2", unit)
            }
            Unit::Instructions => systick,
        };
        [fine, systick]
    }

    fn calibrated(now: fn() -> u32, mask: u32, name: &'static str, unit: Unit) -> Self {
        let mut clock = Self {
            now,
            mask,
            scale: 1.0,
            name,
            unit,
        };
        let short = clock.ticks(|| passes(PASSES));
        let long = clock.ticks(|| passes(2 * PASSES));
        // Two instructions a pass; the ends of both measurements cancel. A board counts its cycles
        // as they are.
        if unit == Unit::Instructions {
            clock.scale = 2.0 * PASSES as f32 / (long - short) as f32;
        }
        clock
    }

    /// Ticks per unit: 1 for a counter of instructions.
    pub fn rate(&self) -> f32 {
        1.0 / self.scale
    }

    /// Ticks that `work` takes, the reading included.
    #[inline(always)]
    pub fn ticks<R>(&self, work: impl FnOnce() -> R) -> u32 {
        let start = (self.now)();
        let _ = core::hint::black_box(work());
        (self.now)().wrapping_sub(start) & self.mask
    }

    /// Instructions or cycles of a number of ticks.
    pub fn units(&self, ticks: f32) -> f32 {
        ticks * self.scale
    }
}

impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // By integers: what writes a float takes 20 kB.
        let rate = (1e4 * self.rate() + 0.5) as u32;
        write!(
            f,
            "{}: {}.{:04} ticks per unit of {:?}",
            self.name,
            rate / 10_000,
            rate % 10_000,
            self.unit
        )
    }
}

/// A loop of two instructions.
#[inline(never)]
fn passes(count: u32) {
    // SAFETY: the loop changes its counter register and the flags only.
    unsafe {
        asm!("2:", "subs {0}, #1", "bne 2b", inout(reg) count => _, options(nomem, nostack));
    }
}

/// The cycle counter of the core.
#[cfg(target_has_atomic = "32")]
mod cycles {
    use cortex_m::{Peripherals, peripheral::DWT};

    pub(crate) fn start(core: &mut Peripherals) {
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
    }

    pub(crate) fn now() -> u32 {
        DWT::cycle_count()
    }
}

/// A Cortex-M0 has no cycle counter, which shows in that it has no atomic exchange either.
#[cfg(not(target_has_atomic = "32"))]
mod cycles {
    pub(crate) fn start(_: &mut cortex_m::Peripherals) {}

    pub(crate) fn now() -> u32 {
        0
    }
}

/// TIM2 as a free-running 32-bit counter, by its registers (RM0090, section 18.4).
#[cfg(target_abi = "eabihf")]
mod timer {
    pub(crate) const PRESENT: bool = true;

    const RCC_APB1ENR: *mut u32 = 0x4002_3840 as *mut u32;
    const TIM2: *mut u32 = 0x4000_0000 as *mut u32;
    const CR1: usize = 0;
    const EGR: usize = 5;
    const CNT: usize = 9;
    const PSC: usize = 10;
    const ARR: usize = 11;

    pub(crate) fn start() {
        // SAFETY: addresses of registers of the STM32F405/407 that nothing else uses in these
        // images.
        unsafe {
            RCC_APB1ENR.write_volatile(RCC_APB1ENR.read_volatile() | 1);
            TIM2.add(ARR).write_volatile(u32::MAX);
            TIM2.add(PSC).write_volatile(0);
            TIM2.add(EGR).write_volatile(1);
            TIM2.add(CR1).write_volatile(1);
        }
    }

    pub(crate) fn now() -> u32 {
        // SAFETY: reading the counter has no side effect.
        unsafe { TIM2.add(CNT).read_volatile() }
    }
}

#[cfg(not(target_abi = "eabihf"))]
mod timer {
    pub(crate) const PRESENT: bool = false;

    pub(crate) fn start() {}

    pub(crate) fn now() -> u32 {
        0
    }
}
