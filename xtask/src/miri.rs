//! Undefined behaviour, by interpretation: the unit tests of what runs on a target, and the store.
//!
//! Each test by itself, within a limit of time: interpreted, it takes some ten thousand times as
//! long as run, and which ones are left out follows from the limit.

use std::process::{Command, Output};
use std::time::Instant;

use crate::process::{self, Done, works};
use crate::{dated, tool};

/// libm has inline assembly for x86-64 and 64-bit ARM, which cannot be interpreted; this target has
/// none.
const TARGET: &str = "riscv64gc-unknown-linux-gnu";

/// Packages and their tests: what has no simulated hours in it.
const RUNS: [&[&str]; 4] = [
    &["-p", "trendid", "--lib"],
    &["-p", "trendid-link", "--lib", "--tests"],
    &["-p", "trendid-example-support", "--lib"],
    &["-p", "trendid-fuzz", "--test", "corpus"],
];

/// The status of `timeout` for what took longer.
const TOO_LONG: i32 = 124;

/// Options of the task.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Toolchain with Miri, a nightly one.
    #[arg(long, value_name = "NAME", default_value = "nightly")]
    toolchain: String,
    /// Longest time of a test in seconds; it is left out when it takes longer.
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    limit: u32,
    /// Interprets the tests whose name contains this.
    #[arg(long, value_name = "PART", default_value = "")]
    only: String,
    /// Puts the results into docs/proofs.md, under the date and the commit.
    #[arg(long)]
    write: bool,
}

/// What became of the tests of a run.
#[derive(Default)]
struct Found {
    passed: u32,
    ignored: u32,
    too_long: u32,
    failed: Vec<String>,
}

/// Interprets the tests.
pub(crate) fn run(options: &Options) -> Done {
    let plus = format!("+{}", options.toolchain);
    if !works("rustc", &[&plus, "--version"]) {
        let mut command = Command::new("rustup");
        command.args(["toolchain", "install", "--profile", "minimal"]);
        command.arg(&options.toolchain);
        process::run(command)?;
    }
    tool::components(Some(&options.toolchain), &["miri", "rust-src"])?;
    let heading = dated::heading("miri")?;
    let mut table = format!(
        "| tests | passed | longer than {} s | ignored | seconds |\n|---|---|---|---|---|\n",
        options.limit
    );
    let mut failed = Vec::new();
    for run in RUNS {
        let begin = Instant::now();
        let found = interpreted(options, run)?;
        let Found {
            passed,
            too_long,
            ignored,
            ..
        } = found;
        let seconds = begin.elapsed().as_secs();
        let run = run.join(" ");
        table += &format!("| `{run}` | {passed} | {too_long} | {ignored} | {seconds} |\n");
        failed.extend(found.failed);
    }
    print!("{table}");
    if !failed.is_empty() {
        return Err(format!("failed: {}", failed.join(", ")));
    }
    if options.write {
        let compiler = Command::new("rustc").args([&plus, "--version"]).output();
        let compiler = compiler.map_err(|error| format!("rustc: {error}"))?;
        let compiler = String::from_utf8_lossy(&compiler.stdout);
        let body = format!("`cargo xtask miri`, {}\n\n{table}", compiler.trim());
        dated::add("docs/proofs.md", &heading, &body)?;
    }
    Ok(())
}

/// Runs the tests of a run, one after the other.
fn interpreted(options: &Options, run: &[&str]) -> Result<Found, String> {
    // Builds, without a limit.
    let list = output(options, None, run, &["--list", "--format", "terse"])?;
    if !list.status.success() {
        let errors = String::from_utf8_lossy(&list.stderr);
        return Err(format!("{} does not build: {errors}", run.join(" ")));
    }
    let list = String::from_utf8_lossy(&list.stdout);
    let names = list.lines().filter_map(|line| line.strip_suffix(": test"));
    let mut found = Found::default();
    for name in names.filter(|name| name.contains(&options.only)) {
        let output = output(options, Some(options.limit), run, &["--exact", name])?;
        let said = String::from_utf8_lossy(&output.stdout);
        let word = if output.status.code() == Some(TOO_LONG) {
            found.too_long += 1;
            "too long"
        } else if !output.status.success() {
            eprintln!("{said}{}", String::from_utf8_lossy(&output.stderr));
            found.failed.push(name.to_owned());
            "failed"
        } else if said.lines().any(has_passed) {
            found.passed += 1;
            "passed"
        } else {
            found.ignored += 1;
            "ignored"
        };
        println!("{name}: {word}");
    }
    Ok(found)
}

/// What the interpreter says of a run with these arguments for its tests.
fn output(
    options: &Options,
    limit: Option<u32>,
    run: &[&str],
    arguments: &[&str],
) -> Result<Output, String> {
    let mut command = match limit {
        Some(limit) => {
            let mut command = Command::new("timeout");
            command.args(["--kill-after=2", &limit.to_string(), "cargo"]);
            command
        }
        None => Command::new("cargo"),
    };
    command
        .current_dir(process::root())
        .arg(format!("+{}", options.toolchain))
        .args(["miri", "test", "-q", "--target", TARGET])
        .args(run)
        .arg("--")
        .args(arguments)
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
    let output = command.output();
    output.map_err(|error| format!("cargo miri: {error}"))
}

/// Whether the last line of a program of tests says that one passed.
fn has_passed(line: &str) -> bool {
    line.starts_with("test result: ok. 1 passed;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_of_a_program_is_read() {
        let line = "test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 3 filtered out";
        assert!(has_passed(line));
        assert!(!has_passed(&line.replace("1 passed", "0 passed")));
        assert!(!has_passed("running 1 test"));
    }
}
