//! `trendid paper fig1`: the paper's Fig. 1 again, transients of the normalised coefficients.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;
use trendid::trends::{FilteredTrends, RawTrends, Scheme, TrendOperator};
use trendid::{Config, ConfigError, Identifier, Structure};
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, Reading};

use crate::identify::names::SchemeName;
use crate::output::{self, Refusal};
use crate::plot::{COLOURS, Curve, Figure, GREY, Panel};

/// Arguments of the command.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid paper fig1 --plot pictures
  trendid paper fig1 --csv --raw")]
pub(super) struct Fig1Args {
    /// Seed of the record
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub first_seed: u64,
    /// Length of the record [s]
    #[arg(long, value_name = "S", default_value_t = 0.4)]
    pub duration: f64,
    /// Trends of Goodwin (4) or modified Tustin (8)
    #[arg(long, value_enum, default_value = "tustin")]
    pub scheme: SchemeName,
    /// Raw trends, as in the paper, instead of filtered ones
    #[arg(long)]
    pub raw: bool,
    /// Directory of fig1.svg
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub plot: PathBuf,
    /// The transients as CSV, no picture
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// The transients as JSON, no picture
    #[arg(long)]
    pub json: bool,
}

/// The estimate at one sample: a1, a2, b0 over their true values, and the standard deviations in
/// the same unit.
struct Point {
    t: f64,
    ratio: [f64; 3],
    sigma: [f64; 3],
}

const TRUTH: [f64; 3] = [400.0, 20.0, 1e6];
const NAMES: [&str; 3] = ["a1 / 400", "a2 / 20", "b0 / 1e6"];
/// Band of the settling time.
const BAND: f64 = 0.05;

/// Runs the core over one record and draws it.
pub(super) fn run(args: &Fig1Args) -> Result<(), Refusal> {
    if !(0.02..=60.0).contains(&args.duration) {
        return Err(Refusal::new(format!(
            "--duration is {} s, not between 0.02 and 60",
            args.duration
        )));
    }
    let condition = Condition {
        w_um: 200.0,
        eta_um: 20.0,
        eps_um: 10.0,
        dt_ms: 1.0,
        ns_pct: 0.0,
        reading: Reading::Absolute,
    };
    let record = Experiment::reference(condition, args.duration).record(args.first_seed);
    let (dt, scheme) = (record.dt as f32, Scheme::from(args.scheme));
    let points = if args.raw {
        let structure = Structure::<3, 3, 1>::INTEGRATING;
        transient(&record, RawTrends::try_new(scheme, dt)?, structure)?
    } else {
        let trends = FilteredTrends::for_bandwidth(scheme, dt, 20.0)?;
        transient(&record, trends, Structure::<3, 5, 1>::SERVO)?
    };
    let settled = settled_ms(&points);
    if args.csv {
        let mut text = String::from("t,a1,a2,b0,sigma_a1,sigma_a2,sigma_b0\n");
        for p in &points {
            let cells: Vec<String> = p
                .ratio
                .iter()
                .chain(&p.sigma)
                .map(|v| format!("{v:.6}"))
                .collect();
            text += &format!("{:.3},{}\n", p.t, cells.join(","));
        }
        output::emit(&text)?;
        return Ok(());
    }
    if args.json {
        let curves: Vec<_> = points
            .iter()
            .map(|p| json!({"t": p.t, "ratio": p.ratio.map(output::number).to_vec(), "sigma": p.sigma.map(output::number).to_vec()}))
            .collect();
        output::emit_json(&json!({
            "seed": args.first_seed, "order": ["a1", "a2", "b0"], "settled_ms": settled, "points": curves,
        }))?;
        return Ok(());
    }
    let path = figure(args, &points).save(&args.plot, "fig1")?;
    output::emit(&format!("wrote {}\n", path.display()))?;
    output::emit(&match settled {
        Some(ms) => format!("all three within 5 % of the truth from {ms:.0} ms on\n"),
        None => "not within 5 % of the truth at the end\n".to_owned(),
    })?;
    Ok(())
}

fn transient<T: TrendOperator<3>, const N: usize>(
    record: &Record,
    trends: T,
    structure: Structure<3, N, 1>,
) -> Result<Vec<Point>, ConfigError> {
    let config = Config::new(structure, 20.0, [0.4], 50.0);
    let mut identifier: Identifier<T, 3, N> = Identifier::try_new(&config, trends)?;
    Ok(record
        .samples()
        .map(|s| {
            let _ = identifier.update(s.u as f32, s.y as f32);
            let estimate = identifier.estimate();
            let (theta, std) = (estimate.theta(), estimate.std());
            Point {
                t: s.t,
                ratio: [0, 1, 2].map(|i| f64::from(theta[i]) / TRUTH[i]),
                sigma: [0, 1, 2].map(|i| f64::from(std[i]) / TRUTH[i]),
            }
        })
        .collect())
}

/// First time after which all three stay within 5 % \[ms\].
fn settled_ms(points: &[Point]) -> Option<f64> {
    let outside = points
        .iter()
        .rposition(|p| !p.ratio.iter().all(|r| (r - 1.0).abs() <= BAND));
    let first = outside.map_or(0, |k| k + 1);
    points.get(first).map(|p| 1e3 * p.t)
}

fn figure(args: &Fig1Args, points: &[Point]) -> Figure {
    let mut curves: Vec<Curve> = NAMES
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let line = points.iter().map(|p| (p.t, p.ratio[i])).collect();
            let mut curve = Curve::new(*name, COLOURS[i], line);
            let band = |p: &Point| (p.ratio[i] - p.sigma[i], p.ratio[i] + p.sigma[i]);
            curve.band = Some(points.iter().map(band).collect());
            curve
        })
        .collect();
    let truth = points.iter().map(|p| (p.t, 1.0)).collect();
    curves.push(Curve::new("truth", GREY, truth));
    let kind = if args.raw { "raw" } else { "filtered" };
    Figure {
        title: "Transients of the normalised coefficients".to_owned(),
        panels: vec![Panel {
            title: format!(
                "w = 200 um, eta = 20 um, eps = 10 um, 1 ms; {} trends, {:?}; band: one reported standard deviation",
                kind,
                Scheme::from(args.scheme)
            ),
            x: "t [s]".to_owned(),
            y: "estimate / truth".to_owned(),
            curves,
            range: Some(-0.2..2.0),
        }],
    }
}
