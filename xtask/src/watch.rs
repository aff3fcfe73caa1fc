//! The firmware in the emulator, watched on a page for a given time: rates, losses, memory,
//! redraws.

use std::fs;
use std::process::Command;

use crate::process::{self, Done, M4F, cargo, target_directory};
use crate::{browser, setup};

/// Options of the task.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Time in s that it is watched.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(5..))]
    seconds: u32,
    /// Over RTT in the place of the serial line.
    #[arg(long)]
    rtt: bool,
}

/// Builds image and monitor as a user has them, and runs them; fails when a sample is missing,
/// dropped or lost.
pub(crate) fn run(options: &Options) -> Done {
    let chromium = browser::chromium()?;
    let target = target_directory()?;
    let out = target.join("browser");
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let scripts = browser::scripts(&out)?;
    process::run(cargo(&[
        "build",
        "-q",
        "--release",
        "-p",
        "trendid-monitor",
    ]))?;
    setup::run()?;
    let image = M4F.build("servo", "firmware")?;
    let mut command = Command::new("node");
    command
        .arg(scripts.join("watch.mjs"))
        .env("CHROMIUM", &chromium)
        .env("OUT", &out)
        .env("AXE", scripts.join("node_modules/axe-core/axe.min.js"))
        .env("MONITOR", target.join("release/trendid-monitor"))
        .env("IMAGE", &image)
        .env("SECONDS", options.seconds.to_string())
        .env("RTT", if options.rtt { "1" } else { "" });
    process::run(command)
}
