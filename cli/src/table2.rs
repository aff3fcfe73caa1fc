//! `trendid table2`: the paper's Table 2 again, structures of every size and what IQ says of them.

use std::fmt::Write as _;

use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};
use trendid::{
    ConfigError, FilteredTrends, Hold, OutputEvaluation, RawTrends, Scheme, Terms, TransferFunction,
};
use trendid_dynamic::{Filter, InputSetup, Recursion, Setup};
use trendid_host_tests::experiment::{Experiment, Record};
use trendid_host_tests::noise::{Condition, Reading};
use trendid_host_tests::plant::LinearPlant;
use trendid_host_tests::table_run::quantile;

use crate::format::{significant, table};
use crate::output::{self, Refusal};
use crate::table1::ReadingName;

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

/// What the figures are.
const DEFINITIONS: &str = "\
G = (b2 s^2 + b1 s + b0) / (s (a3 s^3 + a2 s^2 + a1 s + a0)), all related to a2 = 1 (m = 1: a1 = 1), b in 1e6; medians
over the records +- half the distance of the quartiles. Truth: a1 = 20, a0 = 400, b0 = 1, all else 0.
w = 100 um, eta = 10 um, eps = 10 um, 1 ms; readings as under Table 1.
Parameters: of the recursion at the end of the record; raw: raw trends; filtered: FilteredTrends::for_bandwidth(20 rad/s)
with the start column. Every structure has the integrator, so the core's order is m + 1.
Both indices are sums (11) of squared errors of the velocity in (m/s)^2, with these parameters over a second record of the
same length.
IQ(10): y^(k) by (10) from raw trends of the same scheme, (y(k) - y^(k))/Delta. An (m+1)-th difference of the noise
enters it and grows with the order, so it cannot judge the order under this noise.
IQ: (y(k) - y(k-1))/Delta minus the same of a free simulation from rest. The noise alone gives 2 (eta^2 + eps^2)/12/Delta^2
per sample, 0.100 in 3 s: the size of the paper's IQ.
With m = 3 and b1 any common factor (s + c) of numerator and denominator fits as well: a3 is not determined.
";

/// One structure of the table: m without the integrator, M parameters.
#[derive(Clone, Copy)]
struct Size {
    m: usize,
    numerators: usize,
    /// a3, a1, a0, b2, b1, b0 and IQ as printed, per scheme; what the structure lacks is NaN.
    goodwin: [f64; 7],
    tustin: [f64; 7],
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

const NAMES: [&str; 6] = ["a3", "a1", "a0", "b2", "b1", "b0"];

/// Medians of one structure, scheme and kind of trends.
struct Found {
    size: Size,
    scheme: Scheme,
    filtered: bool,
    /// As in [`Size`], then IQ by (10), then IQ of the simulated velocity.
    median: [f64; 8],
    /// Half the distance of the quartiles.
    spread: [f64; 8],
}

impl Found {
    fn paper(&self) -> [f64; 7] {
        match self.scheme {
            Scheme::Goodwin => self.size.goodwin,
            Scheme::Tustin => self.size.tustin,
        }
    }

    fn kind(&self) -> &'static str {
        if self.filtered { "filtered" } else { "raw" }
    }

    fn scheme(&self) -> &'static str {
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
        pull: 0.0,
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
    let (a, b) = (core.a(), core.b(0));
    let mut values = [NO; 8];
    let a = |i: usize| a.get(i + 1).copied().map(f64::from);
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
        let b = b.get(power).copied().map_or(NO, f64::from);
        values[5 - power] = 1e-6 * b / scale;
    }
    // mm/s to m/s.
    let unit = 1e-3 / fresh.dt;
    values[6] = unit
        * unit
        * match size.m {
            1 => by_ten::<2>(core.as_ref(), scheme, fresh)?,
            2 => by_ten::<3>(core.as_ref(), scheme, fresh)?,
            _ => by_ten::<4>(core.as_ref(), scheme, fresh)?,
        };
    values[7] = unit * unit * simulated(core.as_ref(), fresh);
    Ok(values)
}

/// IQ by (10), in mm^2.
fn by_ten<const M: usize>(
    core: &dyn Recursion,
    scheme: Scheme,
    fresh: &Record,
) -> Result<f64, ConfigError> {
    let mut model = TransferFunction::<M, 1> {
        a: [0.0; M],
        b: [[0.0; M]],
        constant: 0.0,
        integrators: 1,
    };
    for (to, from) in model.a.iter_mut().zip(core.a()) {
        *to = from;
    }
    for (to, from) in model.b[0].iter_mut().zip(core.b(0)) {
        *to = from;
    }
    let trends = RawTrends::try_new(scheme, fresh.dt as f32)?;
    let mut evaluation = OutputEvaluation::<M, 1>::new(trends);
    for s in fresh.samples() {
        let _ = evaluation.update(&model, [s.u as f32], (s.y - fresh.y[0]) as f32);
    }
    Ok(f64::from(evaluation.quality().iq()))
}

