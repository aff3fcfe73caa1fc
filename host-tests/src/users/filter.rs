//! The extended Kalman filter on the record of a user, as an opponent.
//!
//! It is told more than the identifier: the spread of every range that is drawn, its middle, and
//! the noise as it is. It knows of no offset of the valve, no dead zone and no zero, and takes a
//! spike as it comes. What is missed it predicts.

use crate::oracles::ekf::{ExtendedKalman, Prior};
use crate::plants::servo::Servo;
use crate::users::draw::{BANDWIDTH, DAMPING, TOLD, User};
use crate::users::identified::physical_truth;
use crate::users::kind::Kind;
use crate::users::reading::{Quantity, Reading};
use crate::users::record::{Event, Record};

/// Largest step of its integration in 1 / fastest frequency that the user may have.
const STEP: f64 = 0.5;

/// Least noise that it is told over the motion.
const LEAST_NOISE: f64 = 1e-6;

/// Standard deviation of the logarithm of a number from a range that is even in it.
fn spread([low, high]: [f64; 2]) -> f64 {
    (high / low).ln() / 12.0_f64.sqrt()
}

fn middle([low, high]: [f64; 2]) -> f64 {
    (low * high).sqrt()
}

/// What a user reads of the filter; `None` where the drive is none of its form.
pub fn readings(user: &User, record: &Record) -> Option<Vec<Reading>> {
    let has_form = matches!(
        user.kind,
        Kind::Servo | Kind::ServoPlain | Kind::ServoDeadZone
    );
    has_form.then(|| run(user, record))
}

fn run(user: &User, record: &Record) -> Vec<Reading> {
    // In the units of what is told, commands and motions are about 1.
    let [command, motion] = [
        record.command * user.told.input_range,
        record.motion * user.told.output_range,
    ];
    let bandwidth = user.omega * user.told.bandwidth;
    let sigma = record.noise.max(LEAST_NOISE * record.motion) / motion;
    let prior = Prior {
        servo: Servo {
            c: bandwidth,
            omega0: bandwidth / middle(BANDWIDTH),
            xi: middle(DAMPING),
        },
        log_sd: [
            2.0_f64.sqrt() * spread(TOLD),
            spread(BANDWIDTH),
            spread(DAMPING),
        ],
        ..Prior::tuned(sigma)
    };
    let steps = (user.sample_time * bandwidth * BANDWIDTH[1] / STEP)
        .ceil()
        .max(1.0);
    let mut filter = ExtendedKalman::new(&prior, sigma, user.sample_time / steps);
    let mut due = Record::readings(user).into_iter().peekable();
    let mut readings = Vec::new();
    let (mut k, mut held, mut origin) = (0, 0.0, None);
    for event in &record.events {
        let samples = match *event {
            Event::Skip(samples) => samples,
            Event::Sample { u, y } => {
                held = u / command;
                if y.is_finite() {
                    let origin = *origin.get_or_insert(y);
                    filter.correct((y - origin) / motion);
                }
                1
            }
        };
        for _ in 0..samples * steps as u32 {
            filter.advance(held);
        }
        k += samples as usize;
        if due.peek().is_some_and(|at| k >= *at) {
            while due.next_if(|at| k >= *at).is_some() {}
            let time = k as f64 * user.angle();
            readings.push(reading(user, &filter, time, motion / command));
        }
    }
    readings
}

fn reading(user: &User, filter: &ExtendedKalman, time: f64, unit: f64) -> Reading {
    let Servo { c, omega0, xi } = filter.servo();
    let values = [c * unit, omega0, xi];
    let read = values.into_iter().zip(filter.deviation_pct());
    let quantities = physical_truth(user).into_iter().zip(read);
    Reading {
        time,
        quantities: quantities
            .map(|((name, truth), (value, pct))| {
                Quantity::new(name, value, truth, 1e-2 * pct * value)
            })
            .collect(),
    }
}
