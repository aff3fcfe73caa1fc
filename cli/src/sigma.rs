//! `trendid sigma`: how often the truth lies within the standard deviations, by each way to them.

use clap::Args;
use serde_json::{Value, json};
use trendid_host_tests::paper::sigma::{Noise, Score, Scores, scores};
use trendid_identify::side_by_side;

use crate::format::{significant, table};
use crate::output::{Refusal, emit, emit_json, number, progress};
use crate::seeds::seeds;

/// Coverage of the standard deviations over noises and lengths of a record
#[derive(Debug, Args)]
#[command(after_help = "Example:
  trendid sigma --seeds 300 --seconds 3,10

The servo of the paper, default settings; C, omega0 and xi in each cell. `ls` is the recursion with its noise bias taken
out, its standard deviation from a model of the noise; `lb` is the same estimate with standard deviations from 8 to 16 blocks of
the record; `iv` are instruments, theirs from blocks too. Of normal errors 68.3 % are within 1 and 99.7 % within 3 standard deviations.")]
pub(crate) struct SigmaArgs {
    /// Records in each cell
    #[arg(long, value_name = "N", default_value_t = 100)]
    seeds: u64,
    /// Seed of the first record
    #[arg(long, value_name = "N", default_value_t = 200_001)]
    first_seed: u64,
    /// Lengths of the records in s
    #[arg(
        long,
        value_name = "S,..",
        value_delimiter = ',',
        default_value = "0.5,1,3,10,60"
    )]
    seconds: Vec<f64>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// One estimator in one cell.
struct Cell {
    noise: Noise,
    seconds: f64,
    estimator: &'static str,
    /// Records in which blocks or instruments were used \[%\].
    used: f64,
    within: [[f64; 3]; 2],
    mean: [f64; 3],
    /// Root mean square error over the bound for white noise.
    over_bound: [f64; 3],
    diverged: usize,
}

/// Runs every cell and prints the table.
///
/// # Errors
///
/// A number of records, a seed or a length that makes no sense.
pub(crate) fn run(args: &SigmaArgs) -> Result<(), Refusal> {
    let seeds = seeds("--seeds", args.seeds, args.first_seed)?;
    if let Some(wrong) = args.seconds.iter().find(|s| !(**s >= 0.1 && **s <= 1e4)) {
        return Err(Refusal::new(format!(
            "--seconds has {wrong}: from 0.1 to 10000 can be run"
        )));
    }
    let cells: Vec<(Noise, f64)> = Noise::ALL
        .into_iter()
        .flat_map(|noise| args.seconds.iter().map(move |s| (noise, *s)))
        .collect();
    let bar = progress(cells.len() as u64, "sigma");
    let mut rows = Vec::new();
    for (noise, seconds) in cells {
        let found = side_by_side(&seeds, |seed| scores(noise, seconds, *seed));
        bar.inc(1);
        for (estimator, of) in [
            (
                "ls",
                (|s| (&s.least_squares, true)) as fn(&Scores) -> (&Score, bool),
            ),
            ("lb", |s| (&s.batches, s.by_blocks)),
            ("iv", |s| (&s.instruments, s.used)),
        ] {
            rows.push(cell(noise, seconds, estimator, &found, of));
        }
    }
    bar.finish_and_clear();
    match args.json {
        true => emit_json(&rows.iter().map(Cell::json).collect())?,
        false => emit(&text(&rows, args))?,
    }
    Ok(())
}

fn cell(
    noise: Noise,
    seconds: f64,
    estimator: &'static str,
    found: &[Scores],
    scored: fn(&Scores) -> (&Score, bool),
) -> Cell {
    let n = found.len() as f64;
    let of = |s: &Scores| *scored(s).0;
    let share = |limit: f64, i: usize| {
        let inside = found.iter().filter(|s| of(s).z[i].abs() <= limit).count();
        100.0 * inside as f64 / n
    };
    let mean = |f: &dyn Fn(&Scores) -> f64| found.iter().map(f).sum::<f64>() / n;
    Cell {
        noise,
        seconds,
        estimator,
        used: mean(&|s| f64::from(u8::from(scored(s).1)) * 100.0),
        within: [1.0, 3.0].map(|limit| [0, 1, 2].map(|i| share(limit, i))),
        mean: [0, 1, 2].map(|i| mean(&|s| of(s).error_pct[i])),
        over_bound: [0, 1, 2].map(|i| {
            let square = mean(&|s| of(s).error_pct[i].powi(2));
            let bound = mean(&|s| s.bound_pct[i].powi(2));
            (square / bound).sqrt()
        }),
        diverged: found
            .iter()
            .filter(|s| !of(s).error_pct.iter().all(|e| e.abs() <= 100.0))
            .count(),
    }
}

impl Cell {
    fn json(&self) -> Value {
        let list = |v: &[f64; 3]| v.map(number);
        json!({
            "noise": self.noise.name(), "seconds": self.seconds, "estimator": self.estimator,
            "used_pct": number(self.used),
            "within_1_pct": list(&self.within[0]), "within_3_pct": list(&self.within[1]),
            "mean_error_pct": list(&self.mean), "rms_over_bound": list(&self.over_bound),
            "diverged": self.diverged,
        })
    }
}

fn text(rows: &[Cell], args: &SigmaArgs) -> String {
    let three = |v: &[f64; 3], digits: usize| {
        let each = v.map(|v| significant(v, digits));
        each.join("/")
    };
    let whole = |v: &[f64; 3]| v.map(|v| format!("{v:.0}")).join("/");
    let mut cells = vec![
        [
            "noise",
            "s",
            "",
            "used [%]",
            "within 1 [%]",
            "within 3 [%]",
            "mean error [%]",
            "rms/bound",
            ">100 %",
        ]
        .map(String::from)
        .to_vec(),
    ];
    for row in rows {
        cells.push(vec![
            row.noise.name().into(),
            row.seconds.to_string(),
            row.estimator.into(),
            match row.estimator {
                "ls" => "-".into(),
                _ => format!("{:.0}", row.used),
            },
            whole(&row.within[0]),
            whole(&row.within[1]),
            three(&row.mean, 2),
            three(&row.over_bound, 3),
            row.diverged.to_string(),
        ]);
    }
    format!(
        "C/omega0/xi, {} records from seed {} in each cell\n\n{}\n{}",
        args.seeds,
        args.first_seed,
        table(&cells),
        ["ls", "lb", "iv"].map(|of| right(rows, of)).join("\n")
    )
}

/// How many of the numbers of an estimator are what they should be.
fn right(rows: &[Cell], of: &str) -> String {
    let own = || rows.iter().filter(|row| row.estimator == of);
    let count = |limit: usize, good: fn(f64) -> bool| {
        own()
            .flat_map(|row| row.within[limit])
            .filter(|share| good(*share))
            .count()
    };
    format!(
        "{of}: within 1 in 64 to 76 % of the records: {} of {} numbers, within 3 in 99 % or more: {}",
        count(0, |share| (64.0..=76.0).contains(&share)),
        3 * own().count(),
        count(1, |share| share >= 99.0),
    )
}
