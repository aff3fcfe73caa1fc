//! The one picture of Table 1: errors over the noise level, for paper, opponents, bound and core.

use std::path::{Path, PathBuf};

use trendid_host_tests::montecarlo::Method;
use trendid_host_tests::noise::Reading;
use trendid_host_tests::table_run::Line;

use crate::plot::{COLOURS, Curve, Figure, GREY, Panel};
use crate::table1::Table1Args;

/// Writes `DIR/table1.svg` and `DIR/table1.png` from the block white in RELATIVE, else in ABSOLUTE.
pub fn save(dir: &Path, args: &Table1Args, lines: &[Line]) -> Result<[PathBuf; 2], String> {
    let white = |reading| -> Vec<&Line> {
        lines
            .iter()
            .filter(|l| l.setting.vary == "white" && l.setting.condition.reading == reading)
            .collect()
    };
    let mut chosen = white(Reading::Relative);
    if chosen.is_empty() {
        chosen = white(Reading::Absolute);
    }
    let Some(first) = chosen.first() else {
        return Err("no line of the block white to draw".to_owned());
    };
    let series = |method: Method, i: usize, of: fn(&Line) -> [f64; 3]| -> Vec<(f64, f64)> {
        chosen
            .iter()
            .filter(|l| l.method == method)
            .map(|l| (l.ns_pct.log10(), of(l)[i].log10()))
            .collect()
    };
    let panels = ["velocity gain C", "natural frequency", "damping"]
        .iter()
        .enumerate()
        .map(|(i, what)| {
            let rms: fn(&Line) -> [f64; 3] = |l| l.rms_pct;
            let ours = Method::DEFAULT;
            Panel {
                title: format!("error of the {what}"),
                x: "log10 of noise to signal [%]".to_owned(),
                y: "log10 of the error [%]".to_owned(),
                curves: vec![
                    Curve::new(
                        "paper, Tustin (as printed)",
                        COLOURS[1],
                        series(ours, i, |l| l.paper_pct()),
                    ),
                    Curve::new(
                        "extended Kalman filter",
                        COLOURS[3],
                        series(Method::Kalman, i, rms),
                    ),
                    Curve::new("trendid, default", COLOURS[0], series(ours, i, rms)),
                    Curve::new(
                        "offline output-error fit",
                        COLOURS[2],
                        series(Method::OutputError, i, rms),
                    ),
                    Curve::new("Cramer-Rao bound", GREY, series(ours, i, |l| l.bound_pct)),
                ],
                range: None,
            }
        })
        .collect();
    let figure = Figure {
        title: format!(
            "White noise, {}, {} s, {} records per level, rms",
            first.setting.reading().to_uppercase(),
            first.duration_s,
            args.seeds
        ),
        panels,
    };
    figure.save(dir, "table1")
}
