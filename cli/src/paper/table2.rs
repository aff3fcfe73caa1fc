//! `trendid paper table2`: the paper's Table 2 again, structures of every size and what IQ says of
//! them.
//!
//! IQ is the paper's name of the sum of squared errors (ISE); it stays where the printed table is
//! compared.

use trendid::estimation::Terms;
use trendid::model::OutputEvaluation;
use trendid::trends::{FilteredTrends, RawTrends, Scheme};
use trendid::{ConfigError, TransferFunction};
use trendid_host_tests::paper::statistics::quantile;
use trendid_host_tests::plants::linear::LinearPlant;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;
use trendid_identify::Estimate;
use trendid_identify::dynamic::{Filter, Setup, settings};

use crate::output::{self, Refusal};
use crate::paper::args::{Table2Args, check};
use crate::paper::found::{Found, NO, SIZES, Size};
use crate::paper::table2_text::{as_json, csv, plain};
use crate::seeds::seeds;

/// Rough design values, all that the identifier gets: rad/s, and mm of movement.
const BANDWIDTH: f32 = 20.0;
const MOVEMENT: f32 = 50.0;

/// Identifies every structure and prints the table.
pub(super) fn run(args: &Table2Args) -> Result<(), Refusal> {
    check(Some(args.duration))?;
    let seeds = seeds("--seeds", args.seeds, args.first_seed)?;
    let found = all(args, &seeds)?;
    if args.csv {
        output::emit(&csv(args, &found))?;
    } else if args.json {
        output::emit_json(&as_json(args, &found))?;
    } else {
        output::emit(&plain(args, &found))?;
    }
    Ok(())
}

fn all(args: &Table2Args, seeds: &[u64]) -> Result<Vec<Found>, Refusal> {
    let condition = Condition {
        w_um: 100.0,
        eta_um: 10.0,
        eps_um: 10.0,
        dt_ms: 1.0,
        ns_pct: 1.97,
        reading: args.reading.into(),
    };
    let experiment = Experiment::reference(condition, args.duration);
    let mut kinds = Vec::new();
    for size in SIZES {
        for filtered in [false, true] {
            for scheme in [Scheme::Goodwin, Scheme::Tustin] {
                kinds.push((size, scheme, filtered));
            }
        }
    }
    let bar = output::progress(args.seeds, "records");
    let values = output::under(&bar, seeds, |seed| {
        let record = experiment.record(*seed);
        let fresh = experiment.record(seed + 500_000);
        kinds
            .iter()
            .map(|&(size, scheme, filtered)| one(size, scheme, filtered, &record, &fresh))
            .collect()
    });
    let values: Vec<Vec<[f64; 8]>> = values.into_iter().collect::<Result<_, ConfigError>>()?;
    bar.finish_and_clear();
    Ok(kinds
        .iter()
        .enumerate()
        .map(|(k, &(size, scheme, filtered))| {
            let at = |i: usize, share: f64| {
                quantile(values.iter().map(|record| record[k][i]).collect(), share)
            };
            let index = [0, 1, 2, 3, 4, 5, 6, 7];
            Found {
                size,
                scheme,
                filtered,
                median: index.map(|i| at(i, 0.5)),
                spread: index.map(|i| 0.5 * (at(i, 0.75) - at(i, 0.25))),
            }
        })
        .collect())
}

/// The core for one structure over one record.
fn setup(
    size: Size,
    scheme: Scheme,
    filtered: bool,
    record: &Record,
) -> Result<Setup, ConfigError> {
    let (dt, order) = (record.dt as f32, size.m + 1);
    let polynomial = match order {
        2 => FilteredTrends::<2>::for_bandwidth(scheme, dt, BANDWIDTH)?
            .filter()
            .to_vec(),
        3 => FilteredTrends::<3>::for_bandwidth(scheme, dt, BANDWIDTH)?
            .filter()
            .to_vec(),
        _ => FilteredTrends::<4>::for_bandwidth(scheme, dt, BANDWIDTH)?
            .filter()
            .to_vec(),
    };
    let amplitude = record.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    Ok(Setup {
        order,
        output: Terms::between(1, order),
        inputs: vec![Terms::up_to(size.numerators)],
        constant: false,
        initial_state: filtered,
        sample_time: dt,
        scheme,
        filter: if filtered {
            Filter::Polynomial(polynomial)
        } else {
            Filter::None
        },
        settings: settings(BANDWIDTH, &[amplitude as f32], MOVEMENT),
    })
}

/// Parameters from `record` related to a2, IQ on `fresh` by (10) and of the free simulation.
fn one(
    size: Size,
    scheme: Scheme,
    filtered: bool,
    record: &Record,
    fresh: &Record,
) -> Result<[f64; 8], ConfigError> {
    let mut core = setup(size, scheme, filtered, record)?.build()?;
    for s in record.samples() {
        let _ = core.update(&[s.u as f32], s.y as f32);
    }
    let found = core.estimate();
    let mut values = [NO; 8];
    let a = |i: usize| found.a.get(i + 1).copied();
    let scale = if size.m == 3 { a(2).unwrap_or(NO) } else { 1.0 };
    if size.m == 3 {
        values[0] = 1.0 / scale;
    }
    values[1] = if size.m == 1 {
        1.0
    } else {
        a(1).unwrap_or(NO) / scale
    };
    values[2] = a(0).unwrap_or(NO) / scale;
    for power in 0..size.numerators {
        values[5 - power] = 1e-6 * found.b[0][power] / scale;
    }
    // mm/s to m/s.
    let unit = 1e-3 / fresh.dt;
    values[6] = unit
        * unit
        * match size.m {
            1 => by_ten::<2>(&found, scheme, fresh)?,
            2 => by_ten::<3>(&found, scheme, fresh)?,
            _ => by_ten::<4>(&found, scheme, fresh)?,
        };
    values[7] = unit * unit * simulated(&found, fresh);
    Ok(values)
}

/// IQ by (10), in mm^2.
fn by_ten<const M: usize>(
    found: &Estimate,
    scheme: Scheme,
    fresh: &Record,
) -> Result<f64, ConfigError> {
    let mut model = TransferFunction::<M, 1> {
        a: [0.0; M],
        b: [[0.0; M]],
        constant: 0.0,
    };
    for (to, from) in model.a.iter_mut().zip(&found.a) {
        *to = *from as f32;
    }
    for (to, from) in model.b[0].iter_mut().zip(&found.b[0]) {
        *to = *from as f32;
    }
    let trends = RawTrends::try_new(scheme, fresh.dt as f32)?;
    let mut evaluation = OutputEvaluation::<M, 1>::new(trends);
    for s in fresh.samples() {
        let _ = evaluation.update(&model, [s.u as f32], (s.y - fresh.y[0]) as f32);
    }
    Ok(f64::from(evaluation.prediction_error().ise()))
}

/// IQ of the velocity of a free simulation from rest, in mm^2; infinite where the model cannot be
/// simulated.
fn simulated(found: &Estimate, fresh: &Record) -> f64 {
    let Ok(mut plant) = LinearPlant::new(&found.a, &found.b[0], fresh.dt) else {
        return f64::INFINITY;
    };
    let y = plant.response(&fresh.u);
    let iq: f64 = y
        .windows(2)
        .zip(fresh.y.windows(2))
        .map(|(model, measured)| (measured[1] - measured[0] - model[1] + model[0]).powi(2))
        .sum();
    if iq.is_finite() { iq } else { f64::INFINITY }
}
