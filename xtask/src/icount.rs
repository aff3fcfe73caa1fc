//! The table of instruction counts.

use std::fmt::Write;
use std::sync::OnceLock;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::elf::Image;
use crate::process::{Done, M0, M3, M4F, Machine, root};

/// The counts that growth is measured against.
pub(crate) const BASELINE: &str = "docs/icount.json";

/// Rows of the short table, with their number of parameters.
const BRIEF: [(&str, u32); 6] = [
    ("filtered Tustin", 3),
    ("default", 5),
    ("default with memory", 5),
    ("whole position loop", 6),
    ("bare estimator", 5),
    ("bare, bounded at rest", 5),
];

/// Mean and worst case that a row at -O3 must not exceed.
const LIMITS: [(&str, u32, [f64; 2]); 4] = [
    ("default with memory", 5, [720.0, 850.0]),
    ("default, debt called in", 5, [720.0, 850.0]),
    ("whole position loop", 6, [f64::INFINITY, 4000.0]),
    ("position loop, one load", 6, [f64::INFINITY, 4000.0]),
];

/// Mean of the recursion with its covariance bounded over that without, and its worst case over its
/// mean.
const BOUNDED: [f64; 2] = [2.1, 1.5];

/// Mean instructions of recursive least squares of so many parameters on the full covariance
/// matrix, by the `ArxRls` of PX4 on the same core: what the bounded recursion must stay below.
const FULL_MATRIX: [(u32, f64); 4] = [(3, 184.0), (4, 378.0), (5, 765.0), (6, 1195.0)];

/// Growth of the mean or of the worst case that fails, as a factor.
const GROWTH: f64 = 1.02;

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Print JSON: an array of {row, n, mean, worst, text, ram, stack, opt}.
    #[arg(long)]
    json: bool,
    /// Only the rows of the front page.
    #[arg(long, conflicts_with = "json")]
    brief: bool,
    /// Count on Cortex-M3 and Cortex-M0, without floating-point unit (by SysTick, 40 to 63
    /// instructions per tick); compares nothing.
    #[arg(long, conflicts_with_all = ["json", "brief"])]
    soft: bool,
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    row: String,
    n: u32,
    mean: f64,
    worst: f64,
    text: u64,
    ram: u64,
    stack: u64,
    opt: String,
}

/// Counts and compares; gives the table.
pub(crate) fn run(options: &Options) -> Result<String, String> {
    if options.soft {
        return soft();
    }
    let rows = rows()?;
    let text = std::fs::read_to_string(root().join(BASELINE))
        .map_err(|error| format!("{BASELINE}: {error}"))?;
    let before: Vec<Row> =
        serde_json::from_str(&text).map_err(|error| format!("{BASELINE}: {error}"))?;
    compare(&before, &rows).map_err(|error| {
        format!("{error}(`cargo xtask docs --write {BASELINE}` takes the new counts)")
    })?;
    within(&rows)?;
    if options.json {
        json(&rows)
    } else if options.brief {
        let brief = |row: &&Row| row.opt == "3" && BRIEF.contains(&(row.row.as_str(), row.n));
        Ok(markdown(
            &rows.iter().filter(brief).cloned().collect::<Vec<_>>(),
        ))
    } else {
        Ok(markdown(&rows))
    }
}

/// What [`BASELINE`] holds after a change on purpose.
pub(crate) fn baseline() -> Result<String, String> {
    json(&rows()?)
}

/// Every row on the Cortex-M4F, counted once per process.
fn rows() -> Result<Vec<Row>, String> {
    static ROWS: OnceLock<Result<Vec<Row>, String>> = OnceLock::new();
    let count = || {
        let mut rows = count(M4F, "firmware", "3")?;
        rows.extend(count(M4F, "firmware-size", "s")?);
        Ok(rows)
    };
    ROWS.get_or_init(count).clone()
}

/// The tables of the cores without floating-point unit.
fn soft() -> Result<String, String> {
    let mut text = String::new();
    for (machine, core) in [(M3, "Cortex-M3"), (M0, "Cortex-M0")] {
        let table = markdown(&count(machine, "firmware", "3")?);
        let _ = writeln!(
            text,
            "{core} (`{}`), floating point in software:\n\n{table}",
            machine.name
        );
    }
    Ok(text)
}

