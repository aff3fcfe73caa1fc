//! Excitation: binary noise, steps, squares, multisine, chirp, and a fixed controller for closed
//! loops.

use std::f64::consts::PI;

use rand::RngExt;

use crate::signals::noise::{Stream, generator};
use crate::signals::shift_register::ShiftRegister;

/// A command or reference as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Excitation {
    /// Pseudo-random binary sequence, `+-amplitude`, each bit held `hold_s`; the seed sets the
    /// phase of the register.
    Prbs {
        /// Amplitude.
        amplitude: f64,
        /// Time of one bit \[s\].
        hold_s: f64,
        /// Cells of the shift register, 3 to 16.
        bits: u32,
    },
    /// Steps to levels drawn uniformly from `+-amplitude`, each held `hold_s`.
    Steps {
        /// Largest level.
        amplitude: f64,
        /// Time of one level \[s\].
        hold_s: f64,
    },
    /// Square wave that starts positive.
    Square {
        /// Amplitude.
        amplitude: f64,
        /// Period \[s\].
        period_s: f64,
    },
    /// Sum of `lines` equal sines at `first_hz`, `2 first_hz`, .. with seeded phases; peak below
    /// `amplitude`.
    Multisine {
        /// Bound of the peak; each line has the amplitude divided by the number of lines.
        amplitude: f64,
        /// Lowest frequency and distance of the lines \[Hz\].
        first_hz: f64,
        /// Number of lines.
        lines: u32,
    },
    /// Sine whose frequency rises linearly over the record.
    Chirp {
        /// Amplitude.
        amplitude: f64,
        /// Frequency at the begin \[Hz\].
        from_hz: f64,
        /// Frequency at the end \[Hz\].
        to_hz: f64,
    },
    /// A constant.
    Constant(f64),
}

impl Excitation {
    /// Binary noise of the reading ABSOLUTE: +-0.4 held 50 ms.
    pub const ABSOLUTE: Self = Self::Prbs {
        amplitude: 0.4,
        hold_s: 0.05,
        bits: 11,
    };

    /// Binary noise of the reading RELATIVE: +-1 held 40 ms.
    pub const RELATIVE: Self = Self::Prbs {
        amplitude: 1.0,
        hold_s: 0.04,
        bits: 11,
    };

    /// `n` samples at intervals of `dt` seconds; the same seed gives the same sequence.
    pub fn sequence(&self, n: usize, dt: f64, seed: u64) -> Vec<f64> {
        let mut random = generator(seed, Stream::Excitation);
        match *self {
            Self::Prbs {
                amplitude,
                hold_s,
                bits,
            } => {
                let content = random.random_range(1..1_u32 << bits);
                let register = ShiftRegister::new(bits, content);
                held(
                    n,
                    dt,
                    hold_s,
                    register.map(|b| if b { amplitude } else { -amplitude }),
                )
            }
            Self::Steps { amplitude, hold_s } => {
                let levels = std::iter::repeat_with(|| amplitude * random.random_range(-1.0..1.0));
                held(n, dt, hold_s, levels)
            }
            Self::Square {
                amplitude,
                period_s,
            } => {
                let levels = [amplitude, -amplitude].into_iter().cycle();
                held(n, dt, 0.5 * period_s, levels)
            }
            Self::Multisine {
                amplitude,
                first_hz,
                lines,
            } => {
                let phases: Vec<f64> = (0..lines)
                    .map(|_| random.random_range(0.0..2.0 * PI))
                    .collect();
                let each = amplitude / f64::from(lines);
                (0..n)
                    .map(|k| sum_of_sines(each, &phases, first_hz, k as f64 * dt))
                    .collect()
            }
            Self::Chirp {
                amplitude,
                from_hz,
                to_hz,
            } => {
                let rate = (to_hz - from_hz) / (n as f64 * dt);
                let phase = |t: f64| 2.0 * PI * (from_hz * t + 0.5 * rate * t * t);
                (0..n)
                    .map(|k| amplitude * phase(k as f64 * dt).sin())
                    .collect()
            }
            Self::Constant(value) => vec![value; n],
        }
    }
}

/// Sum of sines of this amplitude at the multiples of a frequency, each with its phase.
fn sum_of_sines(amplitude: f64, phases: &[f64], first_hz: f64, t: f64) -> f64 {
    let sine = |(p, i): (&f64, i32)| amplitude * (2.0 * PI * first_hz * f64::from(i) * t + p).sin();
    phases.iter().zip(1..).map(sine).sum()
}

