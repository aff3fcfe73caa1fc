//! `trendid loop --population`: the position loop on axes drawn at random.

use std::ops::Range;

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde_json::{Map, Value, json};
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::summary::{CommissioningFigures, Summary, refusal};
use trendid_host_tests::servo::population::trial::{LoopRun, Trial, commissioned};

use crate::format::significant;
use crate::output::{Refusal, emit, emit_json, number, progress, under};
use crate::seeds::seeds;
use crate::servo::population_faults::{self, FaultTables};
use crate::servo::population_rows::{COMMISSIONING, ROWS, columns};
use crate::servo::population_work::{self, Drawn};

/// Most axes of a run.
const AXES_MAX: u64 = 100_000;

pub(super) fn family_names() -> PossibleValuesParser {
    PossibleValuesParser::new(Family::ALL.map(Family::name))
}

/// Options of `--population`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Population")]
pub(super) struct PopulationArgs {
    /// So many axes drawn at random instead of one axis
    #[arg(long, value_name = "N")]
    pub population: Option<u64>,
    /// Family of the axes; pneumatic without
    #[arg(long, value_name = "NAME", requires = "population", value_parser = family_names())]
    family: Option<String>,
    /// Draw from the half of each range about an ordinary machine
    #[arg(long, requires = "population")]
    usual: bool,
    /// Commission only
    #[arg(long, requires = "population", conflicts_with = "worst")]
    commission: bool,
    /// Name the seeds of the worst axes
    #[arg(long, requires = "population")]
    worst: bool,
    /// Let the first N axes that a model near the truth controls work for so many seconds each,
    /// without a fault
    #[arg(long, value_name = "S", requires = "population", conflicts_with_all = ["commission", "worst", "faults"])]
    work: Option<f64>,
    /// With --work: N axes that the loop commissions first, told sample time, travel and limits of
    /// motion
    #[arg(long, requires = "work")]
    untold: bool,
    /// Break so many axes, the first that a model near the truth controls, in every way and every
    /// state
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        requires = "population",
        conflicts_with = "commission"
    )]
    faults: u64,
}

impl PopulationArgs {
    /// An option that says nothing without a population. (clap asks for none beside an argument
    /// that excludes one.)
    pub(super) fn idle(&self) -> Option<&'static str> {
        let given = [
            ("--family", self.family.is_some()),
            ("--usual", self.usual),
            ("--commission", self.commission),
            ("--worst", self.worst),
            ("--work", self.work.is_some()),
            ("--untold", self.untold),
            ("--faults", self.faults > 0),
        ];
        let mut given = given.into_iter().filter(|(_, given)| *given);
        given.next().map(|(name, _)| name)
    }
}

/// Runs the axes and prints.
///
/// # Errors
///
/// A sentence on a number of axes that makes no sense.
pub(super) fn run(args: &PopulationArgs, axes: u64, first: u64, json: bool) -> Result<(), Refusal> {
    if !(1..=AXES_MAX).contains(&axes) {
        return Err(Refusal::new(format!(
            "--population {axes} is not between 1 and {AXES_MAX}"
        )));
    }
    let seeds = seeds("--population", axes, first)?;
    let end = first + axes;
    let family = args.family.as_deref().and_then(Family::from_name);
    let family = family.unwrap_or(Family::Pneumatic);
    if let Some(seconds) = args.work {
        let drawn = Drawn {
            family,
            usual: args.usual,
            untold: args.untold,
        };
        return population_work::run(&drawn, axes, first, seconds, json);
    }
    if args.commission {
        return commission(family, args.usual, first..end, json);
    }
    let bar = progress(axes, "axes");
    let trials = under(&bar, &seeds, |seed| Trial::run(family, args.usual, *seed));
    bar.finish_and_clear();
    let summary = Summary::new(&trials);
    let faults = population_faults::run(family, args.usual, first, args.faults)?;
    let worst = if args.worst { worst(&trials) } else { vec![] };
    if json {
        let mut value = object(&summary, &worst);
        if let (Some(faults), Value::Object(top)) = (&faults, &mut value) {
            faults.insert_into(top);
        }
        emit_json(&value)?;
    } else {
        let head = head(family, args.usual, &(first..end));
        let faults = faults.as_ref().map(FaultTables::markdown);
        let faults = faults.unwrap_or_default();
        emit(&(head + &markdown(&summary) + &faults + &sentences(&worst)))?;
    }
    Ok(())
}

fn head(family: Family, usual: bool, seeds: &Range<u64>) -> String {
    let kind = if usual { "usual " } else { "" };
    format!(
        "{} {kind}{} axes, seeds {} to {}.\n",
        seeds.end - seeds.start,
        family.name(),
        seeds.start,
        seeds.end - 1
    )
}

/// Commissions the axes and prints what came of it.
fn commission(family: Family, usual: bool, seeds: Range<u64>, json: bool) -> Result<(), Refusal> {
    let bar = progress(seeds.end - seeds.start, "axes");
    let all: Vec<u64> = seeds.clone().collect();
    let runs = under(&bar, &all, |seed| commissioned(family, usual, *seed));
    bar.finish_and_clear();
    let runs: Vec<&LoopRun> = runs.iter().collect();
    let figures = CommissioningFigures::new(&runs);
    if json {
        let mut top = Map::new();
        top.insert("axes".into(), json!(runs.len()));
        insert(&figures, &mut top);
        emit_json(&Value::Object(top))?;
    } else {
        emit(&(head(family, usual, &seeds) + &commissioning_table(&figures)))?;
    }
    Ok(())
}

fn insert(figures: &CommissioningFigures, top: &mut Map<String, Value>) {
    for (key, _, _, value) in COMMISSIONING {
        top.insert(key.into(), number(value(figures)));
    }
    top.insert("refused".into(), json!(figures.refused));
}

fn commissioning_table(figures: &CommissioningFigures) -> String {
    let mut table = String::from("\n| commissioning | |\n|---|---|\n");
    for (_, unit, title, value) in COMMISSIONING {
        table += &format!("| {title} [{unit}] | {} |\n", text(value(figures)));
    }
    for (reason, axes) in &figures.refused {
        table += &format!("| not accepted: {reason} [axes] | {axes} |\n");
    }
    table
}

fn object(summary: &Summary, worst: &[(&'static str, Vec<(u64, f64)>)]) -> Value {
    let mut top = Map::new();
    top.insert("axes".into(), json!(summary.axes));
    insert(&summary.commissioning, &mut top);
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
    let mut text_of = commissioning_table(&summary.commissioning);
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
