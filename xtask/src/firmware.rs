//! The images: built, checked, run in the emulator.

use std::time::Duration;

use crate::defmt;
use crate::elf::Image;
use crate::process::Done;
use crate::process::{M0, M3, M4F, cargo};
use crate::quote::quote;

/// Options of the task.
#[derive(Default, clap::Args)]
pub struct Options {
    /// Only build and check, do not run.
    #[arg(long)]
    build_only: bool,
    /// Put the output into the documents that quote it.
    #[arg(long)]
    quote: bool,
}

/// Options of the processor in the loop.
#[derive(Default, clap::Args)]
pub struct PilOptions {
    /// Put the output into the documents that quote it.
    #[arg(long)]
    quote: bool,
}

/// Time after which a run in the emulator has failed.
const LIMIT: Duration = Duration::from_secs(300);

/// Builds all images and runs them.
pub fn run(options: &Options) -> Done {
    for (machine, profile) in [
        (M4F, "dev"),
        (M4F, "firmware"),
        (M3, "firmware"),
        (M0, "firmware"),
    ] {
        let path = machine.build("selftest", profile)?;
        not_empty(&Image::read(&path)?)?;
        if options.build_only {
            continue;
        }
        let mut text = format!(
            "selftest on {} ({}, {profile}):\n",
            machine.name, machine.target
        );
        for line in machine.lines(&path, LIMIT)? {
            text += &format!("    {line}\n");
        }
        print!("{text}");
        if options.quote && (machine.name, profile) == (M4F.name, "firmware") {
            quote("selftest", &fenced(&text))?;
        }
    }
    servo(options)
}

/// A block of program output in a document.
fn fenced(text: &str) -> String {
    format!("```text\n{text}```\n")
}

/// The servo controller on its simulated drive: it must reach control, and end in the safe output after three overruns.
fn servo(options: &Options) -> Done {
    let path = M4F.build("servo", "firmware")?;
    not_empty(&Image::read(&path)?)?;
    if options.build_only {
        return Ok(());
    }
    let mut text = format!("servo on {} ({}):\n", M4F.name, M4F.target);
    for line in defmt::lines(&path, &M4F.output(&path, LIMIT)?)? {
        text += &format!("    {line}\n");
    }
    print!("{text}");
    if options.quote {
        quote("servo", &fenced(&text))
    } else {
        Ok(())
    }
}

/// Runs of the processor in the loop: the step of a new axis, an axis that changes, and a bad line with a bad sensor.
const PIL: [&str; 3] = [
    "--scenario nominal --samples 4000",
    "--scenario mass --samples 11000",
    "--scenario nominal --samples 1500 --faults 10 --failures 700",
];

/// The processor in the loop.
pub fn pil(options: &PilOptions) -> Done {
    let image = M4F.build("pil", "firmware")?;
    let mut text = String::new();
    for extra in PIL {
        let mut command = cargo(&[
            "run",
            "-q",
            "--release",
            "-p",
            "trendid-cli",
            "--",
            "pil",
            "--image",
        ]);
        command
            .arg(&image)
            .args(extra.split(' '))
            .stderr(std::process::Stdio::inherit());
        let output = command
            .output()
            .map_err(|error| format!("cargo: {error}"))?;
        let printed = format!(
            "$ trendid pil {extra}\n{}",
            String::from_utf8_lossy(&output.stdout)
        );
        print!("{printed}");
        if !output.status.success() {
            return Err(format!("trendid pil ended with {}", output.status));
        }
        text += &printed;
    }
    if options.quote {
        quote("pil", &fenced(&text))
    } else {
        Ok(())
    }
}

/// An image without code is what lost linker arguments give.
fn not_empty(image: &Image) -> Done {
    if image.text == 0 {
        Err(".text is empty: linker arguments were lost; is RUSTFLAGS set?".into())
    } else {
        Ok(())
    }
}

/// Prints the sizes; fails when an image is empty, too large, or can panic in an update.
pub fn size() -> Done {
    let mut table = String::from(
        "| image | -O | code [B] | flash [B] | static RAM [B] |\n|---|---|---|---|---|\n",
    );
    let mut faults = Vec::new();
    for (profile, opt) in [("firmware", "3"), ("firmware-size", "s")] {
        for example in ["footprint", "icount"] {
            let image = Image::read(&M4F.build(example, profile)?)?;
            not_empty(&image)?;
            table += &format!(
                "| {example} | {opt} | {} | {} | {} |\n",
                image.text, image.flash, image.ram
            );
            let panics = |names: &[String]| -> Vec<String> {
                names
                    .iter()
                    .filter(|name| name.contains("panic"))
                    .cloned()
                    .collect()
            };
            if example == "footprint" {
                let found = panics(&image.names);
                if !found.is_empty() {
                    faults.push(format!(
                        "footprint (opt-level {opt}) contains {}",
                        found.join(", ")
                    ));
                }
                if image.text > BUDGET {
                    faults.push(format!(
                        "footprint (opt-level {opt}) has more than {BUDGET} bytes of code"
                    ));
                }
                continue;
            }
            // The image around the functions can panic: so a name that is looked for would be found.
            if panics(&image.names).is_empty() {
                faults.push(
                    "no panic is found in an image that has one: the search is broken".into(),
                );
            }
            let functions: Vec<_> = image
                .names
                .iter()
                .filter(|name| name.starts_with("row_"))
                .collect();
            if functions.is_empty() {
                faults.push("the image icount has no row".into());
            }
            for function in functions {
                let reach = image.reach(function)?;
                let found = panics(&reach.names);
                if !found.is_empty() {
                    faults.push(format!(
                        "{function} (opt-level {opt}) reaches {}",
                        found.join(", ")
                    ));
                }
                if reach.indirect {
                    faults.push(format!("{function} (opt-level {opt}) calls through a pointer: not all calls are known"));
                }
            }
        }
    }
    print!("{table}");
    if faults.is_empty() {
        quote("size", &table)
    } else {
        Err(faults.join("\n"))
    }
}

/// Code in bytes that the image with one update of three parameters may have.
const BUDGET: u64 = 6 * 1024;
