//! `trendid simulate`: a record of the simulated servo, with its truth in the header.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;
use trendid_host_tests::plants::servo::REFERENCE;

use crate::output::{Refusal, emit, emit_json, number};
use crate::servo::linear_args::{NoiseArgs, truth_lines};

const EXAMPLE: &str = "\
Example (simulate ten seconds, then identify them):
  trendid simulate --out servo.csv --seconds 10 --seed 3
  trendid identify servo.csv --order 3 --integrator";

/// Write a record of the simulated servo, with its truth in the header
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct SimulateArgs {
    /// File to write, or `-`: columns t [s], u, y [mm] (measured), x [mm] (true)
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
    #[command(flatten)]
    noise: NoiseArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on an option that makes no sense or a file that cannot be written.
pub(crate) fn run(args: &SimulateArgs) -> Result<(), Refusal> {
    let record = args.noise.record()?;
    let n = &args.noise;
    let mut text = String::from(
        "# Simulated servo drive of K. Janiszowski (1999), Table 2; binary command of +-0.4 held 50 ms\n",
    );
    for line in truth_lines(&REFERENCE) {
        text += &line;
        text.push('\n');
    }
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "# measurement: eta = {} um (white, full width), w = {} um (drift, full width), eps = {} um (resolution), seed = {}",
        n.eta, n.w, n.eps, n.seed
    );
    text += "# t [s], u [1] held, y [mm] measured, x [mm] true\nt,u,y,x\n";
    for s in record.samples() {
        let _ = writeln!(text, "{:.3},{},{:.6},{:.6}", s.t, s.u, s.y, s.y_true);
    }
    if args.out.as_os_str() == "-" {
        return match args.json {
            true => Err(Refusal::new(
                "--out - writes the record to the standard output, where --json has no place",
            )),
            false => emit(&text),
        };
    }
    std::fs::write(&args.out, text)
        .map_err(|e| Refusal::new(format!("cannot write `{}`: {e}", args.out.display())))?;
    if args.json {
        emit_json(&json!({
            "file": args.out.display().to_string(),
            "samples": record.len(),
            "dt": number(record.dt),
            "a": REFERENCE.a(),
            "b0": REFERENCE.b0(),
        }))?;
    } else {
        emit(&format!(
            "{}: {} samples every {} s, the truth is in the header\n",
            args.out.display(),
            record.len(),
            record.dt
        ))?;
    }
    Ok(())
}
