//! How often the true value lies within the reported standard deviations.

use std::ops::Range;

use trendid::trends::{FilteredTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};

use crate::paper::iterations::own_numerators;
use crate::signals::experiment::{Experiment, Record};

/// a1, a2, b0, C, omega0, xi of the reference servo.
const TRUTH: [f64; 6] = [400.0, 20.0, 1e6, 2500.0, 20.0, 0.5];

/// The range of u and of y that the user gives.
pub type Ranges = (f32, f32);

/// The scores of one record.
pub type Scored = fn(&Record, Ranges) -> [f64; 6];

fn design(range: Ranges) -> Config<3, 5, 1> {
    Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [range.0], range.1)
}

/// Scores of the default of the core.
///
/// # Panics
/// When the core refuses the configuration of this file.
pub fn default(record: &Record, range: Ranges) -> [f64; 6] {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let mut identifier = Identifier::try_new(&design(range), trends).unwrap();
    for s in record.samples() {
        let _ = identifier.update(s.u as f32, s.y as f32);
    }
    scores(&identifier)
}

/// Scores of the exact hold with the filter for a model.
///
/// # Panics
/// When the core refuses the configuration of this file.
pub fn exact(record: &Record, range: Ranges) -> [f64; 6] {
    scores(&own_numerators(&design(range), record, 1).unwrap())
}

/// Scores of the exact hold with the model of the record itself.
///
/// # Panics
/// When the core refuses the configuration of this file.
pub fn own(record: &Record, range: Ranges) -> [f64; 6] {
    scores(&own_numerators(&design(range), record, 2).unwrap())
}

/// Errors over reported standard deviations of a1, a2, b0, C, omega0, xi.
fn scores<T: TrendOperator<3>>(identifier: &Identifier<T, 3, 5>) -> [f64; 6] {
    let estimate = identifier.estimate();
    let theta = estimate.theta();
    let std = estimate.std();
    let reading = estimate.physical();
    let physical = [reading.gain, reading.omega0, reading.damping].map(|v| v.unwrap_or(f32::NAN));
    let physical_std = estimate.physical_std().unwrap_or([f32::NAN; 3]);
    let found = [
        theta[0],
        theta[1],
        theta[2],
        physical[0],
        physical[1],
        physical[2],
    ];
    let sigma = [
        std[0],
        std[1],
        std[2],
        physical_std[0],
        physical_std[1],
        physical_std[2],
    ];
    core::array::from_fn(|i| (f64::from(found[i]) - TRUTH[i]) / f64::from(sigma[i]))
}

/// Share of the runs within 1 and within 3 sigma \[%\].
pub fn coverage(
    name: &str,
    scored: Scored,
    experiment: &Experiment,
    range: Ranges,
    seeds: Range<u64>,
) -> [[f64; 6]; 2] {
    let mut inside = [[0.0; 6]; 2];
    let share = 100.0 / seeds.clone().count() as f64;
    for seed in seeds.clone() {
        let z = scored(&experiment.record(seed), range);
        for i in 0..6 {
            // NaN is outside.
            inside[0][i] += if z[i].abs() <= 1.0 { share } else { 0.0 };
            inside[1][i] += if z[i].abs() <= 3.0 { share } else { 0.0 };
        }
    }
    println!(
        "{name}, seeds {seeds:?}: within 1 sigma {:.1?}, 3 sigma {:.1?} %",
        inside[0], inside[1]
    );
    inside
}
