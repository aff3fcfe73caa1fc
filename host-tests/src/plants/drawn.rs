//! Linear plants drawn by a seed, with a record of each: the material for the choice of a
//! structure.
//!
//! Order 1 to 3, an integrator in every other one, zeros, a delay of 0 to 5 samples, four kinds of
//! inputs, white noise or noise that is mostly drift. A plant is drawn again until a record can
//! show its structure at all: every pole and zero is seen by the sampling and by the length of the
//! record, and no zero is near a pole.

use std::f64::consts::{PI, TAU};

use crate::random::{Random, log_uniform};
use rand::{RngExt, SeedableRng};

use crate::plants::linear::{Input, LinearPlant};

/// A plant with its record.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnRecord {
    /// Denominator, ascending, monic.
    pub a: Vec<f64>,
    /// Numerator, ascending.
    pub b: Vec<f64>,
    /// Delay in samples.
    pub delay: usize,
    /// Whether a_0 is 0.
    pub integrator: bool,
    /// Whether the noise is mostly drift.
    pub drift: bool,
    /// Sample time \[s\].
    pub dt: f64,
    /// Input.
    pub u: Vec<f64>,
    /// Measured output.
    pub y: Vec<f64>,
}

/// Distance of a zero from every pole, as a factor.
const APART: f64 = 1.8;

/// Samples of a record.
const SAMPLES: [usize; 2] = [2000, 5000];

impl DrawnRecord {
    /// The plant and the record of a seed.
    pub fn of(seed: u64) -> Self {
        let mut rng = Random::seed_from_u64(seed);
        let dt = 1e-3 * log_uniform(&mut rng, 1.0, 20.0);
        let order = rng.random_range(1..=3_usize);
        let integrator = rng.random_bool(0.5);
        let samples = rng.random_range(SAMPLES[0]..SAMPLES[1]);
        // Time constants of the plant from 8 samples to a fortieth of the record.
        let slowest = 40.0 / (samples as f64 * dt);
        let fastest = 0.125 / dt;
        let middle = log_uniform(&mut rng, 2.0 * slowest, 0.5 * fastest);
        let (a, rates) = denominator(&mut rng, order, integrator, middle, [slowest, fastest]);
        let zeros = match order {
            1 => 0,
            _ if rng.random_bool(0.6) => 0,
            _ => rng.random_range(1..order),
        };
        let b = numerator(&mut rng, zeros, &rates, &a);
        let delay = rng.random_range(0..=5_usize);
        let u = input(&mut rng, samples, middle * dt);
        let drift = rng.random_bool(0.3);
        let truth = {
            let inputs = [Input::delayed(&b, delay)];
            let mut plant = LinearPlant::with_inputs(&a, &inputs, 0.0, dt)
                .unwrap_or_else(|e| unreachable!("a drawn plant: {e}"));
            plant.response(&u)
        };
        let level = log_uniform(&mut rng, 0.01, 0.1);
        let noise = noise(&mut rng, samples, drift, 0.2 / (dt * middle.min(1.0 / dt)));
        // Behind an integrator the position goes far; noise is measured against its movement
        // without the mean slope.
        let scale = level * movement(&truth, integrator, dt * middle) / rms(&noise);
        let y = truth
            .iter()
            .zip(&noise)
            .map(|(y, n)| y + scale * n)
            .collect();
        Self {
            a,
            b,
            delay,
            integrator,
            drift,
            dt,
            u,
            y,
        }
    }

    /// Zeros of the plant.
    pub fn zeros(&self) -> usize {
        self.b.len() - 1
    }
}

/// A denominator around a rate \[rad/s\] with the distances of its poles from zero.
fn denominator(
    rng: &mut Random,
    order: usize,
    integrator: bool,
    middle: f64,
    [slowest, fastest]: [f64; 2],
) -> (Vec<f64>, Vec<f64>) {
    let mut left = order - usize::from(integrator);
    let mut a = vec![1.0];
    let mut rates = Vec::new();
    let multiply = |a: &mut Vec<f64>, factor: &[f64]| {
        let mut product = vec![0.0; a.len() + factor.len() - 1];
        for (i, x) in a.iter().enumerate() {
            for (j, y) in factor.iter().enumerate() {
                product[i + j] += x * y;
            }
        }
        *a = product;
    };
    if integrator {
        multiply(&mut a, &[0.0, 1.0]);
    }
    if left >= 2 && rng.random_bool(0.6) {
        let damping = rng.random_range(0.1..0.8);
        multiply(&mut a, &[middle * middle, 2.0 * damping * middle, 1.0]);
        rates.push(middle);
        left -= 2;
    }
    while left > 0 {
        // Real poles within a factor of four of the others, and apart from one another.
        let rate = (middle * log_uniform(rng, 0.25, 4.0)).clamp(slowest, fastest);
        if rates.iter().all(|r: &f64| ratio(*r, rate) > 1.3) {
            multiply(&mut a, &[rate, 1.0]);
            rates.push(rate);
            left -= 1;
        }
    }
    a.pop();
    (a, rates)
}

