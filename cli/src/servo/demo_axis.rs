//! `trendid demo --axis`: one axis of the population from power-up to rest.

use std::path::Path;

use serde_json::{Map, Value, json};
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::sequence::Motion;
use trendid_host_tests::servo::population::shown::{Shown, shown, states};
use trendid_host_tests::servo::population::summary::refusal;

use crate::format::{significant, table};
use crate::output::{Refusal, emit, emit_json, number};
use crate::servo::figure::{self, Course, Row};

/// Arguments of the run.
pub(super) struct Task<'a> {
    pub(super) family: Family,
    pub(super) usual: bool,
    pub(super) seed: u64,
    pub(super) fixed: bool,
    pub(super) out: &'a Path,
    pub(super) json: bool,
}

/// A figure: key, title, value.
type Figure = (&'static str, &'static str, Option<f64>);

/// Runs the axis, draws it and prints.
///
/// # Errors
///
/// One sentence on a picture that cannot be written.
pub(super) fn run(task: &Task) -> Result<(), Refusal> {
    let axis = AxisDraw::new(task.family, task.usual, task.seed);
    let shown = shown(&axis, !task.fixed);
    let title = format!(
        "{} axis of seed {}: {:.0} mm, {:.0} rad/s in the middle",
        task.family.name(),
        task.seed,
        axis.stroke_mm(),
        axis.truth(0.5 * axis.stroke_mm())[1]
    );
    let name = format!("axis-{}-{}", task.family.name(), task.seed);
    let picture = figure::save(&course(&axis, &shown), title.clone(), task.out, &name)?;
    if task.json {
        let mut top = Map::new();
        top.insert("seed".into(), json!(task.seed));
        top.insert("family".into(), json!(task.family.name()));
        for (key, _, value) in drawn(&axis).into_iter().chain(found(&shown)) {
            top.insert(key.into(), value.map_or(Value::Null, number));
        }
        top.insert("reversed".into(), json!(axis.reversed));
        top.insert("refused".into(), json!(refusal(&shown.run)));
        let stopped = shown.run.stopped.map(|reason| format!("{reason:?}"));
        top.insert("stopped".into(), json!(stopped));
        top.insert("pictures".into(), json!([picture.display().to_string()]));
        emit_json(&Value::Object(top))?;
        return Ok(());
    }
    emit(&format!("{title}.\n\n{}", text(&axis, &shown)))?;
    emit(&format!("\nPicture: {}\n", picture.display()))?;
    Ok(())
}

/// What the axis is.
fn drawn(axis: &AxisDraw) -> [Figure; 10] {
    let [gain, omega0, xi] = axis.truth(0.5 * axis.stroke_mm());
    let [dead_zone, offset] = axis.valve_null();
    [
        ("stroke_mm", "travel [mm]", Some(axis.stroke_mm())),
        ("c_mm_s", "velocity gain [mm/s]", Some(gain)),
        ("w0_rad_s", "natural frequency [rad/s]", Some(omega0)),
        ("xi", "damping", Some(xi)),
        ("dead_zone", "dead zone [u]", Some(dead_zone)),
        ("offset", "offset [u]", Some(offset)),
        (
            "delay_ms",
            "dead time and lag of the valve [ms]",
            Some(1e3 * axis.delay()),
        ),
        (
            "sample_time_ms",
            "sample time [ms]",
            Some(1e3 * axis.sample_time),
        ),
        ("resolution_mm", "resolution [mm]", Some(axis.resolution_mm)),
        ("noise_mm", "noise, half width [mm]", Some(axis.noise_mm)),
    ]
}

/// What the loop made of it.
fn found(shown: &Shown) -> Vec<Figure> {
    let run = &shown.run;
    let done = &run.commissioned;
    let ratio = |place: usize| done.ratios.map(|ratios| ratios[place]);
    let mut figures = vec![
        ("verified_s", "model verified after [s]", done.verified_s),
        (
            "c_ratio",
            "velocity gain found over that of the axis",
            ratio(0),
        ),
        (
            "w0_ratio",
            "natural frequency found over that of the axis",
            ratio(1),
        ),
        (
            "end_stop_mm_s",
            "hardest blow to an end [mm/s]",
            Some(run.blow_mm_s),
        ),
    ];
    figures.extend(moved(run.motion.as_ref()));
    figures
}

