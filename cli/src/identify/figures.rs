//! The pictures of `trendid identify`.

use std::path::{Path, PathBuf};

use trendid_identify::{Identification, Problem};

use crate::plot::{COLOURS, Curve, Figure, PALE, Panel};

/// Writes the free simulation and the course of the parameters into a directory.
///
/// # Errors
///
/// A sentence naming the file that cannot be written.
pub(super) fn save(
    dir: &Path,
    problem: &Problem,
    found: &Identification,
    start: f64,
) -> Result<[PathBuf; 2], String> {
    Ok([
        simulation(problem, found, start).save(dir, "simulation")?,
        parameters(problem, found, start).save(dir, "parameters")?,
    ])
}

/// Measured and simulated output of the second half, and their difference.
fn simulation(problem: &Problem, found: &Identification, start: f64) -> Figure {
    let half = problem.samples() / 2;
    let points = |y: &[f64]| -> Vec<(f64, f64)> {
        let time = |k: usize| start + (half + k) as f64 * problem.signals.dt;
        y.iter().enumerate().map(|(k, y)| (time(k), *y)).collect()
    };
    let panel = |title: String, y: &str, curves| Panel {
        title,
        x: "t [s]".into(),
        y: y.into(),
        curves,
        range: None,
    };
    let measured = &problem.signals.output[half..];
    // Broad and pale below the simulation, so that both are seen.
    let mut below = Curve::new("measured", PALE, points(measured));
    below.width = 4;
    let mut curves = vec![below];
    let mut fit = f64::NAN;
    let mut error = None;
    if let Some(run) = &found.free_run {
        fit = run.fit_x0;
        let difference: Vec<f64> = measured.iter().zip(&run.y).map(|(y, s)| y - s).collect();
        curves.push(thin("free simulation", COLOURS[0], points(&run.y)));
        let curve = thin("error", COLOURS[1], points(&difference));
        error = Some(panel(
            "measured minus simulated".into(),
            "error",
            vec![curve],
        ));
    }
    let title = format!("second half of the record, fit {fit:.2} %");
    let mut panels = vec![panel(title, "output", curves)];
    panels.extend(error);
    Figure {
        title: "Free simulation of the identified model".into(),
        panels,
    }
}

/// Every parameter over its final value.
fn parameters(problem: &Problem, found: &Identification, start: f64) -> Figure {
    let (rows, end) = (&found.trace.rows, &found.estimate.theta);
    // Three times what the parameters still move after the first fifth of the run.
    let moved = rows[rows.len() / 5..].iter().flat_map(|(_, theta, _)| {
        let relative = theta.iter().zip(end);
        relative.map(|(now, end)| (now / end - 1.0).abs())
    });
    let half = (3.0 * moved.fold(0.0, f64::max)).clamp(0.01, 1.0);
    let curve = |(j, name): (usize, String)| {
        let time = |k: usize| start + k as f64 * problem.signals.dt;
        let end = end[j];
        let points = rows.iter().map(|(k, theta, _)| (time(*k), theta[j] / end));
        let band = rows.iter().map(|(_, theta, sigma)| {
            let width = 2.0 * sigma[j] / end.abs();
            (theta[j] / end - width, theta[j] / end + width)
        });
        let mut curve = Curve::new(name, COLOURS[j % COLOURS.len()], points.collect());
        curve.band = Some(band.collect());
        curve
    };
    let names = problem.parameter_names().into_iter().enumerate();
    Figure {
        title: "Course of the parameters".into(),
        panels: vec![Panel {
            title: "each parameter over its final value, band +-2 sigma".into(),
            x: "t [s]".into(),
            y: "relative value".into(),
            curves: names.map(curve).collect(),
            range: Some(1.0 - half..1.0 + half),
        }],
    }
}

fn thin(name: &str, colour: plotters::style::RGBColor, points: Vec<(f64, f64)>) -> Curve {
    let mut curve = Curve::new(name, colour, points);
    curve.width = 1;
    curve
}
