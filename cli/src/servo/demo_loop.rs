//! The adaptive position loop on the simulated pneumatic axis: runs, summary and JSON.

use std::ops::RangeInclusive;
use std::path::Path;

use serde_json::{Value, json};
use trendid::servo::State;
use trendid_host_tests::servo::figures::Figures;
use trendid_host_tests::servo::rig::{Instant, Rig};
use trendid_host_tests::servo::run::{Options, run as run_scenario};
use trendid_host_tests::servo::scenario::Scenario;

use crate::format::{significant, table};
use crate::output::{Refusal, emit, emit_json, number, progress, under};
use crate::servo::figure::{self, Course, Row};

/// Arguments of the run.
pub(super) struct Task<'a> {
    pub scenario: Scenario,
    pub fixed: bool,
    pub seeds: RangeInclusive<u64>,
    pub out: &'a Path,
    pub json: bool,
}

/// One figure of a run.
pub(crate) struct Column {
    /// Key in JSON.
    key: &'static str,
    /// Head in the table of one scenario.
    head: &'static str,
    /// Head in the table of all scenarios.
    pub short: &'static str,
    pub of: fn(&Figures) -> Option<f64>,
}

const fn column(
    key: &'static str,
    head: &'static str,
    short: &'static str,
    of: fn(&Figures) -> Option<f64>,
) -> Column {
    Column {
        key,
        head,
        short,
        of,
    }
}

/// The figures of a run, the range at rest last.
#[rustfmt::skip]
pub(crate) const COLUMNS: [Column; 8] = [
    column("verified_at_s", "model verified after [s]", "verified [s]", |f| f.verified_at_s),
    column("steady_state_mm", "60 mm step: steady state [mm]", "steady state [mm]", |f| f.steady_state_mm),
    column("rise_ms", "60 mm step: rise [ms]", "rise [ms]", |f| f.rise_ms),
    column("overshoot_pct", "60 mm step: overshoot [%]", "overshoot [%]", |f| f.overshoot_pct),
    column("tracking_0p5hz_mm", "sine of 60 mm, 0.5 Hz: largest error [mm]", "0.5 Hz [mm]", |f| f.tracking_0p5hz_mm),
    column("tracking_1hz_mm", "sine of 60 mm, 1 Hz: largest error [mm]", "1 Hz [mm]", |f| f.tracking_1hz_mm),
    column("recovered_s", "error below 1.05 mm again after [s]", "back after [s]", |f| f.recovered_s),
    column("rest_range_mm", "60 s at rest: range of the position [mm]", "range at rest [mm]", |f| f.rest_range_mm),
];

/// Runs all seeds, draws the first and prints.
///
/// # Errors
///
/// One sentence on a picture that cannot be written.
pub(super) fn run(task: &Task) -> Result<(), Refusal> {
    let first = *task.seeds.start();
    let bar = progress(task.seeds.end() - first + 1, "runs");
    let mut course = Course::default();
    let mut runs = vec![figures(task, first, &mut |instant, rig| {
        note(&mut course, instant, rig);
    })];
    bar.inc(1);
    let others: Vec<u64> = task.seeds.clone().skip(1).collect();
    runs.extend(under(&bar, &others, |seed| {
        figures(task, *seed, &mut |_, _| {})
    }));
    bar.finish_and_clear();
    let fixed = if task.fixed { "-fixed" } else { "" };
    let name = format!("loop-{}{fixed}", task.scenario.name());
    let title = format!(
        "Pneumatic axis, {}: {}; {} (seed {first})",
        task.scenario.name(),
        task.scenario.description(),
        if task.fixed {
            "fixed gains"
        } else {
            "adaptive"
        },
    );
    let picture = figure::save(&course, title, task.out, &name)?;
    if task.json {
        let mut values: Vec<Value> = runs.iter().map(|f| json_of(f, task.fixed)).collect();
        values[0]["pictures"] = json!([picture.display().to_string()]);
        for value in &values {
            emit_json(value)?;
        }
        return Ok(());
    }
    emit(&text(task, &course, &runs))?;
    emit(&format!("\nPicture: {}\n", picture.display()))?;
    Ok(())
}

fn figures(task: &Task, seed: u64, watcher: &mut dyn FnMut(&Instant, &Rig)) -> Figures {
    let options = Options {
        fixed: task.fixed,
        ..Options::adaptive(seed)
    };
    run_scenario(task.scenario, &options, watcher)
}

/// Samples between two notes of the parameters.
const SPARSE: usize = 25;

