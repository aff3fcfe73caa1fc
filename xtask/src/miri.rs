//! Undefined behaviour, by interpretation: the unit tests of what runs on a target, and the store.

use std::process::Command;

use crate::process::{self, Done, works};
use crate::tool;

/// libm has inline assembly for x86-64 and 64-bit ARM, which cannot be interpreted; this target has none.
const TARGET: &str = "riscv64gc-unknown-linux-gnu";

/// Packages and their tests: what has no simulated hours in it.
const RUNS: [&[&str]; 4] = [
    &["-p", "trendid", "--lib"],
    &["-p", "trendid-link"],
    &["-p", "trendid-example-support", "--lib"],
    &["-p", "trendid-fuzz", "--test", "corpus", "store"],
];

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Toolchain with Miri, a nightly one.
    #[arg(long, value_name = "NAME", default_value = "nightly")]
    toolchain: String,
}

/// Interprets the tests.
pub(crate) fn run(options: &Options) -> Done {
    let toolchain = &options.toolchain;
    let plus = format!("+{toolchain}");
    if !works("rustc", &[&plus, "--version"]) {
        let mut command = Command::new("rustup");
        command.args(["toolchain", "install", "--profile", "minimal", toolchain]);
        process::run(command)?;
    }
    tool::components(Some(toolchain), &["miri", "rust-src"])?;
    for run in RUNS {
        let mut command = Command::new("cargo");
        command
            .current_dir(process::root())
            .args([&plus, "miri", "test", "-q", "--target", TARGET])
            .args(run)
            // A tree of its own: another compiler, and flags that the others do not have.
            .env(
                "CARGO_TARGET_DIR",
                process::target_directory()?.join("miri"),
            )
            // The corpus and the properties are read from files.
            .env("MIRIFLAGS", "-Zmiri-disable-isolation")
            .env("PROPTEST_CASES", "2")
            .env_remove("RUSTFLAGS")
            .env_remove("RUSTC")
            .env_remove("RUSTUP_TOOLCHAIN")
            .env_remove("CARGO");
        process::run(command)?;
    }
    Ok(())
}
