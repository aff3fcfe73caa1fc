//! `trendid select`: orders, zeros and delays against IQ on held-back samples.

use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::auto::{Choice, Freedom, LONGEST_DELAY, tune};
use crate::estimate::{Estimate, Index, Problem};
use crate::format::{significant, table, with_sigma};
use crate::identify::check;
use crate::output::{Refusal, emit, emit_json, number, progress};
use crate::signals::{SignalArgs, Signals, StructureChoice, parse_delay, parse_filter};
use crate::tuning::Tuning;

const EXAMPLE: &str = "\
Example:
  trendid select dryer.csv --constant

Every structure is estimated with the first half of the record, at every delay; IQ is
the sum of the squared one-step prediction errors (11) over the second half, with the
parameters held. All candidates share the filter poles, so their IQ compare.
Recommended is the structure with the fewest parameters whose IQ is within 10 % of the
smallest among those whose free simulation fits within one point of the best.";

/// A structure is as good as the best when its IQ is at most this much larger.
const TOLERANCE: f64 = 0.1;

/// And only when its free simulation fits at most so many points worse: slow
/// disturbances lower the IQ of a richer structure without making it truer.
const POINTS: f64 = 1.0;

/// Compare orders, zeros and delays on a record
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub struct SelectArgs {
    #[command(flatten)]
    signals: SignalArgs,
    /// Highest order tried, 1 to 4, the integrator included
    #[arg(long, value_name = "M", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=4))]
    max_order: u8,
    /// Try only structures with an integrator (a0 = 0)
    #[arg(long)]
    integrator: bool,
    /// Delay in samples, or all from 0 to 10
    #[arg(long, value_name = "D|auto", default_value = "auto", value_parser = parse_delay)]
    delay: Choice<usize>,
    /// Filter poles in rad/s, or `auto`
    #[arg(long, value_name = "POLE|auto", default_value = "auto", value_parser = parse_filter)]
    filter: Choice<Option<f64>>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// One structure at its best delay.
struct Candidate {
    structure: StructureChoice,
    delay: usize,
    estimate: Estimate,
    names: Vec<String>,
    index: Index,
    fit_x0c: f64,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record, or that no structure fits it.
pub fn run(args: &SelectArgs) -> Result<(), Refusal> {
    let signals = args.signals.load()?;
    let structures = structures(args.max_order.into(), args.integrator);
    // What is wrong with the simplest structure is wrong with the record.
    args.signals.problem(&signals, structures[0])?;
    let pole = pole(args, &signals)?;
    let delays: Vec<usize> = match args.delay {
        Choice::Given(delay) => vec![delay],
        Choice::Auto => (0..=LONGEST_DELAY).collect(),
    };
    let bar = progress(
        (structures.len() * delays.len()) as u64,
        "structures and delays",
    );
    let mut candidates = Vec::new();
    for structure in structures {
        // More parameters than the samples can carry are no candidate.
        let Ok(problem) = args.signals.problem(&signals, structure) else {
            continue;
        };
        let tried: Vec<Candidate> = delays
            .par_iter()
            .filter_map(|&delay| {
                bar.inc(1);
                candidate(
                    &problem,
                    structure,
                    Tuning {
                        pole,
                        own: None,
                        delay,
                    },
                )
            })
            .collect();
        let best = tried
            .into_iter()
            .min_by(|a, b| a.index.iq.total_cmp(&b.index.iq));
        candidates.extend(best);
    }
    bar.finish_and_clear();
    let Some(chosen) = recommended(&candidates) else {
        return Err(Refusal::new(format!(
            "the data cannot carry any structure of order 1 to {}: the first half of the record excites too little",
            args.max_order
        )));
    };
    if args.json {
        emit_json(&json_of(&candidates, chosen, pole, signals.dt));
    } else {
        emit(&text(&candidates, chosen, pole, &signals, args));
    }
    Ok(())
}

fn structures(max_order: usize, integrating_only: bool) -> Vec<StructureChoice> {
    let mut all = Vec::new();
    for order in 1..=max_order {
        for integrator in [true, false] {
            if integrator || !integrating_only {
                all.extend((0..order).map(|zeros| StructureChoice {
                    order,
                    integrator,
                    zeros,
                }));
            }
        }
    }
    all
}

/// The filter pole for all candidates: given, or the best for a simple structure
/// of second order.
fn pole(args: &SelectArgs, signals: &Signals) -> Result<Option<f64>, Refusal> {
    if let Choice::Given(pole) = args.filter {
        return Ok(pole);
    }
    let order = usize::from(args.max_order).min(2);
    let rough = StructureChoice {
        order,
        integrator: args.integrator,
        zeros: 0,
    };
    let bar = progress(0, "filter pole");
    let freedom = Freedom {
        pole: Choice::Auto,
        delay: args.delay,
    };
    let tuning = tune(&args.signals.problem(signals, rough)?, freedom, &bar)?;
    bar.finish_and_clear();
    Ok(tuning.pole)
}

fn candidate(problem: &Problem, structure: StructureChoice, tuning: Tuning) -> Option<Candidate> {
    let run = problem.run_held(tuning).ok()?;
    check(problem, &run.half).ok()?;
    if !run.index.iq.is_finite() {
        return None;
    }
    let n = problem.y.len();
    let free = problem.free_run(&run.half, tuning.delay, n / 2..n);
    Some(Candidate {
        structure,
        delay: tuning.delay,
        names: problem.parameter_names(),
        estimate: run.half,
        index: run.index,
        fit_x0c: free.map_or(f64::NEG_INFINITY, |f| f.fit_x0c),
    })
}

/// The candidate with the fewest parameters within [`TOLERANCE`] of the smallest
/// IQ among those within [`POINTS`] of the best simulation; and that smallest one.
fn recommended(candidates: &[Candidate]) -> Option<(usize, usize)> {
    let best_fit = candidates
        .iter()
        .map(|c| c.fit_x0c)
        .fold(f64::NEG_INFINITY, f64::max);
    let fits = |k: &usize| candidates[*k].fit_x0c >= best_fit - POINTS;
    let iq = |k: &usize| candidates[*k].index.iq;
    let smallest = (0..candidates.len())
        .filter(fits)
        .min_by(|i, j| iq(i).total_cmp(&iq(j)))?;
    let near = |k: &usize| iq(k) <= (1.0 + TOLERANCE) * iq(&smallest);
    let count = |k: &usize| candidates[*k].names.len();
    let simplest = (0..candidates.len())
        .filter(fits)
        .filter(near)
        .min_by(|i, j| count(i).cmp(&count(j)).then(iq(i).total_cmp(&iq(j))))?;
    Some((simplest, smallest))
}

fn reason(candidates: &[Candidate], (chosen, smallest): (usize, usize)) -> String {
    let (c, best) = (&candidates[chosen], &candidates[smallest]);
    let rest = "among those that simulate within one point of the best fit";
    if chosen == smallest {
        format!(
            "the smallest IQ {rest}, and none with fewer than its {} parameters comes within 10 %",
            c.names.len()
        )
    } else {
        format!(
            "the fewest parameters ({}) within 10 % of the smallest IQ ({} with {} parameters) {rest}",
            c.names.len(),
            significant(best.index.iq, 4),
            best.names.len()
        )
    }
}

fn text(
    candidates: &[Candidate],
    chosen: (usize, usize),
    pole: Option<f64>,
    signals: &Signals,
    args: &SelectArgs,
) -> String {
    let mut text = format!(
        "{}: {} samples every {} s; estimated with the first half, judged on the second\n",
        args.signals.file.display(),
        signals.y.len(),
        significant(signals.dt, 5)
    );
    text += &match pole {
        Some(pole) => format!(
            "filter poles at -{} rad/s for all\n\n",
            significant(pole, 3)
        ),
        None => "raw trends\n\n".into(),
    };
    let head = [
        "order",
        "integrator",
        "zeros",
        "delay",
        "parameters",
        "IQ",
        "IV",
        "fit x0+c",
        "",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (k, c) in candidates.iter().enumerate() {
        let s = c.structure;
        rows.push(vec![
            s.order.to_string(),
            if s.integrator { "yes" } else { "no" }.into(),
            s.zeros.to_string(),
            c.delay.to_string(),
            c.names.len().to_string(),
            significant(c.index.iq, 4),
            significant(c.index.iv, 4),
            if c.fit_x0c > -1e3 {
                format!("{:.2} %", c.fit_x0c)
            } else {
                "runs away".into()
            },
            if k == chosen.0 { "<== recommended" } else { "" }.into(),
        ]);
    }
    text += &table(&rows);
    let c = &candidates[chosen.0];
    text += &format!(
        "\nRecommended: {}: {}.\n",
        describe(c),
        reason(candidates, chosen)
    );
    let mut rows = Vec::new();
    for ((name, value), sigma) in c.names.iter().zip(&c.estimate.theta).zip(&c.estimate.sigma) {
        let remark = if value.abs() < 2.0 * sigma {
            "not told from zero"
        } else {
            ""
        };
        rows.push(vec![
            name.clone(),
            with_sigma(*value, *sigma),
            remark.into(),
        ]);
    }
    text += &table(&rows);
    text
}

fn describe(c: &Candidate) -> String {
    let s = c.structure;
    format!(
        "order {}{}, {} zeros, delay {} samples",
        s.order,
        if s.integrator { " with integrator" } else { "" },
        s.zeros,
        c.delay
    )
}

fn json_of(candidates: &[Candidate], chosen: (usize, usize), pole: Option<f64>, dt: f64) -> Value {
    let one = |c: &Candidate| {
        json!({
            "order": c.structure.order,
            "integrator": c.structure.integrator,
            "zeros": c.structure.zeros,
            "delay": c.delay,
            "delay_s": number(c.delay as f64 * dt),
            "parameters": c.names,
            "theta": c.estimate.theta.iter().map(|v| number(*v)).collect::<Vec<_>>(),
            "sigma": c.estimate.sigma.iter().map(|v| number(*v)).collect::<Vec<_>>(),
            "iq": number(c.index.iq),
            "iv": number(c.index.iv),
            "fit_x0c_pct": number(c.fit_x0c),
        })
    };
    json!({
        "filter_pole": pole.map(number),
        "candidates": candidates.iter().map(one).collect::<Vec<_>>(),
        "recommended": chosen.0,
        "reason": reason(candidates, chosen),
    })
}
