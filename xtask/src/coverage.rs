//! Which lines of the core its tests run.

use std::path::{Path, PathBuf};

use crate::process::{self, Done, cargo};
use crate::tool::{self, Tool};

/// Least share of the lines of `src/` in percent.
const LEAST: f64 = 95.0;

/// The tests: unit tests and the two suites of the core and of the loop. The long claims are left
/// out.
const TESTS: [&str; 10] = [
    "-p",
    "trendid",
    "-p",
    "trendid-host-tests",
    "--features",
    "trendid-host-tests/thorough",
    "--lib",
    "--tests",
    "--no-fail-fast",
    "--quiet",
];

/// Prints every file of the core below the limit, with the lines that no test runs; fails when the
/// whole is below.
pub(crate) fn run() -> Done {
    Tool::named("llvm-cov", "cargo-llvm-cov").install()?;
    tool::components(None, &["llvm-tools"])?;
    let measured = |arguments: &[&str]| {
        let mut command = cargo(&[&["llvm-cov"], arguments].concat());
        command.env("CARGO_TARGET_DIR", target()?);
        Ok::<_, String>(command)
    };
    let mut command = measured(&["--no-report", "--release"])?;
    command.args(TESTS);
    process::run(command)?;
    let output = measured(&["report", "--release", "--lcov"])?
        .output()
        .map_err(|error| format!("cargo llvm-cov: {error}"))?;
    judge(&String::from_utf8_lossy(&output.stdout))
}

fn target() -> Result<PathBuf, String> {
    Ok(process::target_directory()?.join("coverage"))
}

/// One file of the core: its lines with code, and those that were never run.
#[derive(Debug, PartialEq)]
struct File {
    name: String,
    lines: usize,
    missed: Vec<usize>,
}

/// The lines of the core in a report.
fn judge(report: &str) -> Done {
    let root = process::root().join("src");
    let files = files(report, &root, |name| {
        std::fs::read_to_string(root.join(name)).unwrap_or_default()
    });
    let lines: usize = files.iter().map(|file| file.lines).sum();
    let missed: usize = files.iter().map(|file| file.missed.len()).sum();
    if lines == 0 {
        return Err("no line of the core was measured".into());
    }
    println!("| file | lines | not run |\n|---|---|---|");
    for File {
        name,
        lines,
        missed,
    } in &files
    {
        if !missed.is_empty() {
            let missed: Vec<_> = missed.iter().map(usize::to_string).collect();
            println!("| {name} | {lines} | {} |", missed.join(" "));
        }
    }
    let share = 100.0 * (lines - missed) as f64 / lines as f64;
    println!(
        "\n{} of {lines} lines of src/ are run: {share:.1} %",
        lines - missed
    );
    if share < LEAST {
        return Err(format!("{share:.1} % of the lines, expected {LEAST} %"));
    }
    Ok(())
}

/// The files below `root` in a report of lcov, without their test modules.
fn files(report: &str, root: &Path, source: impl Fn(&str) -> String) -> Vec<File> {
    let mut files: Vec<File> = Vec::new();
    let mut end = 0;
    for line in report.lines() {
        if let Some(path) = line.strip_prefix("SF:") {
            let below = Path::new(path).strip_prefix(root).ok();
            let name = below.map_or(String::new(), |name| name.to_string_lossy().into_owned());
            end = source(&name)
                .lines()
                .position(|line| line == "#[cfg(test)]")
                .unwrap_or(usize::MAX);
            files.push(File {
                name,
                lines: 0,
                missed: Vec::new(),
            });
        } else if let Some(data) = line.strip_prefix("DA:")
            && let Some((number, count)) = data.split_once(',')
            && let (Ok(number), Some(file)) = (number.parse::<usize>(), files.last_mut())
            && number <= end
        {
            file.lines += 1;
            if count.starts_with("0") {
                file.missed.push(number);
            }
        }
    }
    files.retain(|file| !file.name.is_empty());
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_core_are_counted_without_their_tests() {
        let report =
            "SF:/w/src/a.rs\nDA:1,5\nDA:2,0\nDA:9,0\nend_of_record\nSF:/w/other/b.rs\nDA:1,0\n";
        let source = |_: &str| "a\nb\nc\n#[cfg(test)]\nmod tests {}\n".to_owned();
        let expected = File {
            name: "a.rs".into(),
            lines: 2,
            missed: vec![2],
        };
        assert_eq!(files(report, Path::new("/w/src"), source), [expected]);
    }
}
