//! The run in the emulator: requests in the place of a person, provoked faults, restarts in the
//! place of the watchdog.
//!
//! QEMU models neither the watchdog nor the reset flags, and its timers keep no period, so that the
//! count of slots stands in for the counter that runs on. Each run goes over several starts of the
//! same image, and is chosen by the name that QEMU hands over (`arg=`); nothing here has an effect
//! on a board, where nobody asks for it.
//!
//! | run | first start | then |
//! |---|---|---|
//! | servo | control, a slot of 2.5 ms, three overruns | a request is refused, an acknowledgement; a start like the first |
//! | panic | a panic in the interrupt | its report |
//! | hardfault | a read where no memory is, in the interrupt | its report |
//! | overflow | a recursion without end, in the interrupt | its report |
//! | idle-overflow | the same in the idle loop | its report |
//! | lost-stack | a stack pointer above the RAM, in the interrupt | its report |
//! | wire, rtt | no script, requests over USART1 or RTT: `live.rs` | the same |

mod faults;

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use cortex_m_semihosting::{debug, syscall};
use trendid::servo::State;
use trendid_example_support::button::Request;
use trendid_example_support::guard::OVERRUNS;
use trendid_example_support::machine::{BEGIN, TRACED};
use trendid_example_support::survivor::Fault;

use crate::snapshot::{EVERY, Snapshot};
use crate::{survival, wire::Over};

/// The slot of 2.5 ms comes before this sample of the first start, after what is compared by its
/// hash; then three overruns.
const GAP: u64 = TRACED + EVERY;
const END: u64 = TRACED + 2 * EVERY;

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
const HARD_FAULT: u8 = 101;
const OVERFLOW: u8 = 102;
const LONG: u8 = 103;
const LOST_STACK: u8 = 104;

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

/// The counter that runs on, in the place of TIM5.
static COUNTER: AtomicU32 = AtomicU32::new(0);

/// The counter at the next call of a slot of `period` counts.
pub(crate) fn counter(period: u32) -> u32 {
    COUNTER
        .fetch_add(period, Ordering::Relaxed)
        .wrapping_add(period)
}

/// Provokes the fault that was asked for; `overrun` waits for the end of a slot of `period` counts.
pub(crate) fn provoke(period: u32, overrun: impl Fn()) {
    match FAULT.load(Ordering::Relaxed) {
        NOTHING => {}
        PANIC => panic!("provoked"),
        HARD_FAULT => faults::read_nothing(),
        OVERFLOW => faults::overflow(),
        LOST_STACK => faults::lose_stack(),
        LONG => {
            FAULT.store(NOTHING, Ordering::Relaxed);
            // A slot passes that is not called.
            counter(period);
            overrun();
        }
        overruns => {
            FAULT.store(overruns - 1, Ordering::Relaxed);
            overrun();
        }
    }
}

/// What the emulator was asked to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Run {
    Servo,
    Panic,
    HardFault,
    Overflow,
    IdleOverflow,
    LostStack,
    Wire,
    Rtt,
}

/// What the requests come over, where they come over the wire.
pub(crate) fn wire() -> Option<Over> {
    match Run::asked() {
        Run::Wire => Some(Over::Usart),
        Run::Rtt => Some(Over::Rtt),
        _ => None,
    }
}

impl Run {
    /// The last word of the line that QEMU hands over.
    fn asked() -> Self {
        let mut line = [0_u8; 128];
        // SAFETY: address and length are those of a buffer that lives on; QEMU writes nothing else.
        let failed = unsafe { syscall!(GET_CMDLINE, line.as_mut_ptr(), line.len()) } != 0;
        let end = line.iter().position(|&byte| byte == 0).unwrap_or(0);
        let word = line[..end].rsplit(|&byte| byte == b' ').next();
        match word.unwrap_or_default() {
            _ if failed => Self::Servo,
            b"panic" => Self::Panic,
            b"hardfault" => Self::HardFault,
            b"overflow" => Self::Overflow,
            b"idle-overflow" => Self::IdleOverflow,
            b"lost-stack" => Self::LostStack,
            b"wire" => Self::Wire,
            b"rtt" => Self::Rtt,
            _ => Self::Servo,
        }
    }

    /// Whether a fault is what this run has provoked.
    fn explains(self, fault: Option<Fault>) -> bool {
        match (self, fault) {
            (Self::Panic, Some(Fault::Panic { line, file })) => {
                line > 0 && file.as_str() == file!()
            }
            // In flash; the other register may hold any number by then.
            (Self::HardFault, Some(Fault::HardFault { pc, .. })) => pc >> 24 == 0x08,
            // No frame could be written, so there is none to be read.
            (Self::LostStack, Some(Fault::HardFault { pc, lr })) => (pc, lr) == (0, 0),
            (Self::Overflow | Self::IdleOverflow, Some(Fault::StackOverflow { sp })) => {
                // Below the RAM, and not by much.
                (0x1FFF_F000..0x2000_0000).contains(&sp)
            }
            _ => false,
        }
    }
}

/// What one start of the image does and has seen.
pub(crate) struct Script {
    run: Run,
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
            run: Run::asked(),
            start: survivor.starts(),
            fault: survivor.fault(),
            controlled: false,
        }
    }

    /// Looks at a message of the interrupt and goes on.
    pub(crate) fn step(&mut self, now: &Snapshot) {
        match (self.run, self.start) {
            (Run::Servo, 1) => self.control(now),
            (Run::Servo, 2) => self.refused(now),
            (Run::Servo, 3) => {
                self.expect(self.fault.is_none() && rests(now) && !now.stopped);
                debug::exit(debug::EXIT_SUCCESS);
            }
            (_, 1) if now.tick == EVERY => {
                self.expect(self.fault.is_none() && rests(now) && !now.stopped);
                defmt::info!("emulated: provokes the fault");
                match self.run {
                    Run::Panic => FAULT.store(PANIC, Ordering::Relaxed),
                    Run::HardFault => FAULT.store(HARD_FAULT, Ordering::Relaxed),
                    Run::Overflow => FAULT.store(OVERFLOW, Ordering::Relaxed),
                    Run::LostStack => FAULT.store(LOST_STACK, Ordering::Relaxed),
                    Run::IdleOverflow | Run::Servo | Run::Wire | Run::Rtt => faults::overflow(),
                }
            }
            (_, 2) if now.tick == EVERY => {
                self.expect(self.run.explains(self.fault) && rests(now) && now.stopped);
                debug::exit(debug::EXIT_SUCCESS);
            }
            (_, 1 | 2) => self.expect(now.tick <= 2 * EVERY),
            _ => self.expect(false),
        }
    }

    /// The first start: nothing moves before the request, then control, a slot that is missing, and
    /// three overruns.
    fn control(&mut self, now: &Snapshot) {
        self.controlled |=
            now.state.is_controlling() && now.overruns == 0 && now.verified.is_some();
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
            FAULT.store(LONG, Ordering::Relaxed);
        }
        if now.tick == GAP {
            // One slot was late, one is missing, and control goes on.
            let counted = (now.overruns, now.missed) == (1, 1);
            self.expect(counted && now.state.is_controlling() && !now.stopped);
            FAULT.store(OVERRUNS as u8, Ordering::Relaxed);
        }
        if now.tick >= END {
            let stopped = matches!(survival::load().fault(), Some(Fault::Stopped { .. }));
            let counted = now.overruns == 1 + OVERRUNS && now.missed == 1 && now.dropped == 0;
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
