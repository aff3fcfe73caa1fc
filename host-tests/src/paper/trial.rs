//! One record of Table 1 through every method: the core with each trend filter, and the opponents.
//!
//! A *trial* is one seed of one setting. All methods see the same record, and the bound is that of
//! this record. What the trials of many seeds give together is in [`crate::paper::statistics`].

use trendid::instruments::{self, Instrumented, Way};
use trendid::trends::{
    ExactTrends, FilteredTrends, IntegralTrends, RawTrends, Scheme, TrendOperator,
};
use trendid::{Config, ConfigError, Identifier, Structure};

use crate::oracles::cramer_rao::{InitialState, servo_bound_pct};
use crate::oracles::ekf::{ExtendedKalman, Prior};
pub use crate::paper::methods::{Filter, Method, Setting};
use crate::paper::offline::output_error_fit;
use crate::paper::transient::{Run, Transient};
use crate::plants::servo::{REFERENCE, Servo};
use crate::signals::experiment::{Experiment, Record, Sample};
use crate::signals::noise::{rms, rms_about_mean};

/// One record and what every method made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Noise to signal of this record \[%\]: rms about zero over rms about the mean.
    pub ns_pct: f64,
    /// Cramer-Rao bound \[%\] for white noise of the rms of this record and an unknown position at
    /// the start; infinite when the record determines nothing.
    pub bound_pct: [f64; 3],
    /// In the order of the methods asked for.
    pub runs: Vec<Run>,
}

/// Runs the methods over the record of a seed.
///
/// # Panics
/// When the core refuses a configuration of this file or a method finds nothing in an excited
/// record.
pub fn trial(setting: &Setting, duration_s: f64, seed: u64, methods: &[Method]) -> Trial {
    let record = Experiment::reference(setting.condition, duration_s).record(seed);
    let sigma = rms(&record.noise());
    let bound = servo_bound_pct(
        &REFERENCE,
        record.dt,
        &record.u,
        sigma,
        InitialState::PositionUnknown,
    );
    // Both read-outs of one recursion come from one pass.
    let mut passes: Vec<(Scheme, Filter, [Run; 2])> = Vec::new();
    let runs = methods
        .iter()
        .map(|method| match *method {
            Method::Kalman => kalman(&record, sigma),
            Method::OutputError => offline(&record),
            Method::Instruments => {
                instrumented(&record).unwrap_or_else(|e| panic!("instruments: {e}"))
            }
            Method::Core {
                scheme,
                filter,
                compensated,
            } => {
                let known = passes.iter().find(|p| (p.0, p.1) == (scheme, filter));
                let both = match known {
                    Some(pass) => pass.2,
                    None => {
                        let both = core(&record, scheme, filter)
                            .unwrap_or_else(|e| panic!("{scheme:?} {filter:?}: {e}"));
                        passes.push((scheme, filter, both));
                        both
                    }
                };
                both[usize::from(compensated)]
            }
        })
        .collect();
    Trial {
        ns_pct: 100.0 * sigma / rms_about_mean(&record.y_true),
        bound_pct: bound.unwrap_or([f64::INFINITY; 3]),
        runs,
    }
}

/// Whether the read-out is taken at sample `k`: every 2 ms and at the end.
fn looks(record: &Record, k: usize) -> bool {
    let stride = (2e-3 / record.dt).round().max(1.0) as usize;
    k.is_multiple_of(stride) || k + 1 == record.len()
}

/// Bare least squares and the core's read-out.
fn core(record: &Record, scheme: Scheme, filter: Filter) -> Result<[Run; 2], ConfigError> {
    assert!(filter.goes_with(scheme), "{filter:?} of {scheme:?}");
    let dt = record.dt as f32;
    let bare = Structure::<3, 3, 1>::INTEGRATING;
    match filter {
        Filter::None => single(record, RawTrends::try_new(scheme, dt)?, bare),
        Filter::Default => single(
            record,
            FilteredTrends::for_bandwidth(scheme, dt, BANDWIDTH)?,
            Structure::<3, 5, 1>::SERVO,
        ),
        Filter::Ramp => ramp(record, scheme),
        Filter::Exact => single(
            record,
            ExactTrends::for_bandwidth(dt, BANDWIDTH)?,
            Structure::<3, 5, 1>::SERVO,
        ),
        // The span is a size: one type per interval of the table.
        Filter::Span => match (0.07 / record.dt).round() as usize {
            280 => single(record, IntegralTrends::<3, 280>::try_new(scheme, dt)?, bare),
            140 => single(record, IntegralTrends::<3, 140>::try_new(scheme, dt)?, bare),
            70 => single(record, IntegralTrends::<3, 70>::try_new(scheme, dt)?, bare),
            35 => single(record, IntegralTrends::<3, 35>::try_new(scheme, dt)?, bare),
            14 => single(record, IntegralTrends::<3, 14>::try_new(scheme, dt)?, bare),
            length => panic!("no span of {length} samples is compiled"),
        },
    }
}

/// What the user knows of the plant \[rad/s\].
const BANDWIDTH: f32 = 20.0;

