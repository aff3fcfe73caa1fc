//! The servo loop in Embassy: control in an executor of its own interrupt, a serial line that is
//! served asynchronously below it.
//!
//! | task | executor | does |
//! |---|---|---|
//! | [`control`] | interrupt, high priority | one sample every millisecond: reads, identifies, controls, drives |
//! | [`listen`] | low priority | takes lines of text as requests |
//! | [`tell`] | low priority | writes what happened as lines of text |
//!
//! Two images share this library: `emulated`, with a clock of its own for QEMU, and `board`, on
//! embassy-stm32. The line is 115 200 baud, 8N1; a request is `run`, `stop` or `move MM`, with the
//! number of the sample in which it is due in front of it or not:
//!
//! ```text
//! 501 run
//! 1500 move 280
//! stop
//! ```
//!
//! Requests stand in a queue that any task may write to; a request names the sample in which it is
//! due, so that it does not matter when it is heard before that. A `stop` without one waits for
//! nothing, and what waits is given up. What control tells stands in
//! another one; when the line is too slow, messages are dropped and counted, and control goes on.
//! The drive is the simulated one, on a board too: for a machine, `Sensor` and `Output` become
//! drivers of `trendid::hardware`.
#![no_std]

use core::fmt::Write as _;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Instant, Ticker, Timer};
use embedded_io_async::{Read, Write};
use heapless::String;
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::State;
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::machine::{Machine, TRACED};
use trendid_example_support::request::{Desk, LONGEST, Line, Request};

/// The position sensor of the machine.
pub type Sensor = Drive;
/// The valve of the machine.
pub type Output = SimulatedValve;

/// Samples between two messages, when nothing happens.
const EVERY: u64 = 500;

/// The time slot.
const SLOT: Duration = Duration::from_millis(1);

/// What was asked for and is not yet due; eight at most.
pub static REQUESTS: Channel<CriticalSectionRawMutex, Request, 8> = Channel::new();

/// Whether somebody has asked to stop, now.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Samples so far; wraps. A watchdog that another task feeds looks at it.
pub static SAMPLES: AtomicU32 = AtomicU32::new(0);

/// What the line shall tell.
pub static MESSAGES: Channel<CriticalSectionRawMutex, Message, 32> = Channel::new();

/// A line to be written.
#[derive(Clone, Debug)]
pub enum Message {
    /// What a sample did.
    Sample(Snapshot),
    /// A line that is no request, or found no room; with its first bytes.
    NotHeard(String<LONGEST>),
}

/// What a sample did.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// Number of the sample, from 1.
    pub tick: u64,
    /// State of the loop.
    pub state: State,
    /// Position \[mm\].
    pub position: f32,
    /// Where it should be \[mm\].
    pub setpoint: f32,
    /// Command of the valve, -1 to 1.
    pub command: f32,
    /// Samples that ended after their slot.
    pub late: u32,
    /// Messages that found no room.
    pub dropped: u32,
    /// Hash of the run so far.
    pub hash: u64,
}

/// One sample every millisecond, for ever.
pub async fn control<S: PositionSensor, V: Valve>(mut machine: Machine<S, V>) {
    let mut ticker = Ticker::every(SLOT);
    let (mut desk, mut shown): (Desk, Option<State>) = (Desk::default(), None);
    let (mut late, mut dropped) = (0, 0);
    loop {
        ticker.next().await;
        let begin = Instant::now();
        let tick = machine.next_tick();
        let stops = STOP.swap(false, Ordering::Relaxed);
        let due = desk.due(tick, stops, || REQUESTS.try_receive().ok());
        let report = machine.update(due);
        SAMPLES.fetch_add(1, Ordering::Relaxed);
        late += u32::from(begin.elapsed() > SLOT);
        if shown != Some(report.state) || tick.is_multiple_of(EVERY) {
            shown = Some(report.state);
            let message = Message::Sample(Snapshot {
                tick,
                state: report.state,
                position: report.position,
                setpoint: report.setpoint.position,
                command: report.command,
                late,
                dropped,
                hash: machine.trace().value(),
            });
            dropped += u32::from(MESSAGES.try_send(message).is_err());
        }
    }
}

/// Takes lines as requests, for ever; what is none is answered, as far as there is room. A line of
/// which a byte was lost is none.
pub async fn listen<R: Read>(mut line: R) -> ! {
    let mut said = Line::default();
    let mut byte = [0];
    loop {
        match line.read(&mut byte).await {
            Ok(0) => continue,
            Ok(_) => {}
            Err(_) => {
                said.spoil();
                // One that fails again and again keeps no other task from running.
                Timer::after_millis(1).await;
                continue;
            }
        }
        let Some(request) = said.push(byte[0]) else {
            continue;
        };
        if request.as_ref().is_some_and(Request::is_stop) {
            // What came before it and was not taken yet is not done behind it.
            REQUESTS.clear();
            STOP.store(true, Ordering::Relaxed);
        } else if request.is_none_or(|request| REQUESTS.try_send(request).is_err()) {
            let text = said.text().try_into().unwrap_or_default();
            // Whoever waits for room hears no stop meanwhile.
            let _ = MESSAGES.try_send(Message::NotHeard(text));
        }
        said.clear();
    }
}

/// Writes what happened; calls `done` with the last line of the samples that are compared.
///
/// # Errors
/// That of the line.
pub async fn tell<W: Write>(mut line: W, done: fn()) -> Result<(), W::Error> {
    // Who hears this is heard from now on.
    line.write_all(b"trendid in Embassy, simulated drive\n")
        .await?;
    loop {
        let mut text = String::<192>::new();
        // There is room for every message.
        let _ = match MESSAGES.receive().await {
            Message::Sample(now) => writeln!(
                text,
                "{} ms {}: position {:.3} mm, set {:.3} mm, command {:.4}; late {}, dropped {}",
                now.tick, now.state, now.position, now.setpoint, now.command, now.late, now.dropped
            )
            .and_then(|()| match now.tick {
                TRACED => writeln!(text, "hash of {TRACED} samples: {:016x}", now.hash),
                _ => Ok(()),
            }),
            Message::NotHeard(said) => writeln!(text, "not heard: {said}"),
        };
        line.write_all(text.as_bytes()).await?;
        line.flush().await?;
        if text.contains("hash of") {
            done();
        }
    }
}
