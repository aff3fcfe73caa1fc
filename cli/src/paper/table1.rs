//! `trendid table1`: the paper's Table 1 again, with the core, the bound and two opponents on the same records.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde_json::{Value, json};
use trendid_host_tests::paper::statistics::{COLUMNS, Line, summary};
use trendid_host_tests::paper::trial::{Filter, Method, Setting, Trial, trial};
use trendid_host_tests::signals::noise::Reading;

use crate::output::{self, Refusal};
use crate::paper::{table1_picture as picture, table1_text as text};

/// What is asked of the command.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid table1 --seeds 10
  trendid table1 --csv > table1.csv
  trendid table1 --reading relative --vary white --seeds 1000 --check")]
pub struct Table1Args {
    /// Records per condition
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub seeds: u64,
    /// Seed of the first record
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub first_seed: u64,
    /// Length of each record [s]; default 0.5 in ABSOLUTE, 3 in RELATIVE
    #[arg(long, value_name = "S")]
    pub duration: Option<f64>,
    /// One reading of the noise only
    #[arg(long, value_enum)]
    pub reading: Option<ReadingName>,
    /// One block only; may be repeated
    #[arg(long, value_enum, value_name = "BLOCK")]
    pub vary: Vec<Block>,
    /// One line per condition and method, for machines
    #[arg(long, conflicts_with_all = ["json", "markdown", "brief", "check"])]
    pub csv: bool,
    /// The same as JSON; what is infinite or absent is null
    #[arg(long, conflicts_with_all = ["markdown", "brief", "check"])]
    pub json: bool,
    /// The short table of the documentation
    #[arg(long, conflicts_with_all = ["brief", "check"])]
    pub markdown: bool,
    /// Paper, bound, opponents and the default only, one row per condition
    #[arg(long, conflicts_with = "check")]
    pub brief: bool,
    /// Only the comparison with the limits that the project sets itself
    #[arg(long)]
    pub check: bool,
    /// Writes the errors over the noise level as DIR/table1.svg and DIR/table1.png; needs the block `white`
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
}

/// The two readings of the printed widths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReadingName {
    Absolute,
    Relative,
}

/// The blocks of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Block {
    Drift,
    Noise,
    Resolution,
    Sampling,
    /// The noise block with the white noise alone
    White,
}

impl Block {
    const fn name(self) -> &'static str {
        match self {
            Self::Drift => "drift",
            Self::Noise => "noise",
            Self::Resolution => "resolution",
            Self::Sampling => "sampling",
            Self::White => "white",
        }
    }
}

/// Runs the trials and prints them.
pub fn run(args: &Table1Args) -> Result<(), Refusal> {
    if args.seeds == 0 {
        return Err(Refusal::new("--seeds must be at least 1"));
    }
    if let Some(duration) = args.duration
        && !(0.3..=60.0).contains(&duration)
    {
        return Err(Refusal::new(format!(
            "--duration is {duration} s, not between 0.3 and 60"
        )));
    }
    let settings = settings(args);
    if args.plot.is_some() && !settings.iter().any(|s| s.vary == "white") {
        return Err(Refusal::new("--plot needs the block white"));
    }
    let lines = lines(args, &settings);
    let mut text = if args.csv {
        let rows: Vec<String> = lines.iter().map(Line::csv).collect();
        format!("{COLUMNS}\n{}\n", rows.join("\n"))
    } else if args.json {
        format!("{}\n", as_json(args, &lines))
    } else if args.markdown {
        text::markdown(args, &lines)
    } else if args.brief {
        text::brief(args, &lines)
    } else if args.check {
        text::check(args, &lines)
    } else {
        text::plain(args, &lines)
    };
    if let Some(dir) = &args.plot {
        let files = picture::save(dir, args, &lines)?;
        // Between the lines of a table for machines there is no room for it.
        if !(args.csv || args.json || args.markdown || args.brief) {
            for path in files {
                text += &format!("wrote {}\n", path.display());
            }
        }
    }
    output::emit(&text);
    Ok(())
}

fn settings(args: &Table1Args) -> Vec<Setting> {
    [
        (ReadingName::Absolute, Reading::Absolute),
        (ReadingName::Relative, Reading::Relative),
    ]
    .into_iter()
    .filter(|(name, _)| args.reading.is_none_or(|wanted| wanted == *name))
    .flat_map(|(_, reading)| Setting::all(reading))
    .filter(|s| args.vary.is_empty() || args.vary.iter().any(|b| b.name() == s.vary))
    .collect()
}

fn lines(args: &Table1Args, settings: &[Setting]) -> Vec<Line> {
    let mut methods = Method::all();
    if args.brief {
        methods = vec![Method::OutputError, Method::Kalman, Method::DEFAULT];
    }
    if args.check {
        // What the comparison does not show needs not run.
        methods.retain(|m| match m {
            Method::Core { .. } => text::checked(*m),
            Method::Kalman => true,
            Method::OutputError => args.plot.is_some(),
        });
    }
    let bar = output::progress(args.seeds * settings.len() as u64, "records");
    let lines = settings
        .iter()
        .flat_map(|setting| {
            let duration = args.duration.unwrap_or_else(|| setting.usual_duration());
            let trials: Vec<Trial> = (args.first_seed..args.first_seed + args.seeds)
                .into_par_iter()
                .map(|seed| {
                    let done = trial(setting, duration, seed, &methods);
                    bar.inc(1);
                    done
                })
                .collect();
            summary(setting, duration, &methods, &trials)
        })
        .collect();
    bar.finish_and_clear();
    lines
}

fn as_json(args: &Table1Args, lines: &[Line]) -> Value {
    let numbers = |values: [f64; 3]| Value::from(values.map(output::number).to_vec());
    let optional = |value: Option<f64>| value.map_or(Value::Null, output::number);
    let rows: Vec<Value> = lines
        .iter()
        .map(|line| {
            let c = &line.setting.condition;
            json!({
                "vary": line.setting.vary, "w_um": c.w_um, "eta_um": c.eta_um, "eps_um": c.eps_um, "dt_ms": c.dt_ms,
                "reading": line.setting.reading(), "scheme": line.method.scheme(), "filter": line.method.filter(),
                "estimator": line.method.estimator(), "duration_s": line.duration_s, "seeds": line.seeds,
                "ns_pct": output::number(line.ns_pct), "rms_pct": numbers(line.rms_pct),
                "med_pct": numbers(line.median_pct), "bound_pct": numbers(line.bound_pct),
                "paper_pct": numbers(line.paper_pct()), "rms_of_bound": numbers(line.of_bound()),
                "rms_of_paper": numbers(line.of_paper()), "limit_pct": line.limit_pct().map(numbers),
                "conv": optional(line.conv), "paper_conv": line.paper().conv,
                "tss_med_ms": optional(line.settled_median_ms), "tss_p95_ms": optional(line.settled_p95_ms),
                "paper_tss_ms": line.paper().tss_ms, "diverged": line.diverged,
            })
        })
        .collect();
    let filters: serde_json::Map<String, Value> = Filter::ALL
        .iter()
        .map(|f| (f.name().to_owned(), f.legend().into()))
        .collect();
    json!({
        "first_seed": args.first_seed, "order": ["c", "omega0", "xi"], "definitions": text::DEFINITIONS,
        "filters": filters, "rows": rows,
    })
}
