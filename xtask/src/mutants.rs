//! Does a test notice when a line of the core is wrong?

use std::path::PathBuf;

use crate::process::{Done, cargo, root, target_directory};
use crate::tool::Tool;

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Mutants that are drawn from all of them; every one without this.
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// Seed of the draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// The part K of N of the mutants or of the sample, K from 0.
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Only mutants in files whose path contains this.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
}

/// What is mutated, and the tests that are to notice.
const ROOMS: [(&str, &[&str]); 4] = [
    ("src/estimation/", &["--test", "core"]),
    ("src/readout/", &["--test", "core"]),
    ("src/identifier/", &["--test", "core"]),
    ("src/servo/", &["--test", "core", "--test", "servo"]),
];

/// Least share that must be caught.
const LEAST: f64 = 0.9;

/// Draws, runs, and reports per room with a confidence interval.
pub(crate) fn run(options: &Options) -> Done {
    Tool::named("mutants", "cargo-mutants").install()?;
    let mut failed = Vec::new();
    println!(
        "| room | drawn | caught | missed | unviable | caught [%] | 95 % interval |\n|---|---|---|---|---|---|---|"
    );
    let mut missed = Vec::new();
    for (room, tests) in ROOMS {
        let drawn = draw(&list(room)?, options)?;
        if drawn.is_empty() {
            continue;
        }
        let outcome = judge(room, &drawn, tests)?;
        let viable = outcome.caught + outcome.missed.len();
        let [low, high] = interval(outcome.caught, viable);
        println!(
            "| {room} | {} | {} | {} | {} | {:.0} | {:.0} to {:.0} |",
            drawn.len(),
            outcome.caught,
            outcome.missed.len(),
            outcome.unviable,
            100.0 * outcome.caught as f64 / viable.max(1) as f64,
            100.0 * low,
            100.0 * high
        );
        // Below the limit beyond doubt.
        if high < LEAST {
            failed.push(room);
        }
        missed.extend(outcome.missed);
    }
    println!("\nnot caught:");
    missed.iter().for_each(|name| println!("  {name}"));
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "less than 90 % are caught in {}",
            failed.join(", ")
        ))
    }
}

/// The names of all mutants of a room.
fn list(room: &str) -> Result<Vec<String>, String> {
    let output = cargo(&["mutants", "--list", "-p", "trendid", "-f"])
        .arg(format!("{room}**/*.rs"))
        .output()
        .map_err(|error| format!("cargo mutants: {error}"))?;
    let names = String::from_utf8_lossy(&output.stdout);
    Ok(names.lines().map(str::to_owned).collect())
}

/// Those that the options leave, in an order by chance.
fn draw(names: &[String], options: &Options) -> Result<Vec<String>, String> {
    let mut names: Vec<String> = names
        .iter()
        .filter(|name| {
            options.only.as_ref().is_none_or(|only| {
                name.split(':')
                    .next()
                    .is_some_and(|file| file.contains(only))
            })
        })
        .cloned()
        .collect();
    if let Some(count) = options.sample {
        // The order of a hash of name and seed is one by chance.
        names.sort_by_key(|name| hash(options.seed, name));
        names.truncate(count);
    }
    let Some(shard) = &options.shard else {
        return Ok(names);
    };
    let parts = shard
        .split_once('/')
        .and_then(|(k, n)| Some((k.parse::<usize>().ok()?, n.parse::<usize>().ok()?)));
    match parts {
        Some((k, n)) if k < n => Ok(names.into_iter().skip(k).step_by(n).collect()),
        _ => Err(format!("--shard is {shard}: expected K/N with K below N")),
    }
}

/// FNV-1a with a seed, mixed so that neighbours differ.
fn hash(seed: u64, name: &str) -> u64 {
    let start = 0xCBF2_9CE4_8422_2325 ^ seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let hash = name.bytes().fold(start, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3)
    });
    (hash ^ (hash >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9)
}

/// What became of the mutants.
struct Outcome {
    caught: usize,
    unviable: usize,
    missed: Vec<String>,
}

