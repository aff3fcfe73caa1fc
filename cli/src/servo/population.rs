//! `trendid loop --population`: the position loop on axes drawn at random.

use clap::Args;
use clap::builder::PossibleValuesParser;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::summary::{ControllerFigures, Summary, refusal};
use trendid_host_tests::servo::population::trial::Trial;

use crate::format::significant;
use crate::output::{Refusal, emit, emit_json, number, progress};

/// Most axes of a run.
const AXES_MAX: u64 = 100_000;

fn family_names() -> PossibleValuesParser {
    PossibleValuesParser::new(Family::ALL.map(Family::name))
}

/// Options of `--population`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Population")]
pub struct PopulationArgs {
    /// So many axes drawn at random instead of one axis
    #[arg(long, value_name = "N")]
    pub population: Option<u64>,
    /// Family of the axes
    #[arg(long, value_name = "NAME", default_value = "pneumatic", requires = "population", value_parser = family_names())]
    family: String,
    /// Draw from the half of each range about an ordinary machine
    #[arg(long, requires = "population")]
    usual: bool,
    /// Name the seeds of the worst axes
    #[arg(long, requires = "population")]
    worst: bool,
}

/// Runs the axes and prints.
///
/// # Errors
///
/// A sentence on a number of axes that makes no sense.
pub fn run(args: &PopulationArgs, axes: u64, first: u64, json: bool) -> Result<(), Refusal> {
    if !(1..=AXES_MAX).contains(&axes) {
        return Err(Refusal::new(format!(
            "--population {axes} is not between 1 and {AXES_MAX}"
        )));
    }
    let Some(end) = first.checked_add(axes) else {
        return Err(Refusal::new("--first-seed is too large for so many axes"));
    };
    let family = Family::from_name(&args.family).unwrap_or(Family::Pneumatic);
    let bar = progress(axes, "axes");
    let trials: Vec<Trial> = (first..end)
        .into_par_iter()
        .map(|seed| {
            let trial = Trial::run(family, args.usual, seed);
            bar.inc(1);
            trial
        })
        .collect();
    bar.finish_and_clear();
    let summary = Summary::new(&trials);
    let worst = if args.worst { worst(&trials) } else { vec![] };
    if json {
        emit_json(&object(&summary, &worst));
    } else {
        let kind = if args.usual { "usual " } else { "" };
        let name = family.name();
        let head = format!("{axes} {kind}{name} axes, seeds {first} to {}.\n", end - 1);
        emit(&(head + &markdown(&summary) + &sentences(&worst)));
    }
    Ok(())
}

/// The controllers side by side: name in JSON (none for the top level), title, figures.
type Column<'a> = (Option<&'static str>, &'static str, &'a ControllerFigures);

fn columns(summary: &Summary) -> [Column<'_>; 4] {
    [
        (None, "loop", &summary.adaptive),
        (Some("fixed_gains"), "fixed gains", &summary.fixed),
        (Some("baseline"), "searched gains", &summary.practitioner),
        (
            Some("baseline_same_axes"),
            "searched, same axes",
            &summary.practitioner_same,
        ),
    ]
}

/// A figure of a controller: key, unit, title, value.
type Row = (
    &'static str,
    &'static str,
    &'static str,
    fn(&ControllerFigures) -> f64,
);

const ROWS: [Row; 11] = [
    ("end_stop_pct", "%", "strikes an end stop", |c| {
        c.end_stops.struck_pct
    }),
    ("end_stop_max_mm_s", "mm/s", "hardest blow", |c| {
        c.end_stops.hardest_mm_s
    }),
    ("given_up_pct", "%", "gives up in control", |c| {
        c.motion.given_up_pct
    }),
    ("limit_cycle_pct", "%", "cycles at rest", |c| {
        c.motion.limit_cycle_pct
    }),
    ("undetected_cycle_pct", "%", "cycles unnoticed", |c| {
        c.motion.undetected_cycle_pct
    }),
    (
        "steady_state_median_mm",
        "mm",
        "steady state, median",
        |c| c.motion.steady_state_median_mm,
    ),
    ("steady_state_p90_mm", "mm", "steady state, 90 %", |c| {
        c.motion.steady_state_p90_mm
    }),
    (
        "small_step_median_mm",
        "mm",
        "excursion of a step of 0.05 mm, median",
        |c| c.motion.small_step_median_mm,
    ),
    (
        "wear_median",
        "u",
        "change of the command per sample, rms, median",
        |c| c.motion.wear_median,
    ),
    (
        "sine_no_worse_pct",
        "%",
        "large sines no worse than searched gains",
        |c| c.motion.sine_no_worse_pct,
    ),
    (
        "small_sine_no_worse_pct",
        "%",
        "small sines no worse than searched gains",
        |c| c.motion.small_sine_no_worse_pct,
    ),
];