/// The core with the time as a second input, and what is known of a slow drift.
fn ramp(record: &Record, scheme: Scheme) -> Result<[Run; 2], ConfigError> {
    // (s + 3.5)(s^2 + 59.5 s + 1225)
    let filter = [4287.5, 1433.25, 63.0];
    let trends = FilteredTrends::from_polynomial(scheme, record.dt as f32, filter)?;
    let inputs = |s: &Sample| [s.u as f32, s.t as f32];
    let mut config = usual(record, Structure::<3, 6, 2>::SERVO, inputs);
    // Relative to the command: 0.3 % of offset, moving by 0.7 % a second.
    // The prior by default: ten times the design, and 3 % for the constant.
    let fresh: Identifier<_, 3, 6, 2> = Identifier::try_new(&config, trends.clone())?;
    let mut std = fresh.recursion().std();
    std[3] *= 0.0007 * config.input_range[1];
    std[4] *= 0.1;
    config.prior_std = Some(std);
    config.offset_significance = 0.0;
    pass(record, &config, trends, inputs)
}

fn single<T: TrendOperator<3>, const N: usize>(
    record: &Record,
    trends: T,
    structure: Structure<3, N, 1>,
) -> Result<[Run; 2], ConfigError> {
    let inputs = |s: &Sample| [s.u as f32];
    pass(record, &usual(record, structure, inputs), trends, inputs)
}

/// What a user gives; the largest value of each input stands for what is known of its size.
fn usual<const N: usize, const I: usize>(
    record: &Record,
    structure: Structure<3, N, I>,
    inputs: impl Fn(&Sample) -> [f32; I],
) -> Config<3, N, I> {
    let mut ranges = [0.0_f32; I];
    for s in record.samples() {
        for (range, u) in ranges.iter_mut().zip(inputs(&s)) {
            *range = range.max(u.abs());
        }
    }
    Config::new(structure, BANDWIDTH, ranges, 50.0)
}

fn pass<T: TrendOperator<3>, const N: usize, const I: usize>(
    record: &Record,
    config: &Config<3, N, I>,
    trends: T,
    inputs: impl Fn(&Sample) -> [f32; I],
) -> Result<[Run; 2], ConfigError> {
    let mut identifier: Identifier<T, 3, N, I> = Identifier::try_new(config, trends)?;
    let mut transients = [Transient::new(record), Transient::new(record)];
    for (k, s) in record.samples().enumerate() {
        let _ = identifier.update_inputs(inputs(&s), s.y as f32);
        if looks(record, k) {
            let bare = identifier.recursion().theta();
            transients[0].push(s.t, [0, 1, 2].map(|i| f64::from(bare[i])));
            let read = identifier.theta();
            transients[1].push(s.t, [0, 1, 2].map(|i| f64::from(read[i])));
        }
    }
    Ok(transients.map(Transient::finish))
}

fn kalman(record: &Record, sigma: f64) -> Run {
    let mut filter = ExtendedKalman::new(&Prior::tuned(sigma), sigma, record.dt);
    let mut transient = Transient::new(record);
    for (k, s) in record.samples().enumerate() {
        filter.update(s.u, s.y);
        if looks(record, k) {
            let found = filter.servo();
            let [_, a1, a2] = found.a();
            transient.push(s.t, [a1, a2, found.b0()]);
        }
    }
    transient.finish()
}

fn offline(record: &Record) -> Run {
    let error_pct = output_error_fit(record)
        .and_then(|fit| Servo::from_coefficients(fit.theta[0], fit.theta[1], fit.theta[2]))
        .map_or([f64::INFINITY; 3], |found| found.error_pct(&REFERENCE));
    Run {
        error_pct,
        conv: None,
        settled_ms: None,
        weak: false,
    }
}

fn instrumented(record: &Record) -> Result<Run, ConfigError> {
    const SERVO: Structure<3, 5, 1> = Structure::SERVO;
    const ROWS: usize = instruments::rows(&SERVO);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, record.dt as f32, BANDWIDTH)?;
    let config = usual(record, SERVO, |s| [s.u as f32]);
    let mut servo: Instrumented<_, 3, 5, 1, ROWS> = Instrumented::try_new(&config, trends)?;
    for s in record.samples() {
        let _ = servo.update(s.u as f32, s.y as f32);
    }
    let found = servo.estimate();
    let [a1, a2, b0] = [0, 1, 2].map(|i| f64::from(found.estimate.theta()[i]));
    Ok(Run {
        error_pct: Servo::from_coefficients(a1, a2, b0)
            .map_or([f64::INFINITY; 3], |found| found.error_pct(&REFERENCE)),
        conv: None,
        settled_ms: None,
        weak: found.way != Way::Instruments,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::noise::{Condition, Reading};

    #[test]
    fn compensation_is_the_only_difference_between_the_read_outs() {
        let both = |setting: &Setting| {
            let methods = [false, true].map(|compensated| Method::Core {
                scheme: Scheme::Tustin,
                filter: Filter::Default,
                compensated,
            });
            trial(setting, 0.5, 1, &methods).runs
        };
        let mut setting = Setting::all(Reading::Absolute)[0];
        setting.condition = Condition::CLEAN;
        let clean = both(&setting);
        for i in 0..3 {
            let apart = clean[0].error_pct[i] - clean[1].error_pct[i];
            assert!(apart.abs() < 0.01, "{clean:?}");
        }
        setting.condition = Condition::white(500.0);
        assert_ne!(both(&setting)[0], both(&setting)[1]);
    }
}
