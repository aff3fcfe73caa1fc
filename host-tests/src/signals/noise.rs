//! Measurement noise of the paper's Table 1: drift `w`, white noise `eta`, resolution `eps`, all seeded.
//!
//! The paper gives widths in um but not the definitions; two readings are kept apart, see [`Reading`].

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// How the widths printed in Table 1 are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reading {
    /// Widths as printed, in um of position; the drift is `(w/2) sin(2 pi 0.5 Hz t + random phase)`.
    Absolute,
    /// Widths scaled together so that rms(noise)/rms(signal) is the printed N/S; the drift is uniform white noise of
    /// full width `w` through a first-order lag of 200 ms.
    ///
    /// The signal is the record's noise-free position about its mean (the plant integrates, so the rms about zero
    /// would measure where the drive happened to go); the noise is measured minus true position about zero, rounding
    /// included. With this definition the Cramer-Rao bound comes out as in the prototype, see `tests/core/bound.rs`.
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

    /// Measured positions \[mm\] of the true ones \[mm\], and the factor by which the widths were scaled (1 in ABSOLUTE).
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
        // The rounding error is a continuous but uneven function of the scale: bisection, to a part in a million.
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
    eta: ChaCha8Rng,
    drift: ChaCha8Rng,
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
pub fn generator(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream as u64);
    random
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(condition: Condition, seed: u64, n: usize) -> Vec<f64> {
        Additive::new(&condition, seed).take(n).collect()
    }

    #[test]
    fn white_noise_is_uniform_of_full_width_and_white() {
        let x = noise(Condition::white(100.0), 3, 200_000);
        let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(largest <= 0.05 && largest > 0.0499);
        assert!((rms(&x) - 0.1 / 12f64.sqrt()).abs() < 2e-4);
        for lag in 1..5 {
            let product: f64 = x.windows(lag + 1).map(|w| w[0] * w[lag]).sum();
            let correlation = product / (x.len() as f64 * mean_square(&x));
            // Four standard deviations of 1/sqrt(n).
            assert!(correlation.abs() < 4.0 / 200_000f64.sqrt(), "{correlation}");
        }
    }

    #[test]
    fn absolute_drift_is_a_half_hertz_sine() {
        let condition = Condition {
            w_um: 1000.0,
            ..Condition::CLEAN
        };
        let x = noise(condition, 4, 2000);
        assert!((rms(&x) - 0.5 / 2f64.sqrt()).abs() < 1e-9);
        assert!((x[0] + x[1000]).abs() < 1e-9);
        assert_ne!(x[0], noise(condition, 5, 1)[0]);
    }

    #[test]
    fn relative_drift_is_a_lag_of_200_ms() {
        let condition = Condition {
            w_um: 1000.0,
            reading: Reading::Relative,
            ..Condition::CLEAN
        };
        let x = noise(condition, 6, 400_000);
        let power = mean_square(&x);
        let correlation =
            x.windows(201).map(|w| w[0] * w[200]).sum::<f64>() / (power * (x.len() - 200) as f64);
        assert!(
            (correlation - (-1.0_f64).exp()).abs() < 0.08,
            "{correlation}"
        );
        let pole = (-0.005_f64).exp();
        let expected = 1.0 / 12.0 * (1.0 - pole) / (1.0 + pole);
        assert!(
            (power / expected - 1.0).abs() < 0.08,
            "{}",
            power / expected
        );
    }

    #[test]
    fn relative_noise_meets_the_printed_ratio() {
        let truth: Vec<f64> = (0..3000)
            .map(|k| 30.0 + 7.0 * (0.01 * f64::from(k)).sin())
            .collect();
        for (w_um, eta_um, eps_um, ns_pct) in [
            (100.0, 500.0, 2.0, 41.78),
            (10_000.0, 1.0, 2.0, 43.48),
            (100.0, 10.0, 100.0, 17.03),
            (0.0, 1.0, 0.0, 1.2),
        ] {
            let condition = Condition {
                w_um,
                eta_um,
                eps_um,
                dt_ms: 1.0,
                ns_pct,
                reading: Reading::Relative,
            };
            let (measured, _) = condition.measure(&truth, 9);
            let error: Vec<f64> = measured.iter().zip(&truth).map(|(m, y)| m - y).collect();
            let ratio = 100.0 * rms(&error) / rms_about_mean(&truth);
            assert!((ratio / ns_pct - 1.0).abs() < 1e-5, "{ratio} for {ns_pct}");
        }
    }

    #[test]
    fn resolution_rounds_to_multiples() {
        assert_eq!(quantised(0.0124, 0.005), 0.01);
        assert_eq!(quantised(0.3, 0.0), 0.3);
        let condition = Condition {
            eps_um: 10.0,
            ..Condition::CLEAN
        };
        let truth: Vec<f64> = (0..5000).map(|k| 0.000_731 * f64::from(k)).collect();
        let (measured, scale) = condition.measure(&truth, 1);
        assert_eq!(scale, 1.0);
        let error: Vec<f64> = measured.iter().zip(&truth).map(|(m, y)| m - y).collect();
        assert!(error.iter().all(|e| e.abs() <= 0.005 + 1e-12));
        assert!((rms(&error) - 0.01 / 12f64.sqrt()).abs() < 1e-4);
    }

    #[test]
    fn the_same_seed_gives_the_same_noise() {
        let condition = Condition::white(10.0);
        assert_eq!(noise(condition, 1, 50), noise(condition, 1, 50));
        assert_ne!(noise(condition, 1, 50), noise(condition, 2, 50));
    }
}