fn note(course: &mut Course, instant: &Instant, rig: &Rig) {
    let report = &instant.report;
    course.rows.push(Row {
        t: instant.t,
        position: instant.position_mm,
        reference: f64::from(report.setpoint.position),
        command: f64::from(report.command),
        controlling: report.state.is_controlling(),
    });
    if course.states.last().map(|s| s.1) != Some(report.state) {
        course.states.push((instant.t, report.state));
    }
    if report.retuned {
        course.retuned.push(instant.t);
    }
    if course.rows.len().is_multiple_of(SPARSE) {
        let identifier = rig.servo.identifier();
        let estimate = identifier.estimate();
        let reading = estimate.physical();
        let values = [reading.gain, reading.omega0, reading.damping];
        // What is not known yet leaves a gap in the picture.
        let sigma = estimate.physical_std();
        course.parameters.push((
            instant.t,
            [0, 1, 2].map(|j| {
                let wide = |v: Option<f32>| v.map_or(f64::NAN, f64::from);
                (wide(values[j]), wide(sigma.map(|s| s[j])))
            }),
        ));
        let used = rig.servo.supervisor().verified_model().map(|m| {
            let (a1, a2, b0) = (f64::from(m.a1), f64::from(m.a2), f64::from(m.b0));
            [b0 / a1, a1.sqrt(), 0.5 * a2 / a1.sqrt()]
        });
        course.used.push((instant.t, used.unwrap_or([f64::NAN; 3])));
    }
}

/// A run as JSON.
pub(super) fn json_of(f: &Figures, fixed: bool) -> Value {
    let mut value = json!({
        "scenario": f.scenario.name(),
        "seed": f.seed,
        "fixed": fixed,
        "gains_kept": f.gains_kept,
        "accepted": f.accepted,
        "state": f.state.to_string(),
        "refused_rightly": f.scenario.expected().map(|_| f.refused_rightly()),
    });
    for column in &COLUMNS {
        value[column.key] = (column.of)(f).map_or(Value::Null, number);
    }
    value
}

/// A state without its reason.
fn name_of(state: State) -> String {
    let text = state.to_string();
    text.split(':').next().unwrap_or_default().to_owned()
}

/// How many changes of the state are listed.
const LISTED: usize = 12;

/// The table of one scenario: a row for each figure that a run has.
fn rows(task: &Task, runs: &[Figures]) -> Vec<Vec<String>> {
    let seeds = runs.len();
    let mut rows = vec![if seeds == 1 {
        vec![String::new(), format!("seed {}", task.seeds.start())]
    } else {
        ["", "least", "median", "most", "runs"]
            .map(str::to_owned)
            .to_vec()
    }];
    for column in &COLUMNS {
        let mut values: Vec<f64> = runs.iter().filter_map(column.of).collect();
        values.sort_by(f64::total_cmp);
        if let (Some(&least), Some(&most)) = (values.first(), values.last()) {
            let mut row = vec![column.head.to_owned(), significant(least, 3)];
            if seeds > 1 {
                row.push(significant(values[values.len() / 2], 3));
                row.push(significant(most, 3));
                row.push(format!("{} of {seeds}", values.len()));
            }
            rows.push(row);
        } else if column.key == "recovered_s" && task.scenario.is_change() {
            rows.push(vec![column.head.to_owned(), "never in 4 s".into()]);
        }
    }
    rows
}

fn text(task: &Task, course: &Course, runs: &[Figures]) -> String {
    let seeds = runs.len();
    let mut text = format!(
        "A simulated pneumatic axis at 1 kHz, {}: {}.\n\
         The no_std core in f32 knows its sign, its travel, that it is a cylinder and roughly 25 rad/s; gains {}.\n\n",
        task.scenario.name(),
        task.scenario.description(),
        if task.fixed {
            "fixed after commissioning"
        } else {
            "follow verified models"
        }
    );
    text += &format!("Seed {}, states:\n", task.seeds.start());
    for (t, state) in course.states.iter().take(LISTED) {
        text += &format!("  {t:7.3} s  {state}\n");
    }
    if course.states.len() > LISTED {
        text += &format!(
            "  ... {} more changes, at the end {}\n",
            course.states.len() - LISTED,
            name_of(runs[0].state)
        );
    }
    let mut rows = rows(task, runs);
    let accepted: u32 = runs.iter().map(|f| f.accepted).sum();
    rows.push(vec![
        "models that reached the controller".into(),
        accepted.to_string(),
    ]);
    text += &format!("\n{}", table(&rows));
    let kept = runs.iter().filter(|f| f.gains_kept == Some(true)).count();
    if runs.iter().any(|f| f.gains_kept.is_some()) {
        text += &format!("  gains bit for bit as before in {kept} of {seeds} runs\n");
    }
    if task.scenario.expected().is_some() {
        let right = runs.iter().filter(|f| f.refused_rightly()).count();
        text += &format!("  refused with the right reason in {right} of {seeds} runs\n");
    }
    text
}
