//! `trendid table2`: the paper's Table 2 again, structures of every size and what IQ says of them.

use clap::Args;
use rayon::prelude::*;
use trendid::{
    ConfigError, FilteredTrends, Hold, OutputEvaluation, RawTrends, Scheme, Terms, TransferFunction,
};
use trendid_host_tests::paper::statistics::quantile;
use trendid_host_tests::plants::linear::LinearPlant;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, Reading};
use trendid_identify::Estimate;
use trendid_identify::dynamic::{Filter, InputSetup, Setup};

use crate::output::{self, Refusal};
use crate::paper::table1::ReadingName;
use crate::paper::table2_text::{as_json, csv, plain};

/// What is asked of the command.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid table2
  trendid table2 --csv --seeds 10 --duration 1")]
pub struct Table2Args {
    /// Records per structure
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub seeds: u64,
    /// Seed of the first record; the record on which IQ is evaluated has the seed N + 500000
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub first_seed: u64,
    /// Length of each record [s]
    #[arg(long, value_name = "S", default_value_t = 3.0)]
    pub duration: f64,
    /// Reading of the noise
    #[arg(long, value_enum, default_value = "absolute")]
    pub reading: ReadingName,
    /// One line per structure and method, for machines
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// The same as JSON
    #[arg(long)]
    pub json: bool,
}

/// One structure of the table: m without the integrator, M parameters.
#[derive(Clone, Copy)]
pub struct Size {
    pub m: usize,
    pub numerators: usize,
    /// a3, a1, a0, b2, b1, b0 and IQ as printed, per scheme; what the structure lacks is NaN.
    pub goodwin: [f64; 7],
    pub tustin: [f64; 7],
}

const NO: f64 = f64::NAN;

/// Table 2 of the paper in the order of print.
const SIZES: [Size; 5] = [
    Size {
        m: 1,
        numerators: 1,
        goodwin: [NO, 1.0, -3.888, NO, NO, 0.125, 324.8],
        tustin: [NO, 1.0, -4.011, NO, NO, 0.116, 340.5],
    },
    Size {
        m: 2,
        numerators: 1,
        goodwin: [NO, 21.24, 400.6, NO, NO, 0.9937, 0.1042],
        tustin: [NO, 19.95, 400.4, NO, NO, 0.9941, 0.1033],
    },
    Size {
        m: 2,
        numerators: 2,
        goodwin: [NO, 20.29, 395.7, NO, 0.00051, 0.9861, 0.1033],
        tustin: [NO, 19.95, 400.1, NO, 0.000035, 0.9935, 0.1033],
    },
    Size {
        m: 3,
        numerators: 2,
        goodwin: [0.00133, 22.25, 392.9, NO, 0.00087, 0.9761, 0.0995],
        tustin: [0.00102, 19.61, 396.7, NO, 0.000072, 0.9821, 0.1045],
    },
    Size {
        m: 3,
        numerators: 3,
        goodwin: [0.00136, 20.92, 385.8, 0.65, 0.00171, 0.9639, 0.0995],
        tustin: [0.00105, 19.58, 396.2, 0.13, 0.00031, 0.9822, 0.1054],
    },
];

/// Medians of one structure, scheme and kind of trends.
pub struct Found {
    pub size: Size,
    pub scheme: Scheme,
    pub filtered: bool,
    /// As in [`Size`], then IQ by (10), then IQ of the simulated velocity.
    pub median: [f64; 8],
    /// Half the distance of the quartiles.
    pub spread: [f64; 8],
}

impl Found {
    pub fn paper(&self) -> [f64; 7] {
        match self.scheme {
            Scheme::Goodwin => self.size.goodwin,
            Scheme::Tustin => self.size.tustin,
        }
    }

    pub fn kind(&self) -> &'static str {
        if self.filtered { "filtered" } else { "raw" }
    }

    pub fn scheme(&self) -> &'static str {
        match self.scheme {
            Scheme::Goodwin => "goodwin",
            Scheme::Tustin => "tustin",
        }
    }
}

/// Identifies every structure and prints the table.
pub fn run(args: &Table2Args) -> Result<(), Refusal> {
    if args.seeds == 0 {
        return Err(Refusal::new("--seeds must be at least 1"));
    }
    if !(0.3..=60.0).contains(&args.duration) {
        return Err(Refusal::new(format!(
            "--duration is {} s, not between 0.3 and 60",
            args.duration
        )));
    }
    let found = all(args)?;
    if args.csv {
        output::emit(&csv(args, &found));
    } else if args.json {
        output::emit_json(&as_json(args, &found));
    } else {
        output::emit(&plain(args, &found));
    }
    Ok(())
}

fn all(args: &Table2Args) -> Result<Vec<Found>, Refusal> {
    let condition = Condition {
        w_um: 100.0,
        eta_um: 10.0,
        eps_um: 10.0,
        dt_ms: 1.0,
        ns_pct: 1.97,
        reading: match args.reading {
            ReadingName::Absolute => Reading::Absolute,
            ReadingName::Relative => Reading::Relative,
        },
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
    let values: Result<Vec<Vec<[f64; 8]>>, ConfigError> = (args.first_seed
        ..args.first_seed + args.seeds)
        .into_par_iter()
        .map(|seed| {
            let record = experiment.record(seed);
            let fresh = experiment.record(seed + 500_000);
            let each = kinds
                .iter()
                .map(|&(size, scheme, filtered)| one(size, scheme, filtered, &record, &fresh))
                .collect();
            bar.inc(1);
            each
        })
        .collect();
    let values = values?;
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
        2 => FilteredTrends::<2>::for_bandwidth(scheme, dt, 20.0)?
            .filter()
            .to_vec(),
        3 => FilteredTrends::<3>::for_bandwidth(scheme, dt, 20.0)?
            .filter()
            .to_vec(),
        _ => FilteredTrends::<4>::for_bandwidth(scheme, dt, 20.0)?
            .filter()
            .to_vec(),
    };
    let amplitude = record.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    Ok(Setup {
        order,
        output: Terms::between(1, order),
        inputs: vec![InputSetup {
            terms: Terms::up_to(size.numerators),
            hold: Hold::Zero,
            delay: 0,
            range: amplitude as f32,
            rest: 0.0,
        }],
        constant: false,
        start: filtered,
        sample_time: dt,
        scheme,
        filter: if filtered {
            Filter::Polynomial(polynomial)
        } else {
            Filter::None
        },
        bandwidth: 20.0,
        output_range: 50.0,
        output_noise: 0.05,
        memory: None,
        settling: 0.0,
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
        integrators: 1,
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
    Ok(f64::from(evaluation.quality().iq()))
}

/// IQ of the velocity of a free simulation from rest, in mm^2; infinite where the model cannot be simulated.
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
