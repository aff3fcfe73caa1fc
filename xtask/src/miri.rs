//! Undefined behaviour, by interpretation: the unit tests of what runs on a target, and the store.
//!
//! One after the other, each within a limit of time: interpreted, a test takes some ten thousand
//! times as long as run, and which ones are left out follows from the limit. What takes longer is
//! ended, and the others go on in another run.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

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

/// Time for the build, and for the interpreter to begin.
const BUILD: Duration = Duration::from_secs(900);

/// Options of the task.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Toolchain with Miri, a nightly one.
    #[arg(long, value_name = "NAME", default_value = "nightly")]
    toolchain: String,
    /// Longest time of a test in seconds; it is left out when it takes longer.
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    limit: u64,
    /// Interprets the tests whose name contains this; the name of a package means all of its tests.
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
    let only = options.only.as_str();
    let of_a_package = RUNS.iter().any(|run| run.contains(&only));
    for run in RUNS {
        let part = match (of_a_package, run.contains(&only)) {
            (true, true) => "",
            (true, false) => continue,
            (false, _) => only,
        };
        let begin = Instant::now();
        let found = interpreted(options, run, part)?;
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
        let only = match only {
            "" => String::new(),
            only => format!(" --only {only}"),
        };
        let body = format!(
            "`cargo xtask miri --limit {}{only}`, {}\n\n{table}",
            options.limit,
            compiler.trim()
        );
        dated::add("docs/proofs.md", &heading, &body)?;
    }
    Ok(())
}

/// Runs the tests of a run whose name contains `part`.
fn interpreted(options: &Options, run: &[&str], part: &str) -> Result<Found, String> {
    let list = command(options, run, &["--list", "--format", "terse"])?.output();
    let list = list.map_err(|error| format!("cargo miri: {error}"))?;
    if !list.status.success() {
        let errors = String::from_utf8_lossy(&list.stderr);
        return Err(format!("{} does not build: {errors}", run.join(" ")));
    }
    let list = String::from_utf8_lossy(&list.stdout);
    let names = list.lines().filter_map(|line| line.strip_suffix(": test"));
    let names = names.filter(|name| name.contains(part));
    let mut left: Vec<String> = names.map(str::to_owned).collect();
    let mut found = Found::default();
    while !left.is_empty() {
        let mut arguments = vec!["--test-threads=1", "--exact"];
        arguments.extend(left.iter().map(String::as_str));
        let mut command = command(options, run, &arguments)?;
        in_a_group(&mut command);
        let mut child = command
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("cargo miri: {error}"))?;
        let before = left.len();
        followed(&lines(&mut child)?, options.limit, &mut left, &mut found);
        end(&mut child);
        if left.len() == before {
            // The interpreter has said why: undefined behaviour ends it.
            return Err(format!("{}: ended within {}", run.join(" "), left[0]));
        }
    }
    Ok(found)
}

/// Takes what ended from the tests that are left, up to the first that takes too long, or fails.
fn followed(lines: &Receiver<String>, limit: u64, left: &mut Vec<String>, found: &mut Found) {
    let mut patience = BUILD;
    loop {
        let line = match lines.recv_timeout(patience) {
            Ok(line) => line,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                println!("{}: too long", left.remove(0));
                found.too_long += 1;
                return;
            }
        };
        if line.starts_with("running ") {
            patience = Duration::from_secs(limit);
        }
        let Some((name, word)) = ended(&line) else {
            continue;
        };
        println!("{name}: {word}");
        left.retain(|other| other != name);
        match word {
            "ok" => found.passed += 1,
            "FAILED" => found.failed.push(name.to_owned()),
            _ => found.ignored += 1,
        }
        if left.is_empty() {
            return;
        }
    }
}

/// What a program prints, line by line.
fn lines(child: &mut Child) -> Result<Receiver<String>, String> {
    let output = child.stdout.take().ok_or("no output of the tests")?;
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    Ok(receiver)
}

/// Puts a program into a group with all that it starts, where the system has groups.
fn in_a_group(command: &mut Command) {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(not(unix))]
    let _ = command;
}

/// Ends a program and all that it has started.
fn end(child: &mut Child) {
    let group = format!("-{}", child.id());
    let _ = works("kill", &["-KILL", "--", &group]);
    let _ = child.kill();
    let _ = child.wait();
}

/// The interpreter over the tests of a run.
fn command(options: &Options, run: &[&str], arguments: &[&str]) -> Result<Command, String> {
    let mut command = Command::new("cargo");
    command
        .current_dir(process::root())
        .arg(format!("+{}", options.toolchain))
        .args(["miri", "test", "--target", TARGET])
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
    Ok(command)
}

/// Name and end of a test, by its line.
fn ended(line: &str) -> Option<(&str, &str)> {
    let (name, word) = line.strip_prefix("test ")?.split_once(" ... ")?;
    // Behind the word stands a reason or a time.
    let word = word.split([' ', ',']).next()?;
    let name = name
        .split_once(" - should panic")
        .map_or(name, |(name, _)| name);
    Some((name, word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_a_test_tells_its_end() {
        assert_eq!(ended("test a::b ... ok"), Some(("a::b", "ok")));
        assert_eq!(ended("test a ... ignored, long"), Some(("a", "ignored")));
        let panics = "test a - should panic ... FAILED";
        assert_eq!(ended(panics), Some(("a", "FAILED")));
        assert_eq!(ended("test result: ok. 1 passed; 0 failed"), None);
        assert_eq!(ended("running 1 test"), None);
    }

    #[test]
    fn what_says_nothing_in_time_is_left_out_and_the_others_go_on() {
        let (sender, receiver) = mpsc::channel();
        let mut left: Vec<String> = ["a", "b", "c"].map(str::to_owned).into();
        let mut found = Found::default();
        for line in ["running 3 tests", "test a ... ok"] {
            sender.send(line.to_owned()).unwrap();
        }
        followed(&receiver, 0, &mut left, &mut found);
        assert_eq!(
            (left, found.passed, found.too_long),
            (vec!["c".to_owned()], 1, 1)
        );
    }
}
