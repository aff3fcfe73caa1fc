//! The run in the emulator: requests in the place of a person, provoked faults, restarts in the place of the watchdog.
//!
//! QEMU models neither the watchdog nor the reset flags. Its run is four starts of one image: control and three overruns;
//! a request that is refused because the fault is latched; a panic; its report. In a fifth start QEMU 7.2 stops answering, so
//! that the hard fault is left out. Nothing here has an effect on a board, where nobody asks for it.

use core::sync::atomic::{AtomicU8, Ordering};

use cortex_m_semihosting::debug;
use trendid::servo::State;
use trendid_example_support::button::Request;
use trendid_example_support::machine::{BEGIN, TRACED};
use trendid_example_support::survivor::Fault;

use crate::snapshot::{EVERY, OVERRUNS, Snapshot};
use crate::survival;

/// End of the first start, in samples; three overruns are provoked before it, after what is compared by its hash.
const END: u64 = TRACED + EVERY;

/// The request after the first message is heard in the sample in which every other loop hears it.
const _: () = assert!(EVERY + 1 == BEGIN);

/// Place of the simulated drive at the start in mm, and how far its sensor may be from it.
const START: f32 = 200.0;
const NOISE: f32 = 0.1;

const NOTHING: u8 = 0;
const RUN: u8 = 1;
const ACKNOWLEDGE: u8 = 2;

/// The request to the interrupt.
static REQUEST: AtomicU8 = AtomicU8::new(NOTHING);

const PANIC: u8 = 100;

/// The fault that the interrupt is asked to provoke; a small number is that of overruns.
static FAULT: AtomicU8 = AtomicU8::new(NOTHING);

/// The request of the script, once.
pub(crate) fn request() -> Option<Request> {
    match REQUEST.swap(NOTHING, Ordering::Relaxed) {
        RUN => Some(Request::Run),
        ACKNOWLEDGE => Some(Request::Acknowledge),
        _ => None,
    }
}

/// Provokes the fault that was asked for; whether this slot shall be late.
pub(crate) fn provoke() -> bool {
    match FAULT.load(Ordering::Relaxed) {
        NOTHING => false,
        PANIC => panic!("provoked"),
        overruns => {
            FAULT.store(overruns - 1, Ordering::Relaxed);
            true
        }
    }
}

/// What one start of the image does and has seen.
pub(crate) struct Script {
    /// Number of the start since power came.
    start: u32,
    /// The fault of the start before.
    fault: Option<Fault>,
    controlled: bool,
}

impl Script {
    pub(crate) fn new() -> Self {
        let survivor = survival::load();
        Self {
            start: survivor.starts(),
            fault: survivor.fault(),
            controlled: false,
        }
    }

    /// Looks at a message of the interrupt and goes on.
    pub(crate) fn step(&mut self, now: &Snapshot) {
        match self.start {
            1 => self.control(now),
            2 => self.refused(now),
            3 if now.tick == EVERY => {
                self.expect(self.fault.is_none() && rests(now) && !now.stopped);
                defmt::info!("emulated: provokes a panic");
                FAULT.store(PANIC, Ordering::Relaxed);
            }
            4 if now.tick == EVERY => {
                let reported = matches!(
                    self.fault,
                    Some(Fault::Panic { line, file }) if line > 0 && file.as_str() == file!()
                );
                self.expect(reported && rests(now) && now.stopped);
                debug::exit(debug::EXIT_SUCCESS);
            }
            0 | 5.. => self.expect(false),
            _ => {}
        }
    }

    /// The first start: nothing moves before the request, then control, then three overruns.
    fn control(&mut self, now: &Snapshot) {
        self.controlled |= now.state.is_controlling() && now.overruns == 0 && now.record.is_some();
        if now.tick == EVERY {
            self.expect(self.fault.is_none() && rests(now) && !now.stopped);
            ask(RUN);
        }
        if now.tick == TRACED {
            defmt::info!(
                "emulated: hash of {=u64} samples: {=u64:016x}",
                TRACED,
                now.trace.value()
            );
            FAULT.store(OVERRUNS, Ordering::Relaxed);
        }
        if now.tick >= END {
            let stopped = matches!(survival::load().fault(), Some(Fault::Stopped { .. }));
            let counted = now.overruns == u32::from(OVERRUNS) && now.dropped == 0;
            self.expect(self.controlled && now.stopped && stopped && counted);
            defmt::info!("emulated: restarts, as a watchdog would");
            survival::restart();
        }
    }

    /// The start after a fault: a request is refused, nothing moves.
    fn refused(&self, now: &Snapshot) {
        if now.tick == EVERY {
            let latched = matches!(self.fault, Some(Fault::Stopped { .. }));
            self.expect(latched && rests(now) && now.stopped && now.refused == 0);
            ask(RUN);
        }
        if now.tick == 2 * EVERY {
            self.expect(rests(now) && now.stopped && now.refused == 1);
            ask(ACKNOWLEDGE);
        }
    }

    /// Ends the emulator with an error where something is not as it must be.
    fn expect(&self, expected: bool) {
        if !expected {
            defmt::error!("emulated: start {=u32} is not as expected", self.start);
            debug::exit(debug::EXIT_FAILURE);
        }
    }
}

/// Whether the axis stands where it stood, under command zero.
fn rests(now: &Snapshot) -> bool {
    let away = now.position - START;
    now.state == State::Idle && now.command == 0.0 && (-NOISE..NOISE).contains(&away)
}

fn ask(request: u8) {
    defmt::info!(
        "emulated: requests {=str}",
        if request == RUN {
            "a run"
        } else {
            "an acknowledgement"
        }
    );
    REQUEST.store(request, Ordering::Relaxed);
}
