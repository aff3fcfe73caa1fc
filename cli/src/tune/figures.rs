//! The pictures of `trendid tune`.

use std::path::{Path, PathBuf};

use trendid_identify::tune::Tuned;

use crate::plot::{COLOURS, Curve, Figure, Panel};
use crate::tune::report::span;

/// Samples of a step that are shown, about.
const SAMPLES: f64 = 4000.0;

/// Points of a curve over the frequency, and decades around the bandwidth.
const POINTS: usize = 400;
const DECADES: f64 = 2.0;

/// Writes the steps and the open loops into a directory.
///
/// # Errors
///
/// A sentence naming the file that cannot be written.
pub(super) fn save(dir: &Path, tuned: &Tuned) -> Result<[PathBuf; 2], String> {
    Ok([
        step(tuned).save(dir, "step")?,
        bode(tuned).save(dir, "bode")?,
    ])
}

fn panel(title: &str, x: &str, y: &str, curves: Vec<Curve>) -> Panel {
    Panel {
        title: title.into(),
        x: x.into(),
        y: y.into(),
        curves,
        range: None,
    }
}

/// Output and command of every loop after a step of the reference.
fn step(tuned: &Tuned) -> Figure {
    let mut outputs = Vec::new();
    let mut commands = Vec::new();
    let spans = tuned.loops.iter().map(|found| span(found, &tuned.plant));
    let longest = spans.fold(0.0, f64::max);
    let every = (longest / tuned.plant.sample_time() / SAMPLES)
        .ceil()
        .max(1.0) as usize;
    for (found, colour) in tuned.loops.iter().zip(COLOURS) {
        let (mut course, mut k) = (Vec::new(), 0);
        found.step_while(&tuned.plant, |sample| {
            if k % every == 0 {
                course.push(sample);
            }
            k += 1;
            sample.time < longest
        });
        let name = found.gains.name();
        let of = |value: fn(&trendid_identify::tune::Sample) -> f64| {
            course.iter().map(|s| (s.time, value(s))).collect()
        };
        outputs.push(Curve::new(name, colour, of(|s| s.output)));
        commands.push(Curve::new(name, colour, of(|s| s.command)));
    }
    Figure {
        title: "Step of the reference by 1".into(),
        panels: vec![
            panel("output", "t [s]", "y", outputs),
            panel("command", "t [s]", "u", commands),
        ],
    }
}

/// Gain and phase of every open loop.
fn bode(tuned: &Tuned) -> Figure {
    let mut gains = Vec::new();
    let mut phases = Vec::new();
    for (found, colour) in tuned.loops.iter().zip(COLOURS) {
        let at = |k: usize| {
            let decades = DECADES * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0);
            (found.bandwidth * 10f64.powf(decades)).log10()
        };
        let (mut gain, mut phase) = (Vec::new(), Vec::new());
        let open = found.open(&tuned.plant);
        let mut before: Option<f64> = None;
        for k in 0..POINTS {
            let x = at(k);
            let open = open(10f64.powf(x));
            gain.push((x, 20.0 * open.norm().log10()));
            // Without jumps by a whole turn.
            let mut degrees = open.arg().to_degrees();
            if let Some(before) = before {
                degrees -= 360.0 * ((degrees - before) / 360.0).round();
            }
            before = Some(degrees);
            phase.push((x, degrees));
        }
        let name = found.gains.name();
        gains.push(Curve::new(name, colour, gain));
        phases.push(Curve::new(name, colour, phase));
    }
    let x = "log10 of omega [rad/s]";
    Figure {
        title: "Open loop, broken at the input of the plant".into(),
        panels: vec![
            panel("gain", x, "gain [dB]", gains),
            panel("phase", x, "phase [deg]", phases),
        ],
    }
}
