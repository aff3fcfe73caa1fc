//! `trendid drives`: the default over a population of servo drives and of what is told of them.

use clap::Args;
use serde_json::{Value, json};
use trendid_host_tests::paper::drives::Drawn;
use trendid_host_tests::paper::sigma::Score;
use trendid_host_tests::servo::population::summary::quantile;
use trendid_identify::side_by_side;

use crate::format::{significant, table};
use crate::output::{Refusal, emit, emit_json, number};
use crate::seeds::seeds;

/// Errors and standard deviations over servo drives drawn at random, and settings too
#[derive(Debug, Args)]
#[command(after_help = "Example:
  trendid drives --drives 2000

Velocity gain, frequency, damping, sampling, commands, noise, offset and length of the record are drawn, and so are the bandwidth that
is told (within a factor of 3), the ranges and the memory. `ls` is the default, `iv` are instruments beside it. Errors are those of C,
omega0 and xi; of normal errors 68.3 % are within 1 and 99.7 % within 3 standard deviations.")]
pub(crate) struct DrivesArgs {
    /// How many drives
    #[arg(long, value_name = "N", default_value_t = 1000)]
    drives: u64,
    /// Seed of the first drive
    #[arg(long, value_name = "N", default_value_t = 200_001)]
    first_seed: u64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// A part of the population.
struct Part {
    name: &'static str,
    holds: fn(&Drawn) -> bool,
}

const PARTS: [Part; 5] = [
    Part {
        name: "all",
        holds: |_| true,
    },
    Part {
        name: "noise below 5 %",
        holds: |drawn| drawn.noise_pct < 5.0,
    },
    Part {
        name: "noise of 5 to 42 %",
        holds: |drawn| drawn.noise_pct >= 5.0,
    },
    Part {
        name: "no memory",
        holds: |drawn| drawn.config.memory.is_none(),
    },
    Part {
        name: "memory of 2 or 10 s",
        holds: |drawn| drawn.config.memory.is_some(),
    },
];

/// One estimator over one part.
struct Row {
    part: &'static str,
    estimator: &'static str,
    drives: usize,
    median: [f64; 3],
    p90: [f64; 3],
    within: [[f64; 3]; 2],
}

/// Runs the population and prints the table.
///
/// # Errors
///
/// A number of drives or a seed that makes no sense.
pub(crate) fn run(args: &DrivesArgs) -> Result<(), Refusal> {
    let seeds = seeds("--drives", args.drives, args.first_seed)?;
    let found = side_by_side(&seeds, |seed| {
        let drawn = Drawn::of(*seed);
        let scores = drawn.scores(*seed);
        (drawn, scores)
    });
    let mut rows = Vec::new();
    for part in PARTS {
        let own: Vec<_> = found
            .iter()
            .filter(|(drawn, _)| (part.holds)(drawn))
            .collect();
        for (way, estimator) in ["ls", "iv"].into_iter().enumerate() {
            let scores: Vec<Score> = own.iter().map(|(_, scores)| scores[way]).collect();
            rows.push(row(part.name, estimator, &scores));
        }
    }
    match args.json {
        true => emit_json(&rows.iter().map(Row::json).collect())?,
        false => emit(&text(&rows, args))?,
    }
    Ok(())
}

fn row(part: &'static str, estimator: &'static str, scores: &[Score]) -> Row {
    let errors = |i: usize, share: f64| {
        let all: Vec<f64> = scores.iter().map(|s| s.error_pct[i].abs()).collect();
        quantile(&all, share)
    };
    let share = |limit: f64, i: usize| {
        let inside = scores.iter().filter(|s| s.z[i].abs() <= limit).count();
        100.0 * inside as f64 / scores.len() as f64
    };
    Row {
        part,
        estimator,
        drives: scores.len(),
        median: [0, 1, 2].map(|i| errors(i, 0.5)),
        p90: [0, 1, 2].map(|i| errors(i, 0.9)),
        within: [1.0, 3.0].map(|limit| [0, 1, 2].map(|i| share(limit, i))),
    }
}

impl Row {
    fn json(&self) -> Value {
        let list = |v: &[f64; 3]| v.map(number);
        json!({
            "part": self.part, "estimator": self.estimator, "drives": self.drives,
            "median_error_pct": list(&self.median), "p90_error_pct": list(&self.p90),
            "within_1_pct": list(&self.within[0]), "within_3_pct": list(&self.within[1]),
        })
    }
}

fn text(rows: &[Row], args: &DrivesArgs) -> String {
    let two = |v: &[f64; 3]| v.map(|v| significant(v, 2)).join("/");
    let tenth = |v: &[f64; 3]| v.map(|v| format!("{v:.1}")).join("/");
    let head = [
        "drives",
        "",
        "",
        "error, median [%]",
        "of 90 % [%]",
        "within 1 [%]",
        "within 3 [%]",
    ];
    let mut cells = vec![head.map(String::from).to_vec()];
    for row in rows {
        cells.push(vec![
            row.part.into(),
            row.drives.to_string(),
            row.estimator.into(),
            two(&row.median),
            two(&row.p90),
            tenth(&row.within[0]),
            tenth(&row.within[1]),
        ]);
    }
    format!(
        "C/omega0/xi of {} servo drives from seed {} on\n\n{}",
        args.drives,
        args.first_seed,
        table(&cells)
    )
}