/// A figure of the commissioning: key, unit, title, value.
fn commissioning(summary: &Summary) -> [(&'static str, &'static str, &'static str, f64); 9] {
    let c = &summary.commissioning;
    [
        ("accepted_pct", "%", "accepted within 3 s", c.accepted_pct),
        (
            "accepted_6s_pct",
            "%",
            "accepted within 6 s",
            c.accepted_6s_pct,
        ),
        (
            "slowed_pct",
            "%",
            "taken with a slower controller only",
            c.slowed_pct,
        ),
        (
            "verified_median_s",
            "s",
            "time to acceptance, median",
            c.verified_median_s,
        ),
        (
            "verified_p95_s",
            "s",
            "time to acceptance, 95 %",
            c.verified_p95_s,
        ),
        (
            "wrong_reason_pct",
            "%",
            "refused for a fault that is none",
            c.wrong_reason_pct,
        ),
        (
            "wrong_sign_pct",
            "%",
            "accepted with the wrong sign",
            c.wrong_sign_pct,
        ),
        (
            "w0_within_10pct",
            "% of accepted",
            "natural frequency within 10 %",
            c.w0_within_10pct,
        ),
        (
            "c_within_20pct",
            "% of accepted",
            "velocity gain within 20 %",
            c.c_within_20pct,
        ),
    ]
}

fn object(summary: &Summary, worst: &[(&'static str, Vec<(u64, f64)>)]) -> Value {
    let mut top = Map::new();
    top.insert("axes".into(), json!(summary.axes));
    for (key, _, _, value) in commissioning(summary) {
        top.insert(key.into(), number(value));
    }
    top.insert("refused".into(), json!(summary.commissioning.refused));
    for (name, _, figures) in columns(summary) {
        let mut own = Map::new();
        own.insert("controlled".into(), json!(figures.motion.controlled));
        for (key, _, _, value) in ROWS {
            own.insert(key.into(), number(value(figures)));
        }
        match name {
            None => top.append(&mut own),
            Some(name) => {
                top.insert(name.into(), Value::Object(own));
            }
        }
    }
    if !worst.is_empty() {
        let lists = worst.iter().map(|(name, list)| {
            let seeds: Vec<u64> = list.iter().map(|(seed, _)| *seed).collect();
            ((*name).to_owned(), json!(seeds))
        });
        top.insert("worst".into(), Value::Object(lists.collect()));
    }
    Value::Object(top)
}

/// Three digits; an axis that did not come to a figure counts as infinite.
fn text(value: f64) -> String {
    if value.is_nan() {
        String::new()
    } else if value.is_infinite() {
        "none".into()
    } else {
        significant(value, 3)
    }
}

fn markdown(summary: &Summary) -> String {
    let mut text_of = String::from("\n| commissioning | |\n|---|---|\n");
    for (_, unit, title, value) in commissioning(summary) {
        text_of += &format!("| {title} [{unit}] | {} |\n", text(value));
    }
    for (reason, axes) in &summary.commissioning.refused {
        text_of += &format!("| not accepted: {reason} [axes] | {axes} |\n");
    }
    text_of += "\n| motion |";
    for (_, title, _) in columns(summary) {
        text_of += &format!(" {title} |");
    }
    text_of += "\n|---|---|---|---|---|\n| axes controlled |";
    for (_, _, figures) in columns(summary) {
        text_of += &format!(" {} |", figures.motion.controlled);
    }
    text_of.push('\n');
    for (_, unit, title, value) in ROWS {
        text_of += &format!("| {title} [{unit}] |");
        for (_, _, figures) in columns(summary) {
            text_of += &format!(" {} |", text(value(figures)));
        }
        text_of.push('\n');
    }
    text_of
}

/// Seeds of the worst axes by figure, worst first, with the figure.
fn worst(trials: &[Trial]) -> Vec<(&'static str, Vec<(u64, f64)>)> {
    type Figure = fn(&Trial) -> Option<f64>;
    let figures: [(&'static str, Figure); 6] = [
        ("end_stop_mm_s", |t| Some(t.adaptive.blow_mm_s)),
        ("steady_state_mm", |t| {
            let motion = t.adaptive.motion?;
            Some(motion.steady_state_mm.unwrap_or(f64::INFINITY))
        }),
        ("rest_range_mm", |t| t.adaptive.motion?.rest_range_mm),
        ("w0_error", |t| {
            Some((t.adaptive.commissioned.ratios?[1] - 1.0).abs())
        }),
        ("c_error", |t| {
            Some((t.adaptive.commissioned.ratios?[0] - 1.0).abs())
        }),
        // Every axis that was not accepted, in the order of the seeds.
        ("not_accepted", |t| refusal(&t.adaptive).map(|_| 0.0)),
    ];
    let list = |of: Figure| {
        let mut found: Vec<(u64, f64)> = trials
            .iter()
            .filter_map(|t| Some((t.axis.seed, of(t)?)))
            .collect();
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found.truncate(10);
        found
    };
    figures.map(|(name, of)| (name, list(of))).into()
}

fn sentences(worst: &[(&'static str, Vec<(u64, f64)>)]) -> String {
    let mut lines = String::new();
    for (name, list) in worst {
        let seeds: Vec<String> = list
            .iter()
            .map(|(seed, value)| format!("{seed} ({})", text(*value)))
            .collect();
        lines += &format!("\nworst {name}: {}\n", seeds.join(", "));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_no_axis_are_null_and_no_text() {
        let none = Summary::new(&[]);
        let value = object(&none, &[]);
        assert!(value["steady_state_median_mm"].is_null());
        assert!(!markdown(&none).contains("NaN"));
    }
}
