//! The images: built, checked, run in the emulator.

use std::time::Duration;

use crate::elf::Image;
use crate::process::{Done, M0, M3, M4F, Machine, cargo};
use crate::{frameworks, log};

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Only this one, on the Cortex-M4F.
    #[arg(value_enum)]
    program: Option<Program>,
    /// Only build and check, do not run.
    #[arg(long)]
    build_only: bool,
}

/// What runs in the emulator on its own.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Program {
    /// The hashes of the record.
    Selftest,
    /// The servo controller on its simulated drive.
    Servo,
}

/// Time after which a run in the emulator has failed.
const LIMIT: Duration = Duration::from_secs(300);

/// Builds all images and runs them; gives what they print.
pub(crate) fn run(options: &Options) -> Result<String, String> {
    let mut text = String::new();
    let machines: &[(Machine, &str)] = match options.program {
        None => &[
            (M4F, "dev"),
            (M4F, "firmware"),
            (M3, "firmware"),
            (M0, "firmware-size"), // the -O3 image exceeds its 256 KiB of flash
        ],
        Some(Program::Selftest) => &[(M4F, "firmware")],
        Some(Program::Servo) => &[],
    };
    for &(machine, profile) in machines {
        let path = machine.build("selftest", profile)?;
        not_empty(&Image::read(&path)?)?;
        if options.build_only {
            continue;
        }
        text += &format!(
            "selftest on {} ({}, {profile}):\n",
            machine.name, machine.target
        );
        text += &indented(machine.lines(&path, LIMIT)?);
    }
    if options.program != Some(Program::Selftest) {
        text += &servo(options.build_only)?;
    }
    Ok(text)
}

fn indented(lines: Vec<String>) -> String {
    lines.iter().map(|line| format!("    {line}\n")).collect()
}

/// Runs of the servo controller, by the word that its script knows (`examples/servo/emulated.rs`).
const SERVO: [&str; 6] = [
    "servo",
    "panic",
    "hardfault",
    "overflow",
    "idle-overflow",
    "lost-stack",
];

/// The servo controller on its simulated drive: it must reach control, end in the safe output after
/// three overruns, and report after a restart what ended the run before.
fn servo(build_only: bool) -> Result<String, String> {
    let path = M4F.build("servo", "firmware")?;
    not_empty(&Image::read(&path)?)?;
    let mut text = String::new();
    if build_only {
        return Ok(text);
    }
    for word in SERVO {
        let lines = log::lines(&path, &M4F.output(&path, word, LIMIT)?)?;
        // The first run is compared with the same loop on the host.
        let same = if word == "servo" {
            frameworks::same_as_host(&lines)?
        } else {
            String::new()
        };
        text += &format!(
            "{word} on {} ({}):\n{}{same}",
            M4F.name,
            M4F.target,
            indented(lines)
        );
    }
    Ok(text)
}

/// Runs of the processor in the loop: the step of a new axis, an axis that changes, and a bad line
/// with a bad sensor.
const PIL: [&str; 3] = [
    "--scenario nominal --samples 4000",
    "--scenario mass --samples 11000",
    "--scenario nominal --samples 2500 --faults 10 --failures 700",
];

/// The processor in the loop; gives what the runs print.
pub(crate) fn pil() -> Result<String, String> {
    let image = M4F.build("pil", "firmware")?;
    let mut text = String::new();
    for extra in PIL {
        let mut command = cargo(&["run", "-q", "--release", "-p", "trendid-cli", "--", "pil"]);
        command
            .arg("--image")
            .arg(&image)
            .args(extra.split(' '))
            .stderr(std::process::Stdio::inherit());
        let output = command
            .output()
            .map_err(|error| format!("cargo: {error}"))?;
        text += &format!(
            "$ trendid pil {extra}\n{}",
            String::from_utf8_lossy(&output.stdout)
        );
        if !output.status.success() {
            return Err(format!("{text}trendid pil ended with {}", output.status));
        }
    }
    Ok(text)
}

/// An image without code is what lost linker arguments give.
fn not_empty(image: &Image) -> Done {
    if image.text == 0 {
        Err(".text is empty: linker arguments were lost; is RUSTFLAGS set?".into())
    } else {
        Ok(())
    }
}

/// Code in bytes that the image with one update of three parameters may have, with the bounded
/// forgetting, the gates of rest, standstill and innovation, bridged gaps, filters that are
/// flushed, friction that holds the drive, changes that are followed, forgetting that waits for
/// information, slow states in two words, and the sums of how the record begins.
const BUDGET: u64 = 15 * 1024 + 512;

/// Images of which functions are called in the 1 ms path or on a byte of the line, and how the
/// names of these begin.
const CALLED: [(&str, &str); 2] = [("icount", "row_"), ("pil", "link_")];

/// The sizes; fails when an image is empty, too large, or can panic in an update or on a frame.
pub(crate) fn size() -> Result<String, String> {
    let mut table = String::from(
        "| image | -O | code [B] | flash [B] | static RAM [B] |\n|---|---|---|---|---|\n",
    );
    let mut faults = Vec::new();
    for (profile, opt) in [("firmware", "3"), ("firmware-size", "s")] {
        for example in ["footprint", "icount", "pil"] {
            let image = Image::read(&M4F.build(example, profile)?)?;
            not_empty(&image)?;
            table += &format!(
                "| {example} | {opt} | {} | {} | {} |\n",
                image.text, image.flash, image.ram
            );
            // In small code postcard's reading of an f32 keeps a check of its length, which cannot
            // fail.
            if (example, opt) == ("pil", "s") {
                continue;
            }
            let found = match CALLED.iter().find(|(name, _)| *name == example) {
                Some((_, prefix)) => reaching(&image, prefix)?,
                None => alone(&image),
            };
            faults.extend(
                found
                    .into_iter()
                    .map(|fault| format!("{example} (opt-level {opt}): {fault}")),
            );
        }
    }
    if faults.is_empty() {
        Ok(table)
    } else {
        Err(format!("{table}{}", faults.join("\n")))
    }
}

/// The names that belong to the panic machinery.
fn panics(names: &[String]) -> Vec<&str> {
    let names = names.iter().map(String::as_str);
    names.filter(|name| name.contains("panic")).collect()
}

/// Faults of an image that is nothing but an update.
fn alone(image: &Image) -> Vec<String> {
    let mut faults = Vec::new();
    let found = panics(&image.names);
    if !found.is_empty() {
        faults.push(format!("contains {}", found.join(", ")));
    }
    if image.text > BUDGET {
        faults.push(format!("has more than {BUDGET} bytes of code"));
    }
    faults
}

/// Faults of the functions of an image whose names begin with `prefix`.
fn reaching(image: &Image, prefix: &str) -> Result<Vec<String>, String> {
    let mut faults = Vec::new();
    // The image around the functions can panic: so a name that is looked for would be found.
    if panics(&image.names).is_empty() {
        faults.push("no panic is found in an image that has one: the search is broken".into());
    }
    let functions = || image.names.iter().filter(|name| name.starts_with(prefix));
    if functions().next().is_none() {
        faults.push(format!("has no function {prefix}*"));
    }
    for function in functions() {
        let reach = image.reach(function)?;
        let found = panics(&reach.names);
        if !found.is_empty() {
            faults.push(format!("{function} reaches {}", found.join(", ")));
        }
        if reach.indirect {
            faults.push(format!(
                "{function} calls through a pointer: not all calls are known"
            ));
        }
    }
    Ok(faults)
}
