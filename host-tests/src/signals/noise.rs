//! Measurement noise of the paper's Table 1: drift `w`, white noise `eta`, resolution `eps`, all
//! seeded.
//!
//! The paper gives widths in um but not the definitions; two readings are kept apart, see
//! [`Reading`].

use std::f64::consts::PI;

use crate::random::Random;
use rand::RngExt;

/// How the widths printed in Table 1 are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reading {
    /// Widths as printed, in um of position; the drift is
    /// `(w/2) sin(2 pi 0.5 Hz t + random phase)`.
    Absolute,
    /// Widths scaled together so that rms(noise)/rms(signal) is the printed N/S; the drift is
    /// uniform white noise of full width `w` through a first-order lag of 200 ms.
    ///
    /// The signal is the record's noise-free position about its mean (the plant integrates, so the
    /// rms about zero would measure where the drive happened to go); the noise is measured minus
    /// true position about zero, rounding included. With this definition the Cramer-Rao bound comes
    /// out as in the prototype, see `tests/core/bound.rs`.
    Relative,
}

/// One condition of measurement: the simulation parameters of a row of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Slow drift, full width \[um\].
    pub w_um: f64,
    /// White noise, full width \[um\].
    pub eta_um: f64,
    /// Resolution of the measurement \[um\].
    pub eps_um: f64,
    /// Sampling interval \[ms\].
    pub dt_ms: f64,
    /// Noise to signal \[%\]; used by [`Reading::Relative`] only.
    pub ns_pct: f64,
    /// Reading of the widths.
    pub reading: Reading,
}

impl Condition {
    /// No noise, 1 ms, reading ABSOLUTE.
    pub const CLEAN: Self = Self {
        w_um: 0.0,
        eta_um: 0.0,
        eps_um: 0.0,
        dt_ms: 1.0,
        ns_pct: 0.0,
        reading: Reading::Absolute,
    };

    /// White noise of full width `eta_um` only, 1 ms, reading ABSOLUTE.
    pub const fn white(eta_um: f64) -> Self {
        Self {
            eta_um,
            ..Self::CLEAN
        }
    }

    /// White noise only, `ns_pct` percent of the signal, 1 ms, reading RELATIVE.
    pub const fn white_relative(ns_pct: f64) -> Self {
        Self {
            eta_um: 1.0,
            ns_pct,
            reading: Reading::Relative,
            ..Self::CLEAN
        }
    }

    /// Sampling interval \[s\].
    pub fn dt(&self) -> f64 {
        1e-3 * self.dt_ms
    }

    /// Measured positions \[mm\] of the true ones \[mm\], and the factor by which the widths were
    /// scaled (1 in ABSOLUTE).
    pub fn measure(&self, truth: &[f64], seed: u64) -> (Vec<f64>, f64) {
        let unit: Vec<f64> = Additive::new(self, seed).take(truth.len()).collect();
        let at = |scale: f64| -> Vec<f64> {
            truth
                .iter()
                .zip(&unit)
                .map(|(y, n)| quantised(y + scale * n, 1e-3 * self.eps_um * scale))
                .collect()
        };
        if self.reading == Reading::Absolute {
            return (at(1.0), 1.0);
        }
        let eps_mm = 1e-3 * self.eps_um;
        let wanted = 1e-2 * self.ns_pct * rms_about_mean(truth);
        let width = (mean_square(&unit) + eps_mm * eps_mm / 12.0).sqrt();
        if wanted == 0.0 || width == 0.0 {
            return (truth.to_vec(), 0.0);
        }
        // The rounding error is a continuous but uneven function of the scale: bisection, to a part
        // in a million.
        let ratio = |scale: f64| {
            let error: f64 = at(scale)
                .iter()
                .zip(truth)
                .map(|(m, y)| (m - y) * (m - y))
                .sum();
            (error / truth.len() as f64).sqrt() / wanted
        };
        let (mut low, mut high) = (0.5 * wanted / width, 2.0 * wanted / width);
        while ratio(low) > 1.0 {
            low *= 0.5;
        }
        while ratio(high) < 1.0 {
            high *= 2.0;
        }
        while high / low > 1.0 + 1e-6 {
            let middle = (low * high).sqrt();
            if ratio(middle) < 1.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let scale = (low * high).sqrt();
        (at(scale), scale)
    }
}

/// Drift and white noise of a condition sample by sample \[mm\], with the widths as printed.
#[derive(Clone, Debug)]
pub struct Additive {
    condition: Condition,
    eta: Random,
    drift: Random,
    phase: f64,
    lag: f64,
    k: u64,
}

/// Time constant of the drift in RELATIVE \[s\].
const DRIFT_LAG_S: f64 = 0.2;

/// Frequency of the drift in ABSOLUTE \[Hz\].
const DRIFT_HZ: f64 = 0.5;

impl Additive {
    /// The noise of `condition` for a seed.
    pub fn new(condition: &Condition, seed: u64) -> Self {
        let mut drift = generator(seed, Stream::Drift);
        let phase = drift.random_range(0.0..2.0 * PI);
        let mut noise = Self {
            condition: *condition,
            eta: generator(seed, Stream::White),
            drift,
            phase,
            lag: 0.0,
            k: 0,
        };
        if condition.reading == Reading::Relative && condition.w_um != 0.0 {
            // Eight time constants: the drift is stationary from the first sample.
            for _ in 0..(8.0 * DRIFT_LAG_S / condition.dt()) as usize {
                noise.lagged();
            }
        }
        noise
    }

    fn lagged(&mut self) -> f64 {
        let pole = (-self.condition.dt() / DRIFT_LAG_S).exp();
        let white = self.condition.w_um * (self.drift.random::<f64>() - 0.5);
        self.lag = pole * self.lag + (1.0 - pole) * white;
        self.lag
    }
}

impl Iterator for Additive {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let t = self.k as f64 * self.condition.dt();
        self.k += 1;
        let drift = match self.condition.reading {
            Reading::Absolute => {
                0.5 * self.condition.w_um * (2.0 * PI * DRIFT_HZ * t + self.phase).sin()
            }
            Reading::Relative => self.lagged(),
        };
        let white = self.condition.eta_um * (self.eta.random::<f64>() - 0.5);
        Some(1e-3 * (drift + white))
    }
}

/// `y` rounded to the nearest multiple of `eps`; unchanged when `eps` is zero.
pub fn quantised(y: f64, eps: f64) -> f64 {
    if eps > 0.0 {
        (y / eps).round() * eps
    } else {
        y
    }
}

/// Root mean square about zero.
pub fn rms(x: &[f64]) -> f64 {
    mean_square(x).sqrt()
}

/// Root mean square about the mean.
pub fn rms_about_mean(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / x.len() as f64).sqrt()
}

fn mean_square(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64
}

/// Independent random streams of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Commands and references.
    Excitation = 1,
    /// White measurement noise.
    White = 2,
    /// Drift.
    Drift = 3,
    /// For tests: anything else.
    Other = 4,
}

/// Random generator of a seed and stream, the same on every machine.
pub fn generator(seed: u64, stream: Stream) -> Random {
    numbered(seed, stream as u64)
}

/// Random generator of a seed and of the stream of this number; [`generator`] has the numbers of
/// [`Stream`].
pub fn numbered(seed: u64, stream: u64) -> Random {
    Random::numbered(seed, stream)
}

#[cfg(test)]
mod tests;