/// Runs the image on a machine and joins its counts with the sizes in the ELF.
fn count(machine: Machine, profile: &str, opt: &str) -> Result<Vec<Row>, String> {
    let path = machine.build("icount", profile)?;
    let image = Image::read(&path)?;
    let mut rows = Vec::new();
    for line in machine.lines(&path, Duration::from_secs(300))? {
        if line.starts_with('#') {
            eprintln!("{line}");
            continue;
        }
        let fields: Vec<_> = line.split(';').collect();
        let [row, function, n, mean, worst, _systick, stack, ram] = fields[..] else {
            return Err(format!("a line of the image is not understood: {line}"));
        };
        let number = |field: &str| {
            field
                .parse::<f64>()
                .map_err(|_| format!("no number in: {line}"))
        };
        rows.push(Row {
            row: row.to_owned(),
            n: number(n)? as u32,
            mean: number(mean)?,
            worst: number(worst)?,
            text: image.reach(function)?.text,
            ram: number(ram)? as u64,
            stack: number(stack)? as u64,
            opt: opt.to_owned(),
        });
    }
    if rows.is_empty() {
        Err("the image printed no row".into())
    } else {
        Ok(rows)
    }
}

/// Every row of `before` must be there and no more than [`GROWTH`] above.
fn compare(before: &[Row], now: &[Row]) -> Done {
    let mut faults = String::new();
    for old in before {
        let name = format!("{} (n = {}, opt-level {})", old.row, old.n, old.opt);
        let Some(new) = now
            .iter()
            .find(|new| (&new.row, new.n, &new.opt) == (&old.row, old.n, &old.opt))
        else {
            let _ = writeln!(faults, "{name}: the row is gone");
            continue;
        };
        for (what, new, old) in [
            ("mean", new.mean, old.mean),
            ("worst", new.worst, old.worst),
        ] {
            if new > old * GROWTH {
                let _ = writeln!(faults, "{name}: {what} {new} instructions, {old} before");
            }
        }
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "more than {:.0} % growth:\n{faults}",
            (GROWTH - 1.0) * 100.0
        ))
    }
}

/// Every limit of a row, and what it costs to keep the covariance bounded.
fn within(rows: &[Row]) -> Done {
    let find = |name: &str, n: u32| {
        let row = rows
            .iter()
            .find(|row| (row.row.as_str(), row.n, row.opt.as_str()) == (name, n, "3"));
        row.ok_or_else(|| format!("{name} (n = {n}): no such row"))
    };
    let mut faults = String::new();
    let mut check = |what: String, found: f64, limit: f64| {
        if !(found <= limit) {
            let _ = writeln!(faults, "{what}: {found:.2} of {limit}");
        }
    };
    for (name, n, [mean, worst]) in LIMITS {
        let row = find(name, n)?;
        check(format!("{name}, mean"), row.mean, mean);
        check(format!("{name}, worst"), row.worst, worst);
    }
    for (n, full) in FULL_MATRIX {
        let (bare, bounded) = (
            find("bare estimator", n)?,
            find("bare, bounded at rest", n)?,
        );
        let [dearer, uneven] = BOUNDED;
        check(
            format!("bounded, n = {n}, over bare"),
            bounded.mean / bare.mean,
            dearer,
        );
        check(
            format!("bounded, n = {n}, worst over mean"),
            bounded.worst / bounded.mean,
            uneven,
        );
        check(format!("bounded, n = {n}, mean"), bounded.mean, full);
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(format!("above a limit:\n{faults}"))
    }
}

fn markdown(rows: &[Row]) -> String {
    let mut table = String::from(
        "| row | n | -O | mean | worst | text [B] | RAM [B] | stack [B] |\n|---|---|---|---|---|---|---|---|\n",
    );
    for Row {
        row,
        n,
        mean,
        worst,
        text,
        ram,
        stack,
        opt,
    } in rows
    {
        let _ = writeln!(
            table,
            "| {row} | {n} | {opt} | {mean:.0} | {worst:.0} | {text} | {ram} | {stack} |"
        );
    }
    table
}

fn json(rows: &[Row]) -> Result<String, String> {
    serde_json::to_string_pretty(rows)
        .map(|text| text + "\n")
        .map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests;
