//! `trendid loop`: the figures of the adaptive position loop in every scenario, with fixed gains
//! beside.

use clap::Args;
use indicatif::ProgressBar;
use serde_json::{Value, json};
use trendid_host_tests::servo::figures::Figures;
use trendid_host_tests::servo::run::{Options, run as run_scenario};
use trendid_host_tests::servo::scenario::Scenario;

use crate::format::significant;
use crate::output::{Refusal, emit, emit_json, progress, under};
use crate::seeds::seeds;
use crate::servo::demo_loop::{COLUMNS, Column, json_of};
use crate::servo::population::{self, PopulationArgs};

/// Arguments of the command.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid loop
  trendid loop --linear
  trendid loop --seeds 100 --first-seed 1000 --json
  trendid loop --population 100 --first-seed 1 --family hydraulic --worst

One line per scenario of `trendid demo`, median and worst of the runs. The last column counts the runs within the
figures of the project: steady state 0.05 mm, rise 200 ms, overshoot 1 %, sines 0.7 and 1.2 mm; after a change in motion
one and a half times that and less than 2 s until the error stays below 1.05 mm.

With --population: axes drawn at random instead of one axis, from consecutive seeds. Columns: the loop, the loop with the gains of
its commissioning, a controller whose gains were searched on each axis (P, velocity, acceleration, feedforward, inverse
of the dead zone), and that one on the axes that the loop controlled.")]
pub(crate) struct LoopArgs {
    /// Runs of each scenario
    #[arg(
        long,
        value_name = "N",
        default_value_t = 20,
        conflicts_with = "population"
    )]
    seeds: u64,
    /// Seed of the first run
    #[arg(long, value_name = "N", default_value_t = 1)]
    first_seed: u64,
    /// The linear servo of Table 2 behind the same valve dead zone and sensor, instead of the
    /// pneumatic axis
    #[arg(long, conflicts_with = "population")]
    linear: bool,
    /// A JSON list with an object for each run, or one object of the population
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    population: PopulationArgs,
}

/// Scenarios in which the axis is judged by how it moves.
const MOTION: [Scenario; 6] = [
    Scenario::Nominal,
    Scenario::Mass,
    Scenario::Supply,
    Scenario::ValveGain,
    Scenario::Friction,
    Scenario::Rest,
];

/// Runs every scenario and prints.
///
/// # Errors
///
/// A sentence on a number of runs or a seed that makes no sense.
pub(crate) fn run(args: &LoopArgs) -> Result<(), Refusal> {
    if let Some(axes) = args.population.population {
        return population::run(&args.population, axes, args.first_seed, args.json);
    }
    if let Some(option) = args.population.idle() {
        return Err(Refusal::new(format!("{option} needs --population N")));
    }
    let seeds = seeds("--seeds", args.seeds, args.first_seed)?;
    let faults: Vec<Scenario> = Scenario::ALL
        .into_iter()
        .filter(|s| s.expected().is_some())
        .collect();
    let lines = 2 * MOTION.len() + faults.len();
    let bar = progress(args.seeds * lines as u64, "runs");
    let moved: Vec<(Vec<Figures>, bool)> = MOTION
        .into_iter()
        .flat_map(|scenario| [(scenario, false), (scenario, true)])
        .map(|(scenario, fixed)| (runs(args, &seeds, scenario, fixed, &bar), fixed))
        .collect();
    let refused: Vec<Vec<Figures>> = faults
        .into_iter()
        .map(|scenario| runs(args, &seeds, scenario, false, &bar))
        .collect();
    bar.finish_and_clear();
    if args.json {
        let adaptive = refused.iter().map(|runs| (runs, false));
        let values: Vec<Value> = moved
            .iter()
            .map(|(runs, fixed)| (runs, *fixed))
            .chain(adaptive)
            .flat_map(|(runs, fixed)| runs.iter().map(move |f| json_of(f, fixed)))
            .collect();
        emit_json(&json!(values))?;
        return Ok(());
    }
    emit(&markdown(args, &moved, &refused))?;
    Ok(())
}

fn runs(
    args: &LoopArgs,
    seeds: &[u64],
    scenario: Scenario,
    fixed: bool,
    bar: &ProgressBar,
) -> Vec<Figures> {
    under(bar, seeds, |seed| {
        let options = Options {
            fixed,
            linear: args.linear,
            ..Options::adaptive(*seed)
        }
        .somewhere();
        run_scenario(scenario, &options, &mut |_, _| {})
    })
}

/// Median and worst of a figure; a run that does not come to it counts as infinite.
fn spread(runs: &[Figures], column: &Column) -> String {
    let figure = column.of;
    if runs.iter().all(|f| figure(f).is_none()) {
        return if runs[0].scenario.is_change() {
            "never".into()
        } else {
            String::new()
        };
    }
    let mut values: Vec<f64> = runs
        .iter()
        .map(|f| figure(f).unwrap_or(f64::INFINITY))
        .collect();
    values.sort_by(f64::total_cmp);
    let text = |value: f64| {
        if value.is_finite() {
            significant(value, 3)
        } else {
            "never".into()
        }
    };
    format!(
        "{} / {}",
        text(values[values.len() / 2]),
        text(values[values.len() - 1])
    )
}

fn markdown(args: &LoopArgs, moved: &[(Vec<Figures>, bool)], refused: &[Vec<Figures>]) -> String {
    let last = args.first_seed + args.seeds - 1;
    let mut text = format!(
        "Seeds {} to {last}; median / worst.\n\n| scenario | gains |",
        args.first_seed
    );
    let [motion @ .., rest] = &COLUMNS;
    for column in motion {
        text += &format!(" {} |", column.short);
    }
    text += " within |\n|---|---|";
    text += &"---|".repeat(motion.len() + 1);
    text.push('\n');
    for (runs, fixed) in moved {
        let gains = if *fixed { "fixed" } else { "adaptive" };
        text += &format!("| {} | {gains} |", runs[0].scenario.name());
        for column in motion {
            text += &format!(" {} |", spread(runs, column));
        }
        let within = runs.iter().filter(|f| f.outside().is_empty()).count();
        text += &format!(" {within} of {} |\n", args.seeds);
    }
    if let Some((runs, _)) = moved
        .iter()
        .find(|(runs, fixed)| runs[0].scenario == Scenario::Rest && !fixed)
    {
        let kept = runs.iter().filter(|f| f.gains_kept == Some(true)).count();
        text += &format!(
            "\n60 s at rest: range of the position {} mm, gains bit for bit as before in {kept} of {}.\n",
            spread(runs, rest),
            args.seeds
        );
    }
    text += "\n| fault | refused with the right reason | old gains kept | reason |\n|---|---|---|---|\n";
    for runs in refused {
        let scenario = runs[0].scenario;
        let right = runs.iter().filter(|f| f.refused_rightly()).count();
        let kept = runs.iter().filter(|f| f.gains_kept == Some(true)).count();
        let reasons: Vec<String> = scenario
            .expected()
            .unwrap_or_default()
            .iter()
            .map(ToString::to_string)
            .collect();
        text += &format!(
            "| {} | {right} of {} | {kept} of {} | {} |\n",
            scenario.name(),
            args.seeds,
            args.seeds,
            reasons.join("; ")
        );
    }
    text
}
