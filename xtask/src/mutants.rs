//! Does a test notice when a line of the core is wrong? By the program in `xtask/mutants`.

use std::process::Stdio;

use crate::dated;
use crate::process::{Done, as_typed, cargo};
use crate::tool::Tool;

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Puts the results into docs/proofs.md, under the date and the commit.
    #[arg(long)]
    write: bool,
    /// What the program takes: `--sample N`, `--seed N`, `--only TEXT`; see its `--help`.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    rest: Vec<String>,
}

/// Draws, runs, and reports per room with a confidence interval.
pub(crate) fn run(options: &Options) -> Done {
    Tool::named("mutants", "cargo-mutants").install()?;
    let heading = dated::heading("mutants")?;
    let output = cargo(&["run", "-q", "--release", "-p", "trendid-mutants", "--"])
        .args(&options.rest)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    print!("{text}");
    if options.write && !text.is_empty() {
        let command = format!("`cargo xtask mutants {}`", as_typed(&options.rest));
        dated::add("docs/proofs.md", &heading, &format!("{command}\n\n{text}"))?;
    }
    if output.status.success() {
        Ok(())
    } else {
        Err(format!("mutants ended with {}", output.status))
    }
}
