//! `trendid select`: orders, zeros and delays against ISE on held-back samples.

use clap::Args;
use serde_json::{Value, json};
use trendid_identify::search::LONGEST_DELAY;
use trendid_identify::select::{Candidate, Dropped, Range, Selection};
use trendid_identify::{Choice, Freedom, Options, Signals, select};

use crate::format::{counted, significant, table, with_sigma};
use crate::identify::signals::{SignalArgs, parse_delay, parse_filter};
use crate::output::{Bar, Refusal, emit, emit_json, number};

const EXAMPLE: &str = "\
Example:
  trendid select dryer.csv --constant

Every structure is estimated with the first half of the record, at every delay; ISE is
the sum of the squared one-step prediction errors (11) over the second half, with the
parameters held. All candidates share the filter poles, so their ISE compare.
Recommended is the structure with the fewest parameters whose ISE is within 10 % of the
smallest among those whose free simulation fits within one point of the best.";

/// Compare orders, zeros and delays on a record
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct SelectArgs {
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
    #[arg(long, value_name = "POLE|auto", default_value = "auto", value_parser = parse_filter, allow_negative_numbers = true)]
    filter: Choice<Option<f64>>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record, or that no structure fits it.
pub(crate) fn run(args: &SelectArgs) -> Result<(), Refusal> {
    let loaded = args.signals.load()?;
    let signals = loaded.signals();
    let range = Range {
        max_order: args.max_order.into(),
        integrating: args.integrator,
        constant: args.signals.constant,
    };
    let options = Options {
        scheme: args.signals.scheme.into(),
        memory: None,
    };
    let freedom = Freedom {
        pole: args.filter,
        delay: args.delay,
    };
    let bar = Bar::new("structures and delays");
    let selection = select(&signals, range, options, freedom, &bar)?;
    bar.finish();
    if args.json {
        emit_json(&json_of(&selection, signals.dt));
    } else {
        emit(&text(&selection, &signals, args));
    }
    Ok(())
}

fn reason(selection: &Selection) -> String {
    let best = &selection.candidates[selection.smallest];
    let c = &selection.candidates[selection.recommended];
    let rest = "among those that simulate within one point of the best fit";
    if selection.recommended == selection.smallest {
        format!(
            "the smallest ISE {rest}, and none with fewer than its {} parameters comes within 10 %",
            c.names.len()
        )
    } else {
        format!(
            "the fewest parameters ({}) within 10 % of the smallest ISE ({} with {} parameters) {rest}",
            c.names.len(),
            significant(best.errors.ise, 4),
            best.names.len()
        )
    }
}

fn text(selection: &Selection, signals: &Signals, args: &SelectArgs) -> String {
    let mut text = format!(
        "{}: {} samples every {} s; estimated with the first half, judged on the second\n",
        args.signals.file.display(),
        signals.output.len(),
        significant(signals.dt, 5)
    );
    text += &match selection.pole {
        Some(pole) => format!(
            "filter poles at -{} rad/s for all\n\n",
            significant(pole, 3)
        ),
        None => "raw trends\n\n".into(),
    };
    text += &candidates(selection);
    text += &dropped(selection);
    let c = &selection.candidates[selection.recommended];
    text += &format!("\nRecommended: {}: {}.\n", describe(c), reason(selection));
    if args.delay == Choice::Auto && c.delay == LONGEST_DELAY {
        text += "The delay is the longest that was tried: give a longer one by --delay.\n";
    }
    if !c.estimate.reading.stable {
        text += "This model is unstable: no structure here fits the record.\n";
    }
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

/// One line for each structure and reason that is missing among the candidates.
fn dropped(selection: &Selection) -> String {
    let mut rows = Vec::new();
    let groups = selection
        .dropped
        .chunk_by(|a, b| (a.structure, &a.reason) == (b.structure, &b.reason));
    for group in groups {
        let s = group[0].structure;
        let delays: Vec<usize> = group.iter().filter_map(|d| d.delay).collect();
        let delay = match delays[..] {
            [] => "any".to_owned(),
            [one] => one.to_string(),
            [first, .., last] if last - first + 1 == delays.len() => format!("{first} to {last}"),
            _ => delays
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(" "),
        };
        rows.push(vec![
            s.order.to_string(),
            if s.integrator { "yes" } else { "no" }.into(),
            s.zeros.to_string(),
            delay,
            group[0].reason.to_string(),
        ]);
    }
    if rows.is_empty() {
        return String::new();
    }
    let head = [
        "order",
        "integrator",
        "zeros",
        "delay",
        "not compared because",
    ];
    rows.insert(0, head.map(str::to_owned).to_vec());
    format!("\n{}", table(&rows))
}

/// One line per candidate.
fn candidates(selection: &Selection) -> String {
    let head = [
        "order",
        "integrator",
        "zeros",
        "delay",
        "parameters",
        "ISE",
        "IAE",
        "fit x0+c",
        "",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (k, c) in selection.candidates.iter().enumerate() {
        let s = c.structure;
        rows.push(vec![
            s.order.to_string(),
            if s.integrator { "yes" } else { "no" }.into(),
            s.zeros.to_string(),
            c.delay.to_string(),
            c.names.len().to_string(),
            significant(c.errors.ise, 4),
            significant(c.errors.iae, 4),
            if c.fit_x0c > -1e3 {
                format!("{:.2} %", c.fit_x0c)
            } else {
                "runs away".into()
            },
            if k == selection.recommended {
                "<== recommended"
            } else {
                ""
            }
            .into(),
        ]);
    }
    table(&rows)
}

fn describe(c: &Candidate) -> String {
    let s = c.structure;
    format!(
        "order {}{}, {}, delay {}",
        s.order,
        if s.integrator { " with integrator" } else { "" },
        counted(s.zeros, "zero"),
        counted(c.delay, "sample")
    )
}

fn json_of(selection: &Selection, dt: f64) -> Value {
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
            "ise": number(c.errors.ise),
            "iae": number(c.errors.iae),
            "fit_x0c_pct": number(c.fit_x0c),
            "stable": c.estimate.reading.stable,
        })
    };
    let missing = |d: &Dropped| {
        json!({
            "order": d.structure.order,
            "integrator": d.structure.integrator,
            "zeros": d.structure.zeros,
            "delay": d.delay,
            "reason": d.reason.to_string(),
        })
    };
    json!({
        "filter_pole": selection.pole.map(number),
        "candidates": selection.candidates.iter().map(one).collect::<Vec<_>>(),
        "dropped": selection.dropped.iter().map(missing).collect::<Vec<_>>(),
        "recommended": selection.recommended,
        "reason": reason(selection),
    })
}
