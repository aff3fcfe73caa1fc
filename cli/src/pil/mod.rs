//! `trendid pil`: the adaptive position loop on a processor, emulated or real, against the
//! simulated axis, bit for bit.

mod args;
mod compare;
mod line;
#[cfg(test)]
mod tests;

use std::time::Duration;

use serde_json::{Value, json};
use trendid_host_tests::servo::figures::Figures;
use trendid_host_tests::servo::run::{Options, run_with_shadow};
use trendid_host_tests::servo::scenario::Scenario;
use trendid_link::Counters;

use crate::output::{self, Refusal};

pub(crate) use args::PilArgs;

use compare::Target;
use line::{Disturbed, Line};

/// Runs the scenario with the loop on the target and compares every number with the same loop here.
///
/// # Errors
/// One sentence on a target that cannot be reached or does not answer, and on the first number that
/// differs.
pub(crate) fn run(args: &PilArgs) -> Result<(), Refusal> {
    let mut emulator = None;
    let (line, name): (Box<dyn Line>, _) = match &args.port {
        Some(port) => (line::serial(port)?, port.clone()),
        None => {
            // Only a disturbed line loses frames; a busy machine alone must not look like one.
            let patience = Duration::from_millis(if args.faults.is_some() { 20 } else { 1000 });
            let (guard, stream) = line::emulated(&args.image, patience)?;
            emulator = Some(guard);
            (Box::new(stream), "qemu-system-arm netduinoplus2".to_owned())
        }
    };
    let scenario = Scenario::from_name(&args.scenario).unwrap_or(Scenario::Nominal);
    let options = Options {
        fixed: args.fixed,
        ..Options::adaptive(args.seed)
    };
    // Two runs against the same board need different first numbers.
    let first = std::time::SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(1, |t| t.as_millis() as u32);
    let mut target = Target::new(Disturbed::new(line, args.faults, args.seed), first, args);
    let figures = run_with_shadow(scenario, &options, &mut target, &mut |_, _| {});
    drop(emulator);
    target.finish();
    report(args, &name, &target, &figures)?;
    match target.trouble {
        None => Ok(()),
        Some(trouble) => Err(Refusal::new(trouble)),
    }
}

fn report(args: &PilArgs, name: &str, target: &Target, figures: &Figures) -> Result<(), Refusal> {
    let last = target.last.as_ref();
    let by_target = last.map(|reply| reply.counters).unwrap_or_default();
    let by_host = target.counters();
    let model = last.map(|reply| reply.model);
    if args.json {
        let mut value = json_of(target, figures, model);
        value["target"] = name.into();
        value["fixed"] = args.fixed.into();
        value["seen_by_target"] = counters(&by_target);
        value["seen_by_host"] = counters(&by_host);
        return output::emit_json(&value);
    }
    output::emit(&text(name, target, figures, model))?;
    let row = |who: &str, c: &Counters| {
        format!(
            "{who}: {} corrupt, {} lost, {} repeated\n",
            c.corrupt, c.lost, c.repeated
        )
    };
    // What the line did depends on how fast this machine answered, so it is no part of the result.
    eprint!(
        "faults injected: {}; {}{}",
        target.line.injected,
        row("seen by the target", &by_target),
        row("seen by the host", &by_host)
    );
    Ok(())
}

fn counters(c: &Counters) -> Value {
    json!({"corrupt": c.corrupt, "lost": c.lost, "repeated": c.repeated})
}

fn json_of(target: &Target, figures: &Figures, model: Option<[f32; 6]>) -> Value {
    json!({
        "scenario": figures.scenario.name(),
        "seed": figures.seed,
        "samples": target.samples,
        "failed_readings": target.failed,
        "numbers": target.numbers,
        "identical": target.trouble.is_none(),
        "verified_at_s": figures.verified_at_s.map_or(Value::Null, output::number),
        "accepted": figures.accepted,
        "state": figures.state.to_string(),
        "model": model.map(|model| model.map(output::number32).to_vec()),
        "injected": target.line.injected,
    })
}

fn text(name: &str, target: &Target, figures: &Figures, model: Option<[f32; 6]>) -> String {
    let mut text = format!(
        "{}: {} (seed {})\n{} samples on {name}: {} numbers {}\n",
        figures.scenario.name(),
        figures.scenario.description(),
        figures.seed,
        target.samples,
        target.numbers,
        if target.trouble.is_none() {
            "bit-identical to the host"
        } else {
            "bit-identical to the host, then no more"
        },
    );
    if let Some(at) = figures.verified_at_s {
        text += &format!(
            "model verified after {at:.3} s; models that reached the controller: {}\n",
            figures.accepted
        );
    }
    text += &format!("at the end {}\n", figures.state);
    if let Some([a1, a2, b0, dead_zone, offset, friction]) = model {
        text += &format!(
            "model in the controller  a1 {a1:.1}  a2 {a2:.2}  b0 {b0:.0}  dead zone {dead_zone:.4}  offset {offset:.5}  friction {friction:.0}\n"
        );
    }
    if target.failed > 0 {
        text += &format!("readings of the sensor that failed: {}\n", target.failed);
    }
    text
}
