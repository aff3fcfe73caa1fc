//! The run in the emulator that somebody watches: slots in real time, and what can be done to the
//! simulated drive.
//!
//! The timers of QEMU keep no period, SysTick does. Its interrupt asks for that of the slot, and
//! the slot timer stands still, so that no slot is late: how much time the emulator has is a
//! property of the computer. For the same reason only so many slots are made up for before the idle
//! loop has sent what they told; on a board it has most of every slot for that.

use core::sync::atomic::{AtomicI32, AtomicU8, Ordering};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SYST};
use cortex_m_rt::exception;
use stm32f4xx_hal::pac::Interrupt;
use trendid::hardware::{PositionSensor, Valve};
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_link::telemetry::Trick;

/// Clock of SysTick in QEMU, whatever the clock control says.
const EMULATED_HZ: u32 = 168_000_000;

const NOTHING: u8 = 0;
const FROZEN: u8 = 1;
const LOST: u8 = 2;
const CLOSED: u8 = 3;
const HEAVY: u8 = 4;

/// What is done to the drive.
static TRICK: AtomicU8 = AtomicU8::new(NOTHING);

/// The code that a frozen sensor shows.
static CODE: AtomicI32 = AtomicI32::new(0);

/// Calls the slot every ms from now on.
pub(crate) fn pace(timer: &mut SYST) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(EMULATED_HZ / 1000 - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}

/// Slots whose samples, and what else is told in them, have room in queue and outbox.
const AHEAD: u8 = 24;

/// Slots before the idle loop must have sent everything.
static LEFT: AtomicU8 = AtomicU8::new(AHEAD);

/// The idle loop has sent everything.
pub(crate) fn sent() {
    LEFT.store(AHEAD, Ordering::Relaxed);
}

#[exception]
fn SysTick() {
    let left = LEFT.load(Ordering::Relaxed);
    if left > 0 {
        LEFT.store(left - 1, Ordering::Relaxed);
        NVIC::pend(Interrupt::TIM2);
    }
}

/// Does this to the drive.
pub(crate) fn play(trick: Trick) {
    let trick = match trick {
        Trick::Heal => NOTHING,
        Trick::FreezeSensor => FROZEN,
        Trick::LoseReadings => LOST,
        Trick::CloseValve => CLOSED,
        Trick::TripleMass => HEAVY,
    };
    TRICK.store(trick, Ordering::Relaxed);
}

/// A reading of the simulated sensor.
pub(crate) fn reading(drive: &mut Drive) -> Result<i32, ()> {
    let trick = TRICK.load(Ordering::Relaxed);
    drive.set_mass(if trick == HEAVY { 3.0 } else { 1.0 });
    let code = drive.counts().map_err(drop)?;
    match trick {
        LOST => Err(()),
        FROZEN => Ok(CODE.load(Ordering::Relaxed)),
        _ => {
            CODE.store(code, Ordering::Relaxed);
            Ok(code)
        }
    }
}

/// The simulated valve.
pub(crate) fn drive(valve: &mut SimulatedValve, command: f32) -> Result<f32, ()> {
    let closed = TRICK.load(Ordering::Relaxed) == CLOSED;
    let opening = if closed { 0.0 } else { command };
    valve.drive(opening).map_err(drop)?;
    Ok(command)
}