fn ratio(x: f64, y: f64) -> f64 {
    if x > y { x / y } else { y / x }
}

/// A numerator of static (or velocity) gain 0.5 to 2, its zeros apart from the poles; every fourth
/// zero is in the right half.
fn numerator(rng: &mut Random, zeros: usize, rates: &[f64], a: &[f64]) -> Vec<f64> {
    let lowest = a.iter().copied().find(|a| *a != 0.0).unwrap_or(1.0);
    let gain = log_uniform(rng, 0.5, 2.0) * if rng.random_bool(0.2) { -1.0 } else { 1.0 };
    let mut b = vec![gain * lowest];
    let middle = rates.iter().copied().fold(f64::NAN, f64::min);
    let mut placed: Vec<f64> = rates.to_vec();
    for _ in 0..zeros {
        let zero = loop {
            let zero = middle * log_uniform(rng, 0.4, 3.0);
            if placed.iter().all(|r| ratio(*r, zero) > APART) {
                break zero;
            }
            // Below the slowest pole there is room, but perhaps not apart from an earlier zero too.
            placed.truncate(rates.len());
        };
        placed.push(zero);
        let sign = if rng.random_bool(0.25) { -1.0 } else { 1.0 };
        let mut product = vec![0.0; b.len() + 1];
        for (i, value) in b.iter().enumerate() {
            product[i] += value;
            product[i + 1] += value * sign / zero;
        }
        b = product;
    }
    b
}

/// Steps of random length, binary noise, a multisine or filtered noise, all around the rate of the
/// plant per sample.
fn input(rng: &mut Random, samples: usize, rate: f64) -> Vec<f64> {
    let kind = rng.random_range(0..4_u8);
    let held = ((0.5 / rate).round() as usize).clamp(1, samples / 40);
    let mut u = Vec::with_capacity(samples);
    match kind {
        0 | 1 => {
            while u.len() < samples {
                let level = match kind {
                    0 => rng.random_range(-1.0..1.0),
                    _ if rng.random_bool(0.5) => 1.0,
                    _ => -1.0,
                };
                let length = rng.random_range(1..=4 * held);
                u.extend(std::iter::repeat_n(level, length.min(samples - u.len())));
            }
        }
        2 => {
            let lines: Vec<(f64, f64)> = (0..12)
                .map(|_| {
                    (
                        rate * log_uniform(rng, 0.1, 4.0),
                        rng.random_range(0.0..TAU),
                    )
                })
                .collect();
            u.extend((0..samples).map(|k| {
                let wave =
                    |(w, phase): &(f64, f64)| ((w * k as f64).min(PI * k as f64) + phase).sin();
                lines.iter().map(wave).sum::<f64>() / 3.5
            }));
        }
        _ => {
            let decay = (-3.0 * rate).exp();
            let mut state = 0.0;
            for _ in 0..samples {
                state = decay * state + (1.0 - decay * decay).sqrt() * rng.random_range(-1.0..1.0);
                u.push(state);
            }
        }
    }
    u
}

/// White noise, or mostly drift: white noise through a lag of so many samples with a tenth of it
/// directly.
fn noise(rng: &mut Random, samples: usize, drift: bool, lag: f64) -> Vec<f64> {
    let decay = (-1.0 / lag).exp();
    let scale = (1.0 - decay * decay).sqrt();
    let mut state = 0.0;
    let noise = (0..samples).map(|_| {
        let white: f64 = rng.random_range(-1.0..1.0);
        state = decay * state + scale * rng.random_range(-1.0..1.0);
        if drift { state + 0.1 * white } else { white }
    });
    noise.collect()
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt()
}

/// Size of the movement: about the mean, or of the velocity times the time of the plant behind an
/// integrator.
fn movement(y: &[f64], integrator: bool, rate: f64) -> f64 {
    if integrator {
        let steps: Vec<f64> = y.windows(2).map(|w| w[1] - w[0]).collect();
        rms(&steps) / rate
    } else {
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        rms(&y.iter().map(|v| v - mean).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_plant_is_drawn_and_none_runs_away() {
        let drawn: Vec<DrawnRecord> = (0..200).map(DrawnRecord::of).collect();
        for (order, integrator, zeros) in [(1, false, 0), (1, true, 0), (2, true, 1), (3, false, 2)]
        {
            let alike = |d: &&DrawnRecord| {
                (d.a.len(), d.integrator, d.zeros()) == (order, integrator, zeros)
            };
            assert!(drawn.iter().find(alike).is_some());
        }
        for d in &drawn {
            assert!(
                d.y.iter()
                    .chain(&d.u)
                    .all(|v| v.is_finite() && v.abs() < 1e6)
            );
        }
        assert_eq!(DrawnRecord::of(7), drawn[7]);
    }
}
