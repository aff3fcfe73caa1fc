//! `trendid endurance`: does the estimate stay true over hours?

use clap::Args;
use serde_json::{Value, json};
use trendid_host_tests::endurance::found::Found;
use trendid_host_tests::endurance::run::run;
use trendid_host_tests::endurance::scenario::{Case, MEMORIES, cases};

use crate::format::significant;
use crate::output::{Refusal, emit, emit_json, number, progress, under};
use crate::seeds::seeds;

/// Arguments of the command.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid endurance
  trendid endurance --seconds 86400 --json
  trendid endurance --only \"small steps\"

Errors are the largest over the whole scenario; of scenarios whose data do not obey the model, those after ten seconds of
motion that follow. The last three columns are other ways to forget, in f64, on the same samples (at most a million).
The command fails when a limit is broken: 4 sigma where the data obey the model, the covariance within its bound, every
number finite, the estimate held in 90 % of the samples in which a command does not move the axis. And, while a digit of
the position in f32 is no larger than its noise (to 84 m), 0.15/0.1/0.3 % for C/omega0/xi where the data obey the model
and 0.1 % ten seconds behind those that did not; but for more than 10 um of noise, friction, and 0.2 s at 5 and 100 rad/s.")]
pub(crate) struct EnduranceArgs {
    /// Length of each scenario in s, at 1 kHz
    #[arg(long, value_name = "S", default_value_t = 1000.0)]
    pub seconds: f64,
    /// Seed of the first run of the whole table; each has its own, whatever is left out
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    pub first_seed: u64,
    /// Only the scenarios whose name contains this
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Only the runs with this memory in s, or "none"
    #[arg(long, value_name = "S", value_parser = parse_memory)]
    pub memory: Option<Memory>,
    /// The table as JSON
    #[arg(long)]
    pub json: bool,
}

/// A memory in s, or none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Memory(Option<f64>);

fn parse_memory(text: &str) -> Result<Memory, String> {
    let known = MEMORIES.iter().find(|memory| named(**memory) == text);
    known.copied().map(Memory).ok_or_else(|| {
        let names: Vec<_> = MEMORIES.into_iter().map(named).collect();
        format!("the table has {}", names.join(", "))
    })
}

/// The other estimators run beside the first so many samples.
const OTHERS: u64 = 1_000_000;

/// Runs every scenario and prints the table.
///
/// # Errors
///
/// No seconds, too large a seed, no such scenario, or a limit that is broken, after the table.
pub(crate) fn run_all(args: &EnduranceArgs) -> Result<(), Refusal> {
    if !(args.seconds >= 1.0 && args.seconds <= 1e9) {
        return Err(Refusal::new(format!(
            "--seconds is {}: from 1 to 1e9 can be run",
            args.seconds
        )));
    }
    let wanted = |case: &Case| {
        let name = args.only.as_deref().unwrap_or_default();
        case.name().contains(name) && args.memory.is_none_or(|Memory(m)| m == case.memory)
    };
    let cases = cases();
    let seeds = seeds("the table", cases.len() as u64, args.first_seed)?;
    let mut numbered: Vec<_> = seeds.into_iter().zip(cases).collect();
    numbered.retain(|(_, case)| wanted(case));
    let (Some((first, _)), Some((last, _))) = (numbered.first(), numbered.last()) else {
        return Err(Refusal::new("--only leaves no scenario"));
    };
    let samples = (1000.0 * args.seconds) as u64;
    let bar = progress(numbered.len() as u64, "endurance");
    let found: Vec<Found> = under(&bar, &numbered, |(seed, case)| {
        // Beside one of the two runs with this memory; the nominal values are those of that run.
        let others = if case.trusted { OTHERS.min(samples) } else { 0 };
        run(case, *seed, samples, others)
    });
    bar.finish_and_clear();
    let runs: Vec<(&Case, &Found)> = (numbered.iter().map(|(_, case)| case))
        .zip(&found)
        .collect();
    if args.json {
        emit_json(&runs.iter().map(|(case, found)| row(case, found)).collect())?;
    } else {
        emit(&text(&runs, args.seconds, [*first, *last]))?;
    }
    let broken: Vec<String> = runs
        .iter()
        .filter_map(|(case, found)| Some(format!("{}: {}", label(case), found.violation(case)?)))
        .collect();
    match broken.len() {
        0 => Ok(()),
        n => Err(Refusal::new(format!(
            "{n} of {} runs break a limit: {}",
            runs.len(),
            broken.join("; ")
        ))),
    }
}

fn row(case: &Case, found: &Found) -> Value {
    let [c, omega0, xi] = found.errors_pct;
    json!({
        "scenario": case.name(),
        "memory_s": case.memory.map(number),
        "trusted": case.trusted,
        "obeys_model": case.scenario.obeys_model(),
        "finite": found.finite,
        "max_err_c_pct": number(c),
        "max_err_omega0_pct": number(omega0),
        "max_err_xi_pct": number(xi),
        "max_err_over_sigma": number(found.over_sigma),
        "p_over_bound": number(found.over_bound),
        "held_pct": number(100.0 * found.held),
    })
}

fn label(case: &Case) -> String {
    format!(
        "{}, memory {}{}",
        case.name(),
        memory(case),
        if case.trusted { ", nominal" } else { "" }
    )
}

fn memory(case: &Case) -> String {
    match case.memory {
        Some(_) => named(case.memory) + " s",
        None => named(None),
    }
}

fn named(memory: Option<f64>) -> String {
    memory.map_or("none".into(), |m| m.to_string())
}

fn text(runs: &[(&Case, &Found)], seconds: f64, [first, last]: [u64; 2]) -> String {
    let figure = |x: f64| {
        if x.is_finite() {
            significant(x, 2)
        } else {
            "-".into()
        }
    };
    let three = |e: [f64; 3]| e.map(figure).join("/");
    let mut text = String::from(
        "| scenario | memory | nominal | C/omega0/xi [%] | sigma | P/bound | held [%] | plain/directional/stabilised [%] | limits |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for (case, found) in runs {
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
            case.name(),
            memory(case),
            if case.trusted { "set" } else { "follows" },
            three(found.errors_pct),
            figure(found.over_sigma),
            figure(found.over_bound),
            figure(100.0 * found.held),
            found.others_pct.map_or(String::new(), three),
            found.violation(case).unwrap_or_else(|| "kept".into()),
        );
    }
    text += &format!(
        "\n{} runs of {seconds} s, seeds {first} to {last}.\n",
        runs.len(),
    );
    text
}
