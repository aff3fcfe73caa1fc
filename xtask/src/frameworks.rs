//! The servo loop in RTIC and Embassy: packages of their own, checked, built, run in the emulator,
//! held against the host.

use std::path::PathBuf;
use std::time::Duration;

use crate::elf::Image;
use crate::process::{self, Done, M4F, cargo};
use crate::{log, setup};

/// Time after which a run in the emulator has failed.
const LIMIT: Duration = Duration::from_secs(300);

/// What stands before the hash, on the host and on the target.
const MARK: &str = "hash of ";

/// Samples of the hash; later requests are of no effect on it.
const COMPARED: u64 = 4000;

/// What stands before a request of the servo example on the host.
const REQUEST: &str = "request: ";

/// What the servo example prints on the host.
fn host() -> Result<String, String> {
    let output = cargo(&["run", "-q", "-p", "trendid", "--example", "servo"])
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!(
            "the servo example on the host ended with {}",
            output.status
        ))
    }
}

/// The hash among the lines of a run, with the number of its samples.
fn hash<'a>(mut lines: impl Iterator<Item = &'a str>) -> Option<String> {
    lines.find_map(|line| Some(line[line.find(MARK)?..].trim_end().to_owned()))
}

/// A sentence that says that the lines of an image hold the hash of the host.
pub(crate) fn same_as_host(lines: &[String]) -> Result<String, String> {
    compared(lines, &host()?)
}

fn compared(lines: &[String], host: &str) -> Result<String, String> {
    let expected = hash(host.lines()).ok_or("the servo example on the host printed no hash")?;
    let found = hash(lines.iter().map(String::as_str));
    if found.as_ref() == Some(&expected) {
        Ok("same hash as the servo example on the host\n".into())
    } else {
        Err(format!(
            "{}\nthe image has {}, the servo example on the host {expected}",
            lines.join("\n"),
            found.as_deref().unwrap_or("no hash")
        ))
    }
}

/// Where the packages are built, below the target directory: what they share is built once.
const PLACE: &str = "frameworks";

/// A package below `examples`, outside of the workspace.
struct Package(&'static str);

impl Package {
    fn directory(&self) -> PathBuf {
        process::root().join("examples").join(self.0)
    }

    /// A cargo command in it; what it builds is kept apart from the workspace's.
    fn cargo(&self, arguments: &[&str]) -> Result<std::process::Command, String> {
        let mut command = cargo(arguments);
        command
            .current_dir(self.directory())
            .env("CARGO_TARGET_DIR", process::target_directory()?.join(PLACE));
        Ok(command)
    }

    /// Formatting and lints, with the features of each row.
    fn lint(&self, features: &[&str]) -> Done {
        process::run(self.cargo(&["fmt", "--check"])?)?;
        for set in features {
            process::run(self.cargo(&[
                "clippy",
                "-q",
                "--release",
                "--target",
                M4F.target,
                "--features",
                set,
                "--",
                "-D",
                "warnings",
            ])?)?;
        }
        Ok(())
    }

    /// Builds its image `name` and gives path and sizes.
    fn build(&self, name: &str, features: &str) -> Result<(PathBuf, String), String> {
        process::run(self.cargo(&[
            "build",
            "-q",
            "--release",
            "--target",
            M4F.target,
            "--features",
            features,
            "--bin",
            name,
        ])?)?;
        let path = process::target_directory()?
            .join(PLACE)
            .join(M4F.target)
            .join("release")
            .join(name);
        let image = Image::read(&path)?;
        if image.text == 0 {
            return Err(format!("{}: .text is empty", path.display()));
        }
        let sizes = format!(
            "{name}: code {} B, flash {} B, static RAM {} B\n",
            image.text, image.flash, image.ram
        );
        Ok((path, sizes))
    }
}

/// RTIC 2: its log comes as frames of defmt over semihosting.
pub(crate) fn rtic() -> Result<String, String> {
    setup::run()?;
    let package = Package("rtic");
    package.lint(&[""])?;
    let (image, mut text) = package.build("trendid-example-rtic", "")?;
    let lines = log::lines(&image, &M4F.output(&image, "", LIMIT)?)?;
    for line in &lines {
        text += &format!("    {line}\n");
    }
    text += &same_as_host(&lines)?;
    Ok(text)
}

/// Embassy: requests go over the serial line as the servo example on the host made them, and the
/// log comes back over it.
pub(crate) fn embassy() -> Result<String, String> {
    setup::run()?;
    let package = Package("embassy");
    package.lint(&["emulated", "board"])?;
    let (_, board) = package.build("board", "board")?;
    let (image, emulated) = package.build("emulated", "emulated")?;
    let host = host()?;
    let mut requests = String::from("never\n");
    for line in host.lines().filter_map(|line| line.strip_prefix(REQUEST)) {
        let tick = line.split(' ').next().and_then(|tick| tick.parse().ok());
        if tick.is_some_and(|tick: u64| tick <= COMPARED) {
            requests += &format!("{line}\n");
        }
    }
    let output = M4F.talk(&image, requests.into_bytes(), LIMIT)?;
    let text = String::from_utf8_lossy(&output);
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if !lines.iter().any(|line| line == "not heard: never") {
        return Err(format!(
            "{text}\na line that is no request was not answered"
        ));
    }
    let mut report = board + &emulated;
    for line in &lines {
        report += &format!("    {line}\n");
    }
    Ok(report + &compared(&lines, &host)?)
}