/// Lets cargo-mutants test exactly the drawn ones: with the unit tests of the core first, then with these host tests.
fn judge(room: &str, drawn: &[String], tests: &[&str]) -> Result<Outcome, String> {
    let place = output_directory()?.join(room.trim_matches('/').replace('/', "-"));
    // What is there is of an earlier run.
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", place.display()))?;
    let mut command = cargo(&[
        "mutants",
        "-p",
        "trendid",
        "--no-shuffle",
        "--colors",
        "never",
    ]);
    command
        .args(["--baseline", "skip", "--timeout", "3600"])
        .arg("--output")
        .arg(&place)
        .arg("-f")
        .arg(format!("{room}**/*.rs"));
    for name in drawn {
        command.arg("--re").arg(format!("^{}$", escaped(name)));
    }
    command
        .args([
            "--test-package",
            "trendid,trendid-host-tests",
            "--cargo-test-arg=--lib",
        ])
        .args(tests.iter().map(|test| format!("--cargo-test-arg={test}")))
        // Its copy of the tree is another one each time; what that depends on is built once, here as for every test.
        .env("CARGO_TARGET_DIR", target_directory()?);
    eprintln!("{} mutants of {room}", drawn.len());
    // Its code says that some were missed or took too long; what counts is the report.
    let status = command
        .current_dir(root())
        .stdout(std::process::Stdio::null())
        .status()
        .map_err(|error| format!("cargo mutants: {error}"))?;
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        return Err(format!("cargo mutants ended with {status}"));
    }
    let names = |file: &str| -> Vec<String> {
        let text = std::fs::read_to_string(place.join("mutants.out").join(file));
        let text = text.unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    };
    Ok(Outcome {
        caught: names("caught.txt").len() + names("timeout.txt").len(),
        unviable: names("unviable.txt").len(),
        missed: names("missed.txt"),
    })
}

fn output_directory() -> Result<PathBuf, String> {
    Ok(target_directory()?.join("mutants"))
}

/// A name as a regular expression for itself.
fn escaped(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        // Those that mean something else; `\<` and `\>` would be the ends of words.
        if r"\.+*?()|[]{}^$#&-~".contains(letter) {
            text.push('\\');
        }
        text.push(letter);
    }
    text
}

/// The interval of Wilson for `caught` of `viable`, 95 %.
fn interval(caught: usize, viable: usize) -> [f64; 2] {
    if viable == 0 {
        return [0.0, 1.0];
    }
    let (n, z) = (viable as f64, 1.96_f64);
    let share = caught as f64 / n;
    let scale = 1.0 / (1.0 + z * z / n);
    let middle = scale * (share + z * z / (2.0 * n));
    let half = scale * z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    [middle - half, middle + half]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_matches_itself_only() {
        assert_eq!(
            escaped("a.rs:1:2: replace < with == in f(x)"),
            r"a\.rs:1:2: replace < with == in f\(x\)"
        );
    }

    #[test]
    fn the_interval_of_wilson() {
        // 9 of 10: 0.596 to 0.982 (Wilson's formula, by hand).
        let [low, high] = interval(9, 10);
        assert!((low - 0.5958).abs() < 1e-3 && (high - 0.9821).abs() < 1e-3);
        assert_eq!(interval(0, 0), [0.0, 1.0]);
    }

    #[test]
    fn a_draw_is_the_same_each_time_and_shards_share_it_out() {
        let names: Vec<String> = (0..100).map(|k| format!("src/a.rs:{k}:1: x")).collect();
        let options = |shard: Option<&str>| Options {
            sample: Some(10),
            seed: 3,
            shard: shard.map(str::to_owned),
            only: None,
        };
        let all = draw(&names, &options(None)).unwrap();
        assert_eq!(all, draw(&names, &options(None)).unwrap());
        assert_ne!(all, names[..10]);
        let mut parts = Vec::new();
        for k in 0..3 {
            parts.extend(draw(&names, &options(Some(&format!("{k}/3")))).unwrap());
        }
        parts.sort();
        let mut all = all;
        all.sort();
        assert_eq!(parts, all);
        assert!(draw(&names, &options(Some("3/3"))).is_err());
    }
}