/// IQ of the velocity of a free simulation from rest, in mm^2; infinite where the model cannot be simulated.
fn simulated(core: &dyn Recursion, fresh: &Record) -> f64 {
    let wide = |v: Vec<f32>| -> Vec<f64> { v.into_iter().map(f64::from).collect() };
    let Ok(mut plant) = LinearPlant::new(&wide(core.a()), &wide(core.b(0)), fresh.dt) else {
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

fn cell(value: f64) -> String {
    if value.is_nan() {
        "-".to_owned()
    } else {
        significant(value, 4)
    }
}

fn plain(args: &Table2Args, found: &[Found]) -> String {
    let mut text = format!(
        "{} records of {} s, seeds {}..{}\n",
        args.seeds,
        args.duration,
        args.first_seed,
        args.first_seed + args.seeds
    );
    let mut rows = vec![
        [
            "structure",
            "scheme",
            "",
            "a3",
            "a1",
            "a0",
            "b2",
            "b1",
            "b0",
            "IQ(10)",
            "IQ",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    for group in found.chunks(4) {
        let structure = format!(
            "m = {}, M = {}",
            group[0].size.m,
            group[0].size.m + group[0].size.numerators
        );
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            for (k, f) in group.iter().filter(|f| f.scheme == scheme).enumerate() {
                if k == 0 {
                    let mut paper =
                        vec![structure.clone(), f.scheme().to_owned(), "paper".to_owned()];
                    paper.extend(f.paper().map(cell));
                    rows.push(paper);
                }
                let mut row = vec![String::new(), f.scheme().to_owned(), f.kind().to_owned()];
                row.extend((0..8).map(|i| match f.median[i] {
                    // Given, not estimated.
                    one if f.size.m == 1 && i == 1 => cell(one),
                    none if none.is_nan() => cell(none),
                    value => format!("{} +- {}", cell(value), significant(f.spread[i], 2)),
                }));
                rows.push(row);
            }
        }
    }
    text += &table(&rows);
    let _ = write!(text, "\n{DEFINITIONS}");
    text
}

fn csv(args: &Table2Args, found: &[Found]) -> String {
    let mut text = String::from("m,M,scheme,filter,reading,duration_s,seeds");
    for name in NAMES {
        let _ = write!(text, ",{name},{name}_spread,paper_{name}");
    }
    text += ",iq10,iq10_spread,paper_iq,iq,iq_spread\n";
    let plain = |v: f64| {
        if v.is_nan() {
            String::new()
        } else {
            format!("{v:.6e}")
        }
    };
    for f in found {
        let _ = write!(
            text,
            "{},{},{},{},{},{},{}",
            f.size.m,
            f.size.m + f.size.numerators,
            f.scheme(),
            f.kind(),
            reading(args),
            args.duration,
            args.seeds
        );
        for i in 0..7 {
            for v in [f.median[i], f.spread[i], f.paper()[i]] {
                let _ = write!(text, ",{}", plain(v));
            }
        }
        let _ = writeln!(text, ",{},{}", plain(f.median[7]), plain(f.spread[7]));
    }
    text
}

fn reading(args: &Table2Args) -> &'static str {
    match args.reading {
        ReadingName::Absolute => "absolute",
        ReadingName::Relative => "relative",
    }
}

fn as_json(args: &Table2Args, found: &[Found]) -> Value {
    let rows: Vec<Value> = found
        .iter()
        .map(|f| {
            let named = |values: &[f64]| -> Value {
                NAMES
                    .iter()
                    .zip(values)
                    .map(|(name, v)| ((*name).to_owned(), output::number(*v)))
                    .collect::<serde_json::Map<_, _>>()
                    .into()
            };
            json!({
                "m": f.size.m, "M": f.size.m + f.size.numerators, "scheme": f.scheme(), "filter": f.kind(),
                "median": named(&f.median), "spread": named(&f.spread), "paper": named(&f.paper()),
                "iq10": output::number(f.median[6]), "iq": output::number(f.median[7]),
                "paper_iq": output::number(f.paper()[6]),
            })
        })
        .collect();
    json!({
        "first_seed": args.first_seed, "seeds": args.seeds, "duration_s": args.duration, "reading": reading(args),
        "definitions": DEFINITIONS, "rows": rows,
    })
}
