//! `trendid options`: what each option of the core costs beside what it gains.

mod cost;
mod gains;

use clap::Args;
use serde_json::{Value, json};

use crate::format::significant;
use crate::options::cost::{COUNTS, Cost, instructions};
use crate::options::gains::{Gain, gains};
use crate::output::{Refusal, emit, emit_json, number, progress};
use crate::seeds::seeds;

/// Arguments of the command.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid options
  trendid options --json --seeds 200")]
pub(crate) struct OptionsArgs {
    /// Records per option
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub seeds: u64,
    /// Seed of the first record
    #[arg(long, value_name = "N", default_value_t = 500_000)]
    pub first_seed: u64,
    /// The table as JSON
    #[arg(long)]
    pub json: bool,
}

/// Runs every option and prints the table.
///
/// # Errors
///
/// Seeds that make no sense, or counts that lack a row.
pub(crate) fn run(args: &OptionsArgs) -> Result<(), Refusal> {
    let all = seeds("--seeds", args.seeds, args.first_seed)?;
    let counts: Value = serde_json::from_str(COUNTS)
        .map_err(|error| Refusal::new(format!("the counts of instructions: {error}")))?;
    let seeds = args.first_seed..args.first_seed + all.len() as u64;
    let bar = progress(0, "options");
    let gains = gains(&seeds, &bar);
    bar.finish_and_clear();
    let mut rows = Vec::new();
    for gain in &gains {
        rows.push((gain, instructions(&counts, &gain.tried.cost)?));
    }
    if args.json {
        let list: Vec<Value> = rows
            .iter()
            .map(|(gain, [sample, call])| {
                let three = |e: [f64; 3]| e.map(number).to_vec();
                json!({
                    "option": gain.tried.option,
                    "instructions_per_sample": sample.map(number),
                    "instructions_per_call": call.map(number),
                    "condition": gain.tried.condition,
                    "rms_without_pct": three(gain.without),
                    "rms_with_pct": three(gain.with),
                })
            })
            .collect();
        emit_json(&json!({"first_seed": args.first_seed, "seeds": args.seeds, "options": list}))?;
    } else {
        emit(&text(&rows, &seeds))?;
    }
    Ok(())
}

fn text(rows: &[(&Gain, [Option<f64>; 2])], seeds: &std::ops::Range<u64>) -> String {
    let mut text = String::from(
        "| option | instructions | condition | C/omega0/xi without [%] | with [%] |\n|---|---|---|---|---|\n",
    );
    for (gain, [sample, call]) in rows {
        let mut cost = Vec::new();
        if let Some(sample) = sample {
            let while_used = match gain.tried.cost {
                Cost::Commissioning { .. } => " while commissioning",
                _ => "",
            };
            cost.push(format!("{sample:+.0} a sample{while_used}"));
        }
        if let Some(call) = call {
            cost.push(format!("{call:.0} a call"));
        }
        text += &format!(
            "| {} | {} | {} | {} | {} |\n",
            gain.tried.option,
            cost.join(", "),
            gain.tried.condition,
            errors(gain.without),
            errors(gain.with)
        );
    }
    text += &format!(
        "\nErrors: rms over the seeds {} to {}; `-` where a run has no reading. Instructions: means of `docs/icount.json`, -O3 on a Cortex-M4F, with the option less without it; where a function lies in the image moves a count by up to 5.\n",
        seeds.start,
        seeds.end - 1
    );
    text
}

fn errors(e: [f64; 3]) -> String {
    e.map(|e| {
        if e.is_finite() {
            significant(e, 2)
        } else {
            "-".into()
        }
    })
    .join(" / ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_a_dash() {
        assert_eq!(errors([0.123, f64::INFINITY, 12.3]), "0.12 / - / 12");
    }
}
