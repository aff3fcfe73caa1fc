//! What a document quotes stands between two marks, is never typed, and is what its command prints
//! today.
//!
//! ```text
//! <!-- run KIND[, long][, near]: COMMAND -->
//! ..
//! <!-- end -->
//! ```
//!
//! KIND is `text` (a block of program output) or `markdown` (as it is). COMMAND is `trendid ..` or
//! `cargo xtask ..`. `long` takes minutes and is left out without `--long`. `near` has figures that
//! another compiler changes: numbers may differ by two per cent. Pictures that a command draws by
//! `--plot DIRECTORY` are compared byte for byte.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Instant;

use crate::process::{self, Done, cargo, root, target_directory};
use crate::quote::{difference, replaced};
use crate::{golden, printed, quote};

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Write what the commands print now, instead of comparing; NAME is a part of a document's path
    /// or of a command.
    ///
    /// With the name of a reference file (examples/data/selftest.txt, examples/data/servo.bin,
    /// docs/icount.json) this file: the numbers that the self-test and the counts are measured
    /// against change on purpose only.
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = "")]
    write: Option<String>,
    /// The blocks that take minutes, too.
    #[arg(long)]
    long: bool,
}

/// Compares or writes.
pub(crate) fn run(options: &Options) -> Done {
    let name = options.write.as_deref().unwrap_or_default();
    if !name.is_empty() && golden::write(name)? {
        return Ok(());
    }
    golden::check()?;
    process::run(cargo(&["build", "-q", "--release", "-p", "trendid-cli"]))?;
    let (mut faults, mut done, mut left) = (Vec::new(), 0, 0);
    for path in documents()? {
        let old = read(&path)?;
        let document = shown(&path);
        let mut renewed = |mark: &quote::Mark<'_>, old: &str| {
            if !(document.contains(name) || mark.command.contains(name)) {
                return Ok(None);
            }
            if mark.long && !options.long && name.is_empty() {
                left += 1;
                return Ok(None);
            }
            done += 1;
            let start = Instant::now();
            let new = mark.quoted(&output(mark.command, options.write.is_some())?);
            let seconds = start.elapsed().as_secs_f64();
            println!("{document}: {} ({seconds:.0} s)", mark.command);
            if options.write.is_none()
                && let Some(difference) = difference(old, &new, mark.near)
            {
                let command = mark.command;
                faults.push(format!("{document}: {command}\n{difference}"));
            }
            if options.write.is_some() {
                put(&path, mark, &new)?;
            }
            Ok(None)
        };
        replaced(&old, &mut renewed).map_err(|error| format!("{document}: {error}"))?;
    }
    println!("{done} blocks are up to date or written, {left} long ones left out (`--long`)");
    if faults.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "{}\n(`cargo xtask docs --write [NAME]` renews)",
            faults.join("\n")
        ))
    }
}

/// Puts a block into its page at once: the blocks behind it may take an hour, or fail.
fn put(path: &Path, mark: &quote::Mark<'_>, new: &str) -> Done {
    let old = read(path)?;
    let text = replaced(&old, &mut |other, _| {
        Ok((other == mark).then(|| new.to_owned()))
    })?;
    if text == old {
        return Ok(());
    }
    fs::write(path, text).map_err(|error| format!("{}: {error}", shown(path)))
}

/// Every page.
fn documents() -> Result<Vec<PathBuf>, String> {
    let mut paths = Vec::new();
    for directory in [root(), root().join("docs")] {
        let entries = fs::read_dir(&directory).map_err(|error| error.to_string())?;
        paths.extend(entries.filter_map(|entry| Some(entry.ok()?.path())));
    }
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.sort();
    Ok(paths)
}

/// A path below the root, for messages.
fn shown(path: &Path) -> String {
    let below = path.strip_prefix(root()).unwrap_or(path);
    below.to_string_lossy().into_owned()
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", shown(path)))
}

/// What a command prints.
fn output(command: &str, write: bool) -> Result<String, String> {
    let words: Vec<_> = command.split_whitespace().collect();
    match words[..] {
        ["cargo", "xtask", ..] => printed::text(&words[1..]),
        ["trendid", ref arguments @ ..] => trendid(arguments, write),
        _ => Err(format!("neither trendid nor a task: {command}")),
    }
    .map_err(|error| format!("{command}: {error}"))
}

/// Runs the command line in the root; without `write`, pictures go elsewhere and are compared.
fn trendid(arguments: &[&str], write: bool) -> Result<String, String> {
    let mut words: Vec<_> = arguments.iter().map(|&word| word.to_owned()).collect();
    let plot = arguments.iter().position(|&word| word == "--plot");
    let mut pictures = None;
    if let Some(place) = plot.and_then(|at| words.get_mut(at + 1))
        && !write
    {
        let other = target_directory()?.join("docs");
        fs::create_dir_all(&other).map_err(|error| error.to_string())?;
        let kept = std::mem::replace(place, other.to_string_lossy().into_owned());
        pictures = Some((other, kept));
    }
    let output = std::process::Command::new(target_directory()?.join("release/trendid"))
        .args(&words)
        .current_dir(root())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(format!("ended with {}", output.status));
    }
    let text = String::from_utf8(output.stdout).map_err(|error| error.to_string())?;
    let Some((new, kept)) = pictures else {
        return Ok(text);
    };
    same_files(&new, &root().join(&kept))?;
    // The command names the file that it wrote.
    Ok(text.replace(&*new.to_string_lossy(), &kept))
}

/// Every file of `new` is in `kept`, byte for byte; empties `new`.
fn same_files(new: &Path, kept: &Path) -> Done {
    for entry in fs::read_dir(new).map_err(|error| error.to_string())? {
        let path = entry.map_err(|error| error.to_string())?.path();
        let other = kept.join(path.file_name().unwrap_or_default());
        let same = fs::read(&path).ok() == fs::read(&other).ok();
        fs::remove_file(&path).map_err(|error| error.to_string())?;
        if !same {
            return Err(format!("{} is another picture now", shown(&other)));
        }
    }
    Ok(())
}
