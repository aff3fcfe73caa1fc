//! The servo loop in RTIC and Embassy: packages of their own, checked, built, run in the emulator, held against the host.

use std::path::PathBuf;
use std::time::Duration;

use crate::elf::Image;
use crate::process::{self, Done, M4F, cargo};
use crate::{log, setup};

/// Time after which a run in the emulator has failed.
const LIMIT: Duration = Duration::from_secs(300);

/// What stands before the hash, on the host and on the target.
const MARK: &str = "hash of ";

/// The hash of the servo example on the host, with the number of its samples.
pub(crate) fn host_hash() -> Result<String, String> {
    let output = cargo(&["run", "-q", "-p", "trendid", "--example", "servo"])
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err(format!(
            "the servo example on the host ended with {}",
            output.status
        ));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    hash(text.lines()).ok_or_else(|| "the servo example on the host printed no hash".into())
}

/// The hash among the lines of a run.
fn hash<'a>(mut lines: impl Iterator<Item = &'a str>) -> Option<String> {
    lines.find_map(|line| Some(line[line.find(MARK)?..].trim_end().to_owned()))
}

/// A sentence that says that the lines of an image hold the hash of the host.
pub(crate) fn same_as_host(lines: &[String]) -> Result<String, String> {
    let expected = host_hash()?;
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

/// A package below `examples`, outside of the workspace.
struct Package(&'static str);

impl Package {
    fn directory(&self) -> PathBuf {
        process::root().join("examples").join(self.0)
    }

    /// A cargo command in it; what it builds is kept beside that of the workspace.
    fn cargo(&self, arguments: &[&str]) -> Result<std::process::Command, String> {
        let mut command = cargo(arguments);
        command.current_dir(self.directory()).env(
            "CARGO_TARGET_DIR",
            process::target_directory()?.join(self.0),
        );
        Ok(command)
    }

    /// Formatting and lints, with the features of each row.
    fn lint(&self, features: &[&str]) -> Done {
        process::run(self.cargo(&["fmt", "--check"])?)?;
        for set in features {
            process::run(self.cargo(&[
                "clippy",
                "-q",
                "--locked",
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
            "--locked",
            "--release",
            "--target",
            M4F.target,
            "--features",
            features,
            "--bin",
            name,
        ])?)?;
        let path = process::target_directory()?
            .join(self.0)
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
