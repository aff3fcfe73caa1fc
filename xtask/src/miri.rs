//! Undefined behaviour, by interpretation: the unit tests of what runs on a target, and the store.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::process::{self, Done, works};
use crate::{dated, tool};

/// libm has inline assembly for x86-64 and 64-bit ARM, which cannot be interpreted; this target has
/// none.
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
    /// Puts the results into docs/proofs.md, under the date and the commit.
    #[arg(long)]
    write: bool,
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
    let heading = dated::heading("miri")?;
    let mut table = String::from("| tests | passed | left out | seconds |\n|---|---|---|---|\n");
    for run in RUNS {
        let begin = Instant::now();
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
        let [passed, left] = counted(command)?;
        let seconds = begin.elapsed().as_secs();
        table += &format!("| `{}` | {passed} | {left} | {seconds} |\n", run.join(" "));
    }
    print!("{table}");
    if options.write {
        let compiler = Command::new("rustc").args([&plus, "--version"]).output();
        let compiler = compiler.map_err(|error| format!("rustc: {error}"))?;
        let compiler = String::from_utf8_lossy(&compiler.stdout);
        let body = format!("`cargo xtask miri`, {}\n\n{table}", compiler.trim());
        dated::add("docs/proofs.md", &heading, &body)?;
    }
    Ok(())
}

/// Runs tests with their output on the terminal; gives how many passed and how many were left out.
fn counted(mut command: Command) -> Result<[u32; 2], String> {
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("cargo miri: {error}"))?;
    let mut counts = [0; 2];
    let output = child.stdout.take().ok_or("no output of the tests")?;
    for line in BufReader::new(output).lines() {
        let line = line.map_err(|error| format!("cargo miri: {error}"))?;
        println!("{line}");
        for (count, found) in counts.iter_mut().zip(passed(&line)) {
            *count += found;
        }
    }
    let status = child.wait().map_err(|error| error.to_string())?;
    if status.success() {
        Ok(counts)
    } else {
        Err(format!("the tests ended with {status}"))
    }
}

/// Tests that passed and that were left out, by the last line of a program of tests.
fn passed(line: &str) -> [u32; 2] {
    let number = |word: &str| {
        let before = line
            .split(word)
            .next()
            .filter(|before| before.len() < line.len())?;
        before.rsplit(' ').next()?.parse().ok()
    };
    if line.starts_with("test result:") {
        [" passed", " ignored"].map(|word| number(word).unwrap_or(0))
    } else {
        [0; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_of_a_program_is_counted() {
        let line = "test result: ok. 106 passed; 0 failed; 7 ignored; 0 measured; 3 filtered out";
        assert_eq!(passed(line), [106, 7]);
        assert_eq!(passed("running 3 tests"), [0, 0]);
    }
}
