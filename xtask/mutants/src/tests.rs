//! The tests, one process each: which mutants a test reaches, and which of them it notices.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::tree::Program;

/// One test without a mutant.
#[derive(Clone, Debug)]
pub(crate) struct Test {
    /// Its program, as a place in their list.
    pub program: usize,
    /// Its name there.
    pub name: String,
    /// How long it took.
    pub time: Duration,
    /// The mutants that it asked for.
    pub reached: BTreeSet<u32>,
}

/// What the tests say of a mutant.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// A test failed, or did not end.
    Caught(String),
    /// All tests that reach it pass.
    Missed,
    /// No test comes there at run time.
    Unreached,
}

/// Longest that a mutant may take: so much, and so many times what the test takes without one.
const PATIENCE: Duration = Duration::from_secs(20);
const TIMES: u32 = 20;

/// The tests of all programs that end within `longest`, those first that take least; and how many
/// do not.
pub(crate) fn record(
    programs: &[Program],
    jobs: usize,
    longest: Duration,
    scratch: &Path,
) -> Result<(Vec<Test>, usize), String> {
    let mut names = Vec::new();
    for (program, at) in programs.iter().zip(0..) {
        let all = list(program, &[])?;
        let ignored: BTreeSet<String> = list(program, &["--ignored"])?.into_iter().collect();
        let run = all.into_iter().filter(|name| !ignored.contains(name));
        names.extend(run.map(|name| (at, name)));
    }
    let found: Vec<Result<Option<Test>, String>> = side_by_side(jobs, names.len(), |k| {
        let (program, name) = &names[k];
        let file = scratch.join(format!("reached-{k}"));
        // Of an earlier run, or none.
        let _ = std::fs::remove_file(&file);
        let mut command = command(&programs[*program], name);
        command.env("TRENDID_REACHED", &file);
        let begin = Instant::now();
        let passed = passes(command, longest);
        let time = begin.elapsed();
        if !passed && time >= longest {
            return Ok(None);
        }
        if !passed {
            return Err(format!("{name} fails without a mutant"));
        }
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        Ok(Some(Test {
            program: *program,
            name: name.clone(),
            time,
            reached: text.lines().filter_map(|line| line.parse().ok()).collect(),
        }))
    });
    let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
    let all = found.len();
    let mut tests: Vec<Test> = found.into_iter().flatten().collect();
    tests.sort_by_key(|test| test.time);
    let left = all - tests.len();
    Ok((tests, left))
}

/// Runs the tests that reach a mutant with it, to the first that notices.
pub(crate) fn judge(programs: &[Program], tests: &[Test], mutant: u32) -> Verdict {
    let mut verdict = Verdict::Unreached;
    for test in tests.iter().filter(|test| test.reached.contains(&mutant)) {
        verdict = Verdict::Missed;
        let mut command = command(&programs[test.program], &test.name);
        command.env("TRENDID_MUTANT", mutant.to_string());
        if !passes(command, PATIENCE + TIMES * test.time) {
            return Verdict::Caught(test.name.clone());
        }
    }
    verdict
}

/// `count` results by several threads, in their order.
pub(crate) fn side_by_side<R: Send>(
    jobs: usize,
    count: usize,
    work: impl Fn(usize) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    if k >= count {
                        break;
                    }
                    let result = work(k);
                    done.lock().expect("no thread panics").push((k, result));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("no thread panics");
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}

fn list(program: &Program, more: &[&str]) -> Result<Vec<String>, String> {
    let output = Command::new(&program.path)
        .args(["--list", "--format", "terse"])
        .args(more)
        .current_dir(&program.directory)
        .output()
        .map_err(|error| format!("{}: {error}", program.path.display()))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let names = text.lines().filter_map(|line| line.strip_suffix(": test"));
    Ok(names.map(str::to_owned).collect())
}

fn command(program: &Program, test: &str) -> Command {
    let mut command = Command::new(&program.path);
    command
        .args([test, "--exact", "--quiet", "--test-threads", "1"])
        .current_dir(&program.directory)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        // The threads are those of this program.
        .env("RAYON_NUM_THREADS", "1");
    command
}

/// Whether a test ends well within its time.
fn passes(mut command: Command, limit: Duration) -> bool {
    let Ok(mut child) = command.spawn() else {
        return false;
    };
    let begin = Instant::now();
    let mut pause = Duration::from_micros(500);
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) if begin.elapsed() < limit => {
                std::thread::sleep(pause);
                pause = (pause * 3 / 2).min(Duration::from_millis(20));
            }
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                return false;
            }
        }
    }
}
