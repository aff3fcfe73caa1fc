//! What the drive of a user does, exactly, and what arrives of it.

use rand::RngExt;

use crate::plants::linear::LinearPlant;
use crate::plants::valve::StaticValve;
use crate::random::log_uniform;
use crate::signals::excitation::Controller;
use crate::signals::noise::{Additive, Condition, quantised, rms, rms_about_mean};
use crate::users::draw::{Purpose, User, stream};

/// What arrives at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// Command, and position as it was measured.
    Sample {
        /// Held until the next sample.
        u: f64,
        /// Not a number where the sensor gave none.
        y: f64,
    },
    /// So many samples are missed under the command of before.
    Skip(u32),
}

/// A record of a user.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// What arrives.
    pub events: Vec<Event>,
    /// Rms of the command, in its unit.
    pub command: f64,
    /// Rms of the motion about its mean, in its unit.
    pub motion: f64,
    /// Standard deviation of the error of a position, resolution included.
    pub noise: f64,
}

/// Errors of a sensor, in the unit of the position.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    /// Standard deviation of white noise.
    noise: f64,
    resolution: f64,
}

/// A drive in motion, and when its samples are missed.
struct Motion {
    u: Vec<f64>,
    y_true: Vec<f64>,
    y: Vec<f64>,
    missed: Vec<bool>,
}

/// Samples before anything happens.
const FIRST: usize = 11;

impl Record {
    /// The record of a user.
    ///
    /// # Panics
    /// Never for a user that was drawn.
    pub fn of(user: &User) -> Self {
        // The noise is told in motions, which the drive without noise makes.
        let clean = Motion::of(user, Errors::default());
        let motion = rms_about_mean(&clean.y_true);
        let errors = Errors {
            noise: user.sensor.noise * motion,
            resolution: user.sensor.resolution * motion,
        };
        let moved = Motion::of(user, errors);
        Self {
            command: rms(&moved.u),
            motion,
            noise: errors.noise.hypot(errors.resolution / 12.0_f64.sqrt()),
            events: moved.events(user, motion),
        }
    }

    /// Samples after which a user reads: 10, 30 and 100/w, and the end.
    pub fn readings(user: &User) -> Vec<usize> {
        let times = [10.0, 30.0, 100.0].map(|t| (t / user.angle()) as usize);
        let mut due: Vec<usize> = times.into_iter().collect();
        due.retain(|k| *k >= FIRST && k + FIRST <= user.samples);
        due.push(user.samples);
        due
    }
}

/// Proportional gain, in command per position: far below what makes the loop oscillate; 0 where
/// there is no position.
fn proportional(user: &User) -> f64 {
    match user.a[..] {
        [0.0, a1, ..] => user.omega * (0.5 * user.damping.min(0.6)).min(0.3) * a1 / user.b[0],
        _ => 0.0,
    }
}

impl Motion {
    fn of(user: &User, errors: Errors) -> Self {
        let (dt, n) = (user.sample_time, user.samples);
        let [command, travel] = user.sizes;
        let valve = StaticValve {
            offset: user.offset * command,
            dead_zone: user.dead_zone * command,
            ..StaticValve::IDEAL
        };
        let mut plant = LinearPlant::new(&user.a, &user.b, dt)
            .unwrap_or_else(|error| panic!("user {}: {error}", user.seed));
        if !user.kind.integrates() {
            // At rest under the offset.
            plant.reset(user.b[0] / user.a[0] * valve.offset);
        }
        let asked = user.command.sequence(user.pace, user.angle(), n, user.seed);
        let mut controller = Controller::new(proportional(user), 0.0, dt, 2.0 * command);
        let width_um = 1e3 * 12.0_f64.sqrt() * errors.noise;
        let mut noise = Additive::new(&Condition::white(width_um), user.seed);
        let mut motion = Self {
            u: Vec::with_capacity(n),
            y_true: Vec::with_capacity(n),
            y: Vec::with_capacity(n),
            missed: missed(user),
        };
        let mut held = 0.0;
        for (k, asked) in asked.into_iter().enumerate() {
            let y_true = plant.output();
            let y = quantised(y_true + noise.next().unwrap_or(0.0), errors.resolution);
            if !motion.missed[k] {
                let u = match user.command.is_reference() {
                    true => controller.command(asked * travel, y, dt),
                    false => asked * command,
                };
                // The command is that of a machine that has f32.
                held = f64::from(u as f32);
            }
            plant.step(&[valve.flow(held)]);
            motion.u.push(held);
            motion.y_true.push(y_true);
            motion.y.push(y);
        }
        motion
    }

    /// What arrives, where a motion has this size.
    fn events(&self, user: &User, size: f64) -> Vec<Event> {
        let mut random = stream(user.seed, Purpose::Interruptions);
        let mut events = Vec::with_capacity(self.u.len());
        for (k, (&u, &y)) in self.u.iter().zip(&self.y).enumerate() {
            if self.missed[k] {
                match events.last_mut() {
                    Some(Event::Skip(samples)) => *samples += 1,
                    _ => events.push(Event::Skip(1)),
                }
                continue;
            }
            let mut y = y + user.sensor.place * size;
            let mut happens = |one_of: f64| k >= FIRST && random.random_bool(1.0 / one_of);
            let (nan, spike) = (happens(300.0), happens(500.0));
            let by: f64 = random.random_range(-3.0..3.0);
            if nan && user.interruptions.nans {
                y = f64::NAN;
            }
            if spike && user.interruptions.spikes {
                y += by * size;
            }
            events.push(Event::Sample { u, y });
        }
        events
    }
}

/// Which samples are missed.
fn missed(user: &User) -> Vec<bool> {
    let mut missed = vec![false; user.samples];
    if !user.interruptions.gaps {
        return missed;
    }
    let mut random = stream(user.seed, Purpose::Gaps);
    let mut k = FIRST;
    while k < user.samples {
        if random.random_bool(0.05 * user.angle()) {
            let length = (log_uniform(&mut random, 0.2, 6.0) / user.angle()) as usize;
            let end = (k + length.max(1)).min(user.samples);
            missed[k..end].fill(true);
            k = end;
        }
        k += 1;
    }
    missed
}