/// Holds each level for `hold_s` rounded to whole samples, at least one.
fn held(n: usize, dt: f64, hold_s: f64, levels: impl Iterator<Item = f64>) -> Vec<f64> {
    let width = ((hold_s / dt).round() as usize).max(1);
    levels
        .flat_map(|level| std::iter::repeat_n(level, width))
        .take(n)
        .collect()
}

/// Fixed controller for closed-loop records: `u = sat(kp (r - y) - kv v)`.
///
/// `v` is the difference of `y` through a first-order lag, as a drive without a velocity sensor
/// forms it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    /// Position gain \[command per mm\].
    pub kp: f64,
    /// Velocity gain \[command per mm/s\].
    pub kv: f64,
    /// Time constant of the velocity \[s\].
    pub lag_s: f64,
    /// Largest magnitude of the command.
    pub limit: f64,
    last: Option<f64>,
    velocity: f64,
}

impl Controller {
    /// Gains for the reference servo: slowest pole near -6 rad/s, command within +-1.
    pub const SERVO: Self = Self::new(0.004, 0.0003, 0.002, 1.0);

    /// A controller at rest.
    pub const fn new(kp: f64, kv: f64, lag_s: f64, limit: f64) -> Self {
        Self {
            kp,
            kv,
            lag_s,
            limit,
            last: None,
            velocity: 0.0,
        }
    }

    /// Command for reference `r` and measured position `y`, once per sample of `dt` seconds.
    pub fn command(&mut self, r: f64, y: f64, dt: f64) -> f64 {
        let raw = (y - self.last.unwrap_or(y)) / dt;
        self.last = Some(y);
        self.velocity += dt / (self.lag_s + dt) * (raw - self.velocity);
        (self.kp * (r - y) - self.kv * self.velocity).clamp(-self.limit, self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary_noise_is_held_and_seeded() {
        let u = Excitation::ABSOLUTE.sequence(1000, 1e-3, 7);
        assert!(
            u.chunks(50)
                .all(|c| c.iter().all(|v| *v == c[0] && v.abs() == 0.4))
        );
        assert_eq!(u, Excitation::ABSOLUTE.sequence(1000, 1e-3, 7));
        assert_ne!(u, Excitation::ABSOLUTE.sequence(1000, 1e-3, 8));
        let slow = Excitation::RELATIVE.sequence(200, 5e-3, 7);
        assert!(slow.chunks(8).all(|c| c.iter().all(|v| *v == c[0])));
    }

    #[test]
    fn square_chirp_steps_and_multisine_have_their_shape() {
        let square = Excitation::Square {
            amplitude: 2.0,
            period_s: 0.1,
        };
        let s = square.sequence(100, 1e-3, 0);
        assert!(s[..50].iter().all(|v| *v == 2.0) && s[50..].iter().all(|v| *v == -2.0));

        let chirp = Excitation::Chirp {
            amplitude: 1.0,
            from_hz: 1.0,
            to_hz: 9.0,
        };
        // Mean frequency 5 Hz over 2 s: ten periods, twenty changes of sign less the start.
        let c = chirp.sequence(2000, 1e-3, 0);
        let crossings = c.windows(2).filter(|w| w[0] * w[1] < 0.0).count();
        assert!((18..=20).contains(&crossings), "{crossings}");

        let steps = Excitation::Steps {
            amplitude: 3.0,
            hold_s: 0.02,
        };
        let s = steps.sequence(10_000, 1e-3, 5);
        let mean_square = s.iter().map(|v| v * v).sum::<f64>() / 1e4;
        assert!((mean_square - 3.0).abs() < 0.5, "{mean_square}");

        let multisine = Excitation::Multisine {
            amplitude: 1.0,
            first_hz: 0.5,
            lines: 10,
        };
        let m = multisine.sequence(2000, 1e-3, 5);
        assert!(m.iter().all(|v| v.abs() <= 1.0));
        let power = m.iter().map(|v| v * v).sum::<f64>() / 2e3;
        // Ten orthogonal lines of amplitude 0.1 over a whole period.
        assert!((power - 0.05).abs() < 1e-6, "{power}");
    }

    #[test]
    fn controller_brings_the_servo_to_its_reference() {
        let mut plant = crate::plants::servo::REFERENCE.plant(1e-3);
        let mut controller = Controller::SERVO;
        for _ in 0..4000 {
            let u = controller.command(50.0, plant.output(), 1e-3);
            plant.step(&[u]);
        }
        assert!((plant.output() - 50.0).abs() < 0.01, "{}", plant.output());
    }
}
