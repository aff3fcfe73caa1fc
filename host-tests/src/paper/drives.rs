//! Servo drives drawn by a seed, and with them what a user says of them: the default of the core
//! over a population instead of the one drive of the paper.
//!
//! ```text
//! C 50 to 5000 mm/s, omega0 5 to 90 rad/s, xi 0.1 to 1.2; sampled every 0.5, 1 or 2 ms
//! binary or many-level commands of 0.1 to 1, held for 0.3 to 4 / omega0, over 20 to 600 / omega0
//! white noise of 0.3 to 42 % of the movement, an offset of the valve up to 10 % of the command
//! told: a bandwidth within a factor of 3, ranges of u and y within factors of 2 and 3; a memory or none
//! ```
//!
//! All that has a range of more than a factor is even in its logarithm.

use rand::RngExt;
use trendid::instruments::{self, Instrumented};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Structure};

use crate::paper::sigma::{Score, score};
use crate::plants::servo::Servo;
use crate::random::{Random, log_uniform};
use crate::signals::excitation::Excitation;
use crate::signals::experiment::Experiment;
use crate::signals::noise::{Condition, Stream, generator};

const SERVO: Structure<3, 5, 1> = Structure::SERVO;
const ROWS: usize = instruments::rows(&SERVO);

/// A drive, its record and what is told of it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The drive.
    pub truth: Servo,
    /// The record of it.
    pub experiment: Experiment,
    /// Noise of the position, of its movement \[%\].
    pub noise_pct: f64,
    /// What the identifier is told.
    pub config: Config<3, 5, 1>,
}

impl Drawn {
    /// The drive of a seed.
    ///
    /// # Panics
    /// Never for the ranges of this file.
    pub fn of(seed: u64) -> Self {
        let mut random = generator(seed, Stream::Other);
        let mut within = |low: f64, high: f64| log_uniform(&mut random, low, high);
        let truth = Servo {
            c: within(50.0, 5000.0),
            omega0: within(5.0, 90.0),
            xi: within(0.1, 1.2),
        };
        let noise_pct = within(0.3, 42.0);
        let seconds = within(20.0, 600.0) / truth.omega0;
        let amplitude = within(0.1, 1.0);
        let hold_s = within(0.3, 4.0) / truth.omega0;
        let bandwidth = truth.omega0 * within(1.0 / 3.0, 3.0);
        let ranges = [
            amplitude * within(0.5, 2.0),
            truth.c * amplitude / truth.omega0 * within(1.0 / 3.0, 3.0),
        ];
        let mut condition = Condition::white_relative(noise_pct);
        condition.dt_ms = [0.5, 1.0, 2.0][random.random_range(0..3)];
        let mut experiment = Experiment::reference(condition, seconds);
        experiment.plant = truth.plant(condition.dt());
        experiment.excitation = excitation(&mut random, amplitude, hold_s);
        if random.random_bool(0.7) {
            experiment.valve.offset = 0.1 * amplitude * random.random_range(-1.0..1.0);
        }
        let [u, y] = ranges.map(|range| range as f32);
        let mut config = Config::new(SERVO, bandwidth as f32, [u], y);
        config.memory = [None, Some(2.0), Some(10.0)][random.random_range(0..3)];
        Self {
            truth,
            experiment,
            noise_pct,
            config,
        }
    }

    /// The default of the core and instruments, over the record of a seed.
    ///
    /// # Panics
    /// When the core refuses what is drawn here.
    pub fn scores(&self, seed: u64) -> [Score; 2] {
        let record = self.experiment.record(seed);
        let trends =
            FilteredTrends::for_bandwidth(Scheme::Tustin, record.dt as f32, self.config.bandwidth)
                .unwrap_or_else(|e| panic!("{e}"));
        let mut servo: Instrumented<_, 3, 5, 1, ROWS> =
            Instrumented::try_new(&self.config, trends).unwrap_or_else(|e| panic!("{e}"));
        for sample in record.samples() {
            let _ = servo.update(sample.u as f32, sample.y as f32);
        }
        let truth = [self.truth.c, self.truth.omega0, self.truth.xi];
        [servo.identifier().estimate(), servo.estimate().estimate]
            .map(|estimate| score(&estimate, truth))
    }
}

fn excitation(random: &mut Random, amplitude: f64, hold_s: f64) -> Excitation {
    match random.random_bool(0.5) {
        true => Excitation::Prbs {
            amplitude,
            hold_s,
            bits: 11,
        },
        false => Excitation::Steps { amplitude, hold_s },
    }
}
