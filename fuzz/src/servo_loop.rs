//! Any sensor, any request, any setting of the position loop.
//!
//! The first byte chooses where a run begins: with settings from the bytes, or in one of the
//! situations of a usual axis that take seconds to come to (`START`). Those are simulated once
//! and copied, so that most bytes are spent on what happens there. The second byte chooses how long
//! it may take.

use std::sync::LazyLock;

use trendid::hardware::{Axis, Scale};
use trendid::servo::store::Record;
use trendid::servo::{Config, Travel};

use crate::bytes::Bytes;
use crate::servo_bench::{Bench, Fault, Loop};
use crate::servo_settings::{model, settings};

/// Situations of one axis, each from a simulation that is the same every time: a commissioning at
/// some of its seconds, then control at rest, in a move, in a sine, with a slower and a quicker
/// drive, behind a fault.
static START: LazyLock<Vec<Bench>> = LazyLock::new(|| {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let axis = Axis {
        scale: Scale::new(0.005).expect("a scale"),
        reference: 0,
    };
    let config = Config::minimal(1e-3, travel);
    let mut bench = Bench::try_new(&config, axis, &mut Bytes::new(&[])).expect("usual settings");
    bench.drive.gain = 1500.0;
    bench.drive.dead_zone = 0.02;
    let mut found = vec![bench.clone()];
    let run = |bench: &mut Bench, samples: u32| {
        for _ in 0..samples {
            bench.step(Fault::None);
        }
    };
    bench.servo.commission();
    for _ in 0..60 {
        run(&mut bench, 250);
        if bench.servo.supervisor().state().is_controlling() {
            break;
        }
        found.push(bench.clone());
    }
    assert!(
        bench.servo.supervisor().state().is_controlling(),
        "{:?}",
        bench.servo.supervisor().state()
    );
    run(&mut bench, 1000);
    found.push(bench.clone());
    bench.servo.move_to(300.0).expect("a target");
    for samples in [20, 80, 200, 1500] {
        run(&mut bench, samples);
        found.push(bench.clone());
    }
    bench.servo.oscillate(20.0, 0.5).expect("a sine");
    run(&mut bench, 1300);
    found.push(bench.clone());
    for factor in [0.4, 5.0] {
        bench.drive.share *= factor;
        run(&mut bench, 700);
        found.push(bench.clone());
    }
    for fault in [Fault::Silent, Fault::Mirrored, Fault::Valve] {
        let mut stopped = bench.clone();
        for _ in 0..60 {
            stopped.step(fault);
        }
        found.push(stopped);
    }
    found
});

/// Of 256, executions that go on for as long as their bytes say; and the samples of the others.
///
/// From the situations above something happens within some dozen samples: thousands in every
/// execution left the time for a tenth of the sequences.
const LONG: u8 = 16;
const SHORT: u32 = 80;

/// Runs what the bytes say.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let begin = usize::from(bytes.byte());
    let most = if bytes.byte() < LONG { 20_000 } else { SHORT };
    // An eighth of the first bytes: with settings of their own.
    let mut bench = if begin < 32 {
        let (config, axis) = settings(&mut bytes);
        let Some(bench) = Bench::try_new(&config, axis, &mut bytes) else {
            return;
        };
        bench
    } else {
        START[begin % START.len()].clone()
    };
    let mut samples = 0_u32;
    while !bytes.is_empty() && samples < most {
        let mut fault = Fault::None;
        let count = match bytes.byte() {
            0..=79 => 1,
            80..=153 => u32::from(bytes.byte()) / 16,
            154..=157 => u32::from(bytes.byte()),
            158..=159 => 16 * u32::from(bytes.byte()),
            160..=199 => {
                fault = Fault::of(&mut bytes, bench.axis, bench.length);
                let count = u32::from(bytes.byte());
                if count < 224 { 1 + count / 16 } else { count }
            }
            _ => {
                let (length, min) = (bench.length, bench.watch.travel.min);
                request(&mut bench.servo, &mut bytes, length, min);
                1
            }
        };
        for _ in 0..count.min(most - samples) {
            samples += 1;
            bench.step(fault);
        }
    }
}

/// What a user may ask for; a refused request changes nothing.
fn request(servo: &mut Loop, bytes: &mut Bytes<'_>, length: f32, min: f32) {
    let kind = bytes.choice(10);
    let before = (bytes.byte() == 0).then(|| format!("{servo:?}"));
    let done = match kind {
        0..=2 => {
            servo.commission();
            Ok(())
        }
        3 => {
            servo.abort();
            Ok(())
        }
        4 => servo.move_to(bytes.any()),
        5 => servo.move_to(min + bytes.signal(length)),
        6 => servo.oscillate(bytes.signal(0.1 * length), bytes.signal(3.0)),
        7 => {
            servo.skip(u32::from(bytes.byte()) % 8);
            Ok(())
        }
        8 => servo.install(model(bytes, length)),
        _ => servo.resume(&Record {
            model: model(bytes, length),
            std: [1.0; 6],
            delay: bytes.signal(0.004),
            sign: bytes.signal(1.0).signum(),
            noise: bytes.signal(0.01),
            dead_volume: bytes.signal(0.5),
            imbalance: bytes.signal(0.5),
        }),
    };
    if let (Err(_), Some(before)) = (done, before) {
        assert_eq!(
            before,
            format!("{servo:?}"),
            "a refused request changed something"
        );
    }
}
