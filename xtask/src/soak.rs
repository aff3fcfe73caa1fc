//! Simulated hours of the identifier and of the loop.

use crate::process::{self, Done, cargo};

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Simulated seconds of each scenario; a day has 86400.
    #[arg(long, value_name = "S", default_value_t = SHORT)]
    seconds: u32,
}

/// What continuous integration runs.
const SHORT: u32 = 1000;

/// Runs every scenario of `trendid endurance`, which fails when a limit is broken.
pub(crate) fn run(options: &Options) -> Done {
    let seconds = options.seconds.to_string();
    let command = ["run", "-q", "--release", "-p", "trendid-cli", "--"];
    process::run(cargo(
        &[&command[..], &["endurance", "--seconds", &seconds]].concat(),
    ))
}
