//! libFuzzer on the targets in `fuzz/`, with a stable compiler.
//!
//! The flags are those that cargo-fuzz gives without a sanitizer: the coverage of LLVM is a pass
//! that stable compilers have, and overflow checks and debug assertions find what a sanitizer would
//! in code without `unsafe`. `cargo fuzz run TARGET` finds the same targets.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::dated;
use crate::process::{self, Done, cargo, root, target_directory};

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Only this target.
    target: Option<String>,
    /// Executions of each target.
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    runs: u64,
    /// Ends a target after so many seconds, too; 0 never.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seconds: u64,
    /// Seed of the fuzzer; 0 takes another one each time.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u32,
    /// Puts the results into docs/proofs.md, under the date and the commit, and adds up those
    /// before.
    #[arg(long)]
    write: bool,
    /// Keeps what was found in the corpus, without what covers nothing new.
    #[arg(long)]
    keep: bool,
}

/// A target and its longest input in bytes: some dozen calls, so that the time goes into many
/// executions.
const TARGETS: [(&str, u32); 6] = [
    ("identifier", 120),
    ("servo_loop", 80),
    ("link", 160),
    ("store", 200),
    ("record", 160),
    ("drivers", 120),
];

const FLAGS: [&str; 9] = [
    "--cfg=fuzzing",
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Ccodegen-units=1",
    "-Cdebug-assertions",
    "-Coverflow-checks",
];

/// Builds and runs the targets; prints how many executions each had.
pub(crate) fn run(options: &Options) -> Done {
    let wanted = |name: &str| {
        options
            .target
            .as_deref()
            .is_none_or(|target| target == name)
    };
    if !TARGETS.iter().any(|(name, _)| wanted(name)) {
        let names: Vec<_> = TARGETS.iter().map(|(name, _)| *name).collect();
        return Err(format!("no such target; there are {}", names.join(", ")));
    }
    let heading = dated::heading("fuzz")?;
    let programs = build()?;
    println!("{HEAD}");
    let mut rows = String::new();
    for (name, length) in TARGETS {
        if wanted(name) {
            let row = fuzz(&programs.join(name), name, length, options)?;
            println!("{row}");
            rows += &format!("{row}\n");
        }
    }
    if options.write {
        dated::add(PAGE, &heading, &format!("{HEAD}\n{rows}"))?;
        sum()?;
    }
    Ok(())
}

const PAGE: &str = "docs/proofs.md";
const HEAD: &str =
    "| target | seed | executions | seconds | edges | inputs found |\n|---|---|---|---|---|---|";

/// Executions of each target in all sections of the page.
fn sum() -> Done {
    let rows = dated::rows(PAGE, ", fuzz")?;
    let mut table = String::from("| target | runs | executions |\n|---|---|---|\n");
    for (name, _) in TARGETS {
        let rows = rows.iter().filter(|row| row[0] == name);
        let executions: Vec<u64> = rows.filter_map(|row| row.get(2)?.parse().ok()).collect();
        let (runs, all) = (executions.len(), executions.iter().sum::<u64>());
        table += &format!("| {name} | {runs} | {all} |\n");
    }
    dated::replace(PAGE, "## Executions of the fuzzer, all runs below", &table)
}

/// Builds every target; gives where they are.
fn build() -> Result<PathBuf, String> {
    let directory = target_directory()?.join("fuzz");
    let host = host()?;
    let mut command = cargo(&["build", "-q", "--release", "-p", "trendid-fuzz", "--bins"]);
    // With a target, macros and build scripts of the host are built without the flags.
    command
        .args(["--target", &host, "--target-dir"])
        .arg(&directory)
        .env("CARGO_ENCODED_RUSTFLAGS", FLAGS.join("\x1f"));
    process::run(command)?;
    Ok(directory.join(host).join("release"))
}

/// The target of this compiler.
fn host() -> Result<String, String> {
    let output = Command::new("rustc")
        .arg("-vV")
        .output()
        .map_err(|error| format!("rustc: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines()
        .find_map(|line| line.strip_prefix("host: "))
        .map(str::to_owned)
        .ok_or_else(|| "rustc names no host".to_owned())
}

/// Runs one target on its corpus; what it finds goes to a directory of its own.
///
/// What earlier runs found is where it begins, so that a long run may be one of many pieces.
fn fuzz(program: &Path, name: &str, length: u32, options: &Options) -> Result<String, String> {
    let corpus = root().join("fuzz/corpus").join(name);
    let found = target_directory()?.join("fuzz/found").join(name);
    let crashes = target_directory()?.join("fuzz/crashes").join(name);
    for place in [&found, &crashes] {
        fs::create_dir_all(place).map_err(|error| format!("{}: {error}", place.display()))?;
    }
    let start = Instant::now();
    let output = Command::new(program)
        .args([&found, &corpus])
        .arg(format!("-runs={}", options.runs))
        .arg(format!("-max_total_time={}", options.seconds))
        .arg(format!("-seed={}", options.seed))
        .arg(format!("-max_len={length}"))
        .arg(format!("-artifact_prefix={}/", crashes.display()))
        .args(["-print_final_stats=1", "-timeout=20", "-rss_limit_mb=1024"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .map_err(|error| format!("{}: {error}", program.display()))?;
    let text = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let last: Vec<_> = text.lines().rev().take(30).collect();
        let last: Vec<_> = last.into_iter().rev().collect();
        return Err(format!(
            "{name}: {}\n(the input is in {}; again: cargo run -p trendid-fuzz --bin {name} FILE)",
            last.join("\n"),
            crashes.display()
        ));
    }
    let number = |key: &str| {
        text.lines()
            .find_map(|line| line.strip_prefix(key))
            .map_or("?", str::trim)
            .to_owned()
    };
    let edges = text
        .lines()
        .rev()
        .find_map(|line| line.split("cov: ").nth(1)?.split(' ').next())
        .unwrap_or("?");
    let row = format!(
        "| {name} | {} | {} | {:.0} | {edges} | {} |",
        options.seed,
        number("stat::number_of_executed_units:"),
        start.elapsed().as_secs_f64(),
        count(&found)
    );
    if options.keep {
        merge(program, &corpus, &found, length)?;
    }
    Ok(row)
}

/// Takes what covers more into the corpus.
fn merge(program: &Path, corpus: &Path, found: &Path, length: u32) -> Done {
    let mut command = Command::new(program);
    command
        .args(["-merge=1", &format!("-max_len={length}")])
        .args([corpus, found])
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    process::run(command)
}

fn count(directory: &Path) -> usize {
    fs::read_dir(directory).map_or(0, Iterator::count)
}
