//! Standard deviations side by side: of least squares from a model of the noise, white and an
//! excess, and from blocks of the record, and of instruments from blocks.

use rand::RngExt;
use trendid::batches::Batched;
use trendid::instruments::{self, Instrumented, Way};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Estimate, Structure};

use crate::oracles::cramer_rao::{InitialState, servo_bound_pct};
use crate::plants::servo::REFERENCE;
use crate::signals::excitation::Excitation;
use crate::signals::experiment::{Experiment, Record};
use crate::signals::noise::{Condition, Reading, Stream, generator, rms, rms_about_mean};

/// What disturbs the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// White, 8.35 % of the movement.
    White,
    /// White, 42 %.
    StrongWhite,
    /// White through a lag of 200 ms, 8.35 %.
    Drift,
    /// White through a lag of 20 ms, as fast as the drive, 8.35 %.
    Coloured,
    /// White of 20 mm full width in a closed position loop, about 13 %.
    ClosedLoop,
    /// A resolution of 100 um, strokes of some 10 mm.
    Quantised,
}

impl Noise {
    /// Every kind, in the order of the table.
    pub const ALL: [Self; 6] = [
        Self::White,
        Self::StrongWhite,
        Self::Drift,
        Self::Coloured,
        Self::ClosedLoop,
        Self::Quantised,
    ];

    /// Name in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::StrongWhite => "white 42 %",
            Self::Drift => "drift",
            Self::Coloured => "coloured",
            Self::ClosedLoop => "closed loop",
            Self::Quantised => "quantised",
        }
    }

    /// The record of a seed.
    ///
    /// # Panics
    /// Never for the plants of this file.
    pub fn record(self, seconds: f64, seed: u64) -> Record {
        let relative = |w_um: f64, eta_um: f64, ns_pct: f64| Condition {
            w_um,
            eta_um,
            ns_pct,
            reading: Reading::Relative,
            ..Condition::CLEAN
        };
        match self {
            Self::White => Experiment::reference(relative(0.0, 1.0, 8.35), seconds).record(seed),
            Self::StrongWhite => {
                Experiment::reference(relative(0.0, 1.0, 42.0), seconds).record(seed)
            }
            Self::Drift => Experiment::reference(relative(1.0, 0.0, 8.35), seconds).record(seed),
            Self::Coloured => {
                let mut experiment = Experiment::reference(Condition::CLEAN, seconds);
                experiment.excitation = Excitation::RELATIVE;
                let mut record = experiment.record(seed);
                let mut random = generator(seed, Stream::Drift);
                let mut lagged = 0.0;
                let noise: Vec<f64> = (0..record.len())
                    .map(|_| {
                        lagged += 0.05 * (random.random_range(-1.0..1.0) - lagged);
                        lagged
                    })
                    .collect();
                let scale = 0.0835 * rms_about_mean(&record.y_true) / rms(&noise);
                for (y, noise) in record.y.iter_mut().zip(noise) {
                    *y += scale * noise;
                }
                record
            }
            Self::ClosedLoop => {
                Experiment::closed_loop(Condition::white(20_000.0), seconds).record(seed)
            }
            Self::Quantised => {
                let condition = Condition {
                    eps_um: 100.0,
                    ..Condition::CLEAN
                };
                Experiment::reference(condition, seconds).record(seed)
            }
        }
    }
}

/// One estimate against the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Signed errors of C, omega0, xi \[%\]; infinite without a reading.
    pub error_pct: [f64; 3],
    /// The same in standard deviations.
    pub z: [f64; 3],
}

/// What the estimators made of one record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// The recursion, noise bias taken out.
    pub least_squares: Score,
    /// The same estimate with standard deviations from blocks, or what stands in for them.
    pub batches: Score,
    /// Whether the blocks were enough.
    pub by_blocks: bool,
    /// Instruments, or what stands in for them.
    pub instruments: Score,
    /// Whether instruments were used.
    pub used: bool,
    /// Cramer-Rao bound of C, omega0, xi for white noise of this size \[%\].
    pub bound_pct: [f64; 3],
}

/// The estimate of a servo against C, omega0 and xi.
pub(super) fn score(estimate: &Estimate<3, 5, 1>, truth: [f64; 3]) -> Score {
    let physical = estimate.physical();
    let std = estimate.physical_std().unwrap_or([f32::NAN; 3]);
    let found = [physical.gain, physical.omega0, physical.damping];
    let off: [f64; 3] =
        core::array::from_fn(|i| found[i].map_or(f64::INFINITY, |v| f64::from(v) - truth[i]));
    Score {
        error_pct: core::array::from_fn(|i| 100.0 * off[i] / truth[i]),
        z: core::array::from_fn(|i| off[i] / f64::from(std[i])),
    }
}

/// C, omega0 and xi of the reference.
const TRUTH: [f64; 3] = [2500.0, 20.0, 0.5];

/// The estimators over the record of a seed.
///
/// # Panics
/// When the core refuses the configuration of this file.
pub fn scores(noise: Noise, seconds: f64, seed: u64) -> Scores {
    const SERVO: Structure<3, 5, 1> = Structure::SERVO;
    const ROWS: usize = instruments::rows(&SERVO);
    let record = noise.record(seconds, seed);
    let range = record.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, record.dt as f32, 20.0)
        .unwrap_or_else(|e| panic!("{e}"));
    let config = Config::new(SERVO, 20.0, [range as f32], 50.0);
    let mut servo: Instrumented<_, 3, 5, 1, ROWS> =
        Instrumented::try_new(&config, trends.clone()).unwrap_or_else(|e| panic!("{e}"));
    let mut batched: Batched<_, 3, 5> =
        Batched::try_new(&config, trends).unwrap_or_else(|e| panic!("{e}"));
    for sample in record.samples() {
        let _ = servo.update(sample.u as f32, sample.y as f32);
        let _ = batched.update(sample.u as f32, sample.y as f32);
    }
    let (found, batches) = (servo.estimate(), batched.estimate());
    let bound = servo_bound_pct(
        &REFERENCE,
        record.dt,
        &record.u,
        rms(&record.noise()),
        InitialState::PositionUnknown,
    );
    Scores {
        least_squares: score(&servo.identifier().estimate(), TRUTH),
        batches: score(&batches.estimate, TRUTH),
        by_blocks: batches.by_blocks,
        instruments: score(&found.estimate, TRUTH),
        used: found.way == Way::Instruments,
        bound_pct: bound.unwrap_or([f64::INFINITY; 3]),
    }
}