/// How it moved.
fn moved(motion: Option<&Motion>) -> [Figure; 9] {
    let of = |figure: fn(&Motion) -> Option<f64>| motion.and_then(figure);
    [
        (
            "steady_state_mm",
            "steps of 10 to 90 %: steady state [mm]",
            of(|m| m.steady_state_mm),
        ),
        (
            "small_step_mm",
            "step of 0.05 mm: excursion [mm]",
            of(|m| m.excursion_mm),
        ),
        (
            "sine_0p5hz_mm",
            "large sine, 0.5 Hz: largest error [mm]",
            of(|m| m.large_sines_mm[0]),
        ),
        (
            "sine_1hz_mm",
            "large sine, 1 Hz: largest error [mm]",
            of(|m| m.large_sines_mm[1]),
        ),
        (
            "sine_2hz_mm",
            "large sine, 2 Hz: largest error [mm]",
            of(|m| m.large_sines_mm[2]),
        ),
        (
            "small_sine_0p5hz_mm",
            "small sine, 0.5 Hz: largest error [mm]",
            of(|m| m.small_sines_mm[0]),
        ),
        (
            "small_sine_1hz_mm",
            "small sine, 1 Hz: largest error [mm]",
            of(|m| m.small_sines_mm[1]),
        ),
        (
            "small_sine_2hz_mm",
            "small sine, 2 Hz: largest error [mm]",
            of(|m| m.small_sines_mm[2]),
        ),
        (
            "rest_range_mm",
            "range at rest [mm]",
            of(|m| m.rest_range_mm),
        ),
    ]
}

/// How many changes of the state are listed.
const LISTED: usize = 12;

/// A table of figures with their titles.
fn figures(of: &str, figures: &[Figure]) -> String {
    let row = |(_, title, value): &Figure| {
        let value = value.map_or_else(|| "none".into(), |v| significant(v, 3));
        vec![(*title).to_owned(), value]
    };
    let mut rows = vec![vec![String::new(), of.to_owned()]];
    rows.extend(figures.iter().map(row));
    table(&rows)
}

fn text(axis: &AxisDraw, shown: &Shown) -> String {
    let mut text = figures("axis", &drawn(axis));
    let states = states(&shown.samples);
    text += "\nStates:\n";
    for (k, state) in states.iter().take(LISTED) {
        text += &format!("  {:7.3} s  {}\n", *k as f64 * axis.sample_time, state);
    }
    if states.len() > LISTED {
        text += &format!("  ... {} more changes\n", states.len() - LISTED);
    }
    text += &format!("\n{}", figures("loop", &found(shown)));
    if let Some(reason) = refusal(&shown.run) {
        text += &format!("  not accepted: {reason}\n");
    }
    if let Some(reason) = shown.run.stopped {
        text += &format!("  stopped in control: {reason}\n");
    }
    text
}

/// The signals for the picture; a missed slot is no sample.
fn course(axis: &AxisDraw, shown: &Shown) -> Course {
    let mut course = Course::default();
    for (k, seen) in shown.samples.iter().enumerate() {
        let t = k as f64 * axis.sample_time;
        course.rows.push(Row {
            t,
            position: seen.position_mm,
            reference: seen.reference_mm,
            command: f64::from(seen.report.command),
            controlling: seen.report.state.is_controlling(),
        });
        if seen.report.retuned {
            course.retuned.push(t);
        }
        course.used.push((t, seen.used.unwrap_or([f64::NAN; 3])));
    }
    for (k, state) in states(&shown.samples) {
        course.states.push((k as f64 * axis.sample_time, state));
    }
    course
}
