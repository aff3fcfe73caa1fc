//! Pages of dated results: what a task printed, under date and commit, newest first.

use std::fs;
use std::process::Command;

use crate::process::{Done, root};

/// Puts a section on top of the dated ones of a page, under the heading of its begin.
pub(crate) fn add(page: &str, heading: &str, body: &str) -> Done {
    let section = format!("{heading}\n\n{}\n", body.trim_end());
    let text = read(page)?;
    let (head, tail) = text.split_at(begin(&text));
    write(page, &format!("{head}{section}\n{tail}"))
}

/// The heading of what begins now: date, commit, and `name`.
pub(crate) fn heading(name: &str) -> Result<String, String> {
    let date = shown("date", &["-u", "+%Y-%m-%d"])?;
    let commit = shown("git", &["rev-parse", "--short=10", "HEAD"])?;
    // The page itself changes with every result.
    let others = [
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
        ".",
        ":!docs",
    ];
    let changed = !shown("git", &others)?.is_empty();
    let changed = if changed { " with changes" } else { "" };
    Ok(format!("## {date}, commit {commit}{changed}, {name}"))
}

/// Where the dated sections begin.
fn begin(text: &str) -> usize {
    text.find("\n## 20").map_or(text.len(), |at| at + 1)
}

/// The rows of the tables of all sections whose heading contains `name`, as cells; newest first.
pub(crate) fn rows(page: &str, name: &str) -> Result<Vec<Vec<String>>, String> {
    let text = read(page)?;
    let mut rows = Vec::new();
    let mut wanted = false;
    for line in text[begin(&text)..].lines() {
        if line.starts_with("## ") {
            wanted = line.contains(name);
        } else if wanted && line.starts_with("| ") {
            let cells = line.trim_matches('|').split('|');
            rows.push(cells.map(|cell| cell.trim().to_owned()).collect());
        }
    }
    Ok(rows)
}

/// Replaces what stands below a heading, to the next one.
pub(crate) fn replace(page: &str, heading: &str, body: &str) -> Done {
    let text = read(page)?;
    let start = text
        .find(heading)
        .map(|at| at + heading.len())
        .ok_or_else(|| format!("{page} has no heading {heading}"))?;
    let end = text[start..]
        .find("\n## ")
        .map_or(text.len(), |at| start + at + 1);
    let (head, tail) = (&text[..start], &text[end..]);
    write(page, &format!("{head}\n\n{}\n\n{tail}", body.trim_end()))
}

fn read(page: &str) -> Result<String, String> {
    fs::read_to_string(root().join(page)).map_err(|error| format!("{page}: {error}"))
}

fn write(page: &str, text: &str) -> Done {
    fs::write(root().join(page), text).map_err(|error| format!("{page}: {error}"))
}

fn shown(program: &str, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(root())
        .output()
        .map_err(|error| format!("{program}: {error}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
