//! The simulated axis in real time.

use std::thread;
use std::time::{Duration, Instant};

use trendid_host_tests::servo::population::draw::AxisDraw;

use crate::args::Args;
use crate::source::channel::{Line, Said};
use crate::source::simulated::Simulated;

/// How often the thread looks at the clock.
const NAP: Duration = Duration::from_millis(2);

/// Lag behind real time that is caught up; beyond it the simulation goes on from now.
const LAG: f64 = 0.25;

/// Samples that are handed over at once, as fast as they are received.
const BATCH: usize = 100;

/// Bytes that are handed over at once.
const PORTION: usize = 32 * 1024;

pub(super) fn run(args: &Args, seed: u64, mut line: Line) {
    let draw = AxisDraw::new(args.family, !args.rare, seed);
    let name = format!("{} axis, seed {seed}", args.family.name());
    let mut machine = match Simulated::new(&draw, &name, std::process::id() as u16) {
        Ok(machine) => machine,
        Err(error) => return line.say(Said::Down(format!("{name}: {error}"))),
    };
    line.say(Said::Up(format!("simulated {name}")));
    let rate = if args.speed > 0.0 {
        args.speed / draw.sample_time
    } else {
        f64::INFINITY
    };
    let (mut begin, mut samples) = (Instant::now(), 0.0);
    let mut bytes = Vec::new();
    while line.lives() {
        while let Some(asked) = line.take() {
            machine.receive(&asked);
        }
        if rate.is_infinite() {
            if line.has_room() {
                for _ in 0..BATCH {
                    machine.step();
                    machine.send(&mut bytes);
                }
                line.say(Said::Bytes(std::mem::take(&mut bytes)));
            } else {
                thread::yield_now();
            }
            continue;
        }
        let due = begin.elapsed().as_secs_f64() * rate;
        if due - samples > LAG * rate {
            (begin, samples) = (Instant::now(), 0.0);
            continue;
        }
        while samples < due {
            machine.step();
            samples += 1.0;
            // Without room the bytes stay in the outbox, which drops samples and counts them.
            if bytes.len() < PORTION {
                machine.send(&mut bytes);
            }
        }
        if line.has_room() && !bytes.is_empty() {
            line.say(Said::Bytes(std::mem::take(&mut bytes)));
        }
        thread::sleep(NAP);
    }
}
