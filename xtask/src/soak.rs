//! Simulated hours of the identifier and of the loop.

use std::process::Stdio;

use crate::dated;
use crate::process::{Done, as_typed, cargo};

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Simulated seconds of each scenario of the identifier and of each axis of the loop; a day
    /// has 86400.
    #[arg(long, value_name = "S", default_value_t = SHORT)]
    seconds: u32,
    /// Only scenarios of the identifier whose name contains this, and no axis.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Only scenarios of the identifier with this memory in s, or "none", and no axis.
    #[arg(long, value_name = "S")]
    memory: Option<String>,
    /// Only the axes of the loop.
    #[arg(long, conflicts_with_all = ["only", "memory", "first_seed"])]
    axes: bool,
    /// Seed of the first run of the table of the identifier, for other draws than those of before.
    #[arg(long, value_name = "N")]
    first_seed: Option<String>,
    /// Puts the results into docs/soak.md, under the date and the commit.
    #[arg(long)]
    write: bool,
}

/// A million samples of each: minutes on two cores.
const SHORT: u32 = 1000;

const PAGE: &str = "docs/soak.md";

/// What continuous integration runs, 20 minutes of the loop on each axis; the identifier has a
/// million samples of each scenario in a test.
pub(crate) fn of_every_change() -> Done {
    run(&Options {
        seconds: 1200,
        axes: true,
        ..Options::default()
    })
}

/// Runs every scenario of `trendid endurance` and a working day of the loop, each on all cores;
/// fails when either does.
pub(crate) fn run(options: &Options) -> Done {
    let seconds = options.seconds.to_string();
    let mut endurance = vec!["endurance", "--seconds", &seconds];
    let chosen = [
        ("--only", &options.only),
        ("--memory", &options.memory),
        ("--first-seed", &options.first_seed),
    ];
    for (name, value) in chosen {
        endurance.extend(value.iter().flat_map(|value| [name, value]));
    }
    let program = ["run", "-q", "--release", "-p", "trendid-cli", "--"];
    let heading = dated::heading(&format!("{} s", options.seconds))?;
    let mut parts = Vec::new();
    if !options.axes {
        parts.push(part("trendid", &program, &endurance)?);
    }
    if options.only.is_none() && options.memory.is_none() {
        let example = [
            "run",
            "-q",
            "--release",
            "-p",
            "trendid-host-tests",
            "--example",
            "working_day",
            "--",
        ];
        parts.push(part("working_day", &example, &[&seconds])?);
    }
    if options.write {
        write(&heading, &parts)?;
    }
    let failed: Vec<_> = parts
        .iter()
        .filter_map(|part| part.failed.as_deref())
        .collect();
    if failed.is_empty() {
        Ok(())
    } else {
        Err(failed.join("; "))
    }
}

/// A command, what it printed, and how it failed.
struct Part {
    command: String,
    text: String,
    failed: Option<String>,
}

fn part(name: &str, program: &[&str], arguments: &[&str]) -> Result<Part, String> {
    let command = format!("{name} {}", as_typed(arguments));
    eprintln!("$ {command}");
    let output = cargo(&[program, arguments].concat())
        .stderr(Stdio::piped())
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    print!("{text}");
    let failed = (!output.status.success()).then(|| {
        let errors = String::from_utf8_lossy(&output.stderr);
        let last = errors.lines().last().unwrap_or_default();
        eprintln!("{last}");
        format!("{command} ended with {}", output.status)
    });
    Ok(Part {
        command,
        text,
        failed,
    })
}

/// Puts a section on top of those before it: of the long tables the rows that break a limit, and
/// the last line.
fn write(heading: &str, parts: &[Part]) -> Done {
    let shown = |part: &Part| format!("`{}`\n\n{}", part.command, shortened(&part.text));
    let parts: Vec<_> = parts.iter().map(shown).collect();
    dated::add(PAGE, heading, &parts.join("\n\n"))
}

/// Rows of a table that keep their limits are counted, not shown.
fn shortened(text: &str) -> String {
    let kept = text
        .lines()
        .filter(|line| line.ends_with("| kept |"))
        .count();
    let mut short: Vec<_> = text
        .lines()
        .filter(|line| !line.ends_with("| kept |"))
        .map(str::to_owned)
        .collect();
    if kept > 0 {
        short.push(format!("{kept} of them keep every limit."));
    }
    short.join("\n") + "\n"
}
