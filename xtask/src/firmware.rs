//! The images: built, checked, run in the emulator.

use std::time::Duration;

use crate::Done;
use crate::defmt::Table;
use crate::elf::Image;
use crate::process::{M0, M3, M4F};

/// Options of the task.
#[derive(Default, clap::Args)]
pub struct Options {
    /// Only build and check, do not run.
    #[arg(long)]
    build_only: bool,
}

/// Time after which a run in the emulator has failed.
const LIMIT: Duration = Duration::from_secs(120);

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
        println!(
            "selftest on {} ({}, {profile}):",
            machine.name, machine.target
        );
        for line in machine.lines(&path, LIMIT)? {
            println!("    {line}");
        }
    }
    servo(options)
}

/// The servo controller on its simulated drive: it must reach control, and end in the safe output after three overruns.
fn servo(options: &Options) -> Done {
    let path = M4F.build("servo", "firmware")?;
    not_empty(&Image::read(&path)?)?;
    if options.build_only {
        return Ok(());
    }
    println!("servo on {} ({}):", M4F.name, M4F.target);
    let table = Table::read(&path)?;
    for line in table.lines(&M4F.output(&path, LIMIT)?)? {
        println!("    {line}");
    }
    Ok(())
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
    println!(
        "| image | opt-level | code [B] | flash [B] | static RAM [B] |\n|---|---|---|---|---|"
    );
    let mut faults = Vec::new();
    for (profile, opt) in [("firmware", "3"), ("firmware-size", "s")] {
        for example in ["footprint", "icount"] {
            let image = Image::read(&M4F.build(example, profile)?)?;
            not_empty(&image)?;
            println!(
                "| {example} | {opt} | {} | {} | {} |",
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
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults.join("\n"))
    }
}

/// Code in bytes that the image with one update of three parameters may have.
const BUDGET: u64 = 6 * 1024;
