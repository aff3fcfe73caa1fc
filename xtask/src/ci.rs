//! The steps of continuous integration.

use std::time::Instant;

use crate::process::Done;
use crate::process::{self, M0, M4F, cargo};
use crate::{firmware, icount, setup};

/// The examples that are firmware; the others need an operating system.
const FIRMWARE_EXAMPLES: [&str; 5] = ["selftest", "icount", "footprint", "servo", "pil"];

/// A step and the name of its task.
type Step = (&'static str, fn() -> Done);

fn steps(steps: &[Step]) -> Done {
    let begin = Instant::now();
    for (name, step) in steps {
        let start = Instant::now();
        println!("== {name}");
        step().map_err(|error| format!("{name}: {error}\n(repeat with `cargo xtask {name}`)"))?;
        println!("== {name}: done in {:.0} s", start.elapsed().as_secs_f64());
    }
    println!("== all done in {:.0} s", begin.elapsed().as_secs_f64());
    Ok(())
}

/// Every step.
pub fn all() -> Done {
    steps(&[
        ("setup", setup::run),
        ("lint", lint),
        ("host", host),
        ("doc", doc),
        ("features", features),
        ("firmware", || firmware::run(&firmware::Options::default())),
        ("icount", || icount::run(&icount::Options::default())),
        ("size", firmware::size),
        ("pil", || firmware::pil(&firmware::PilOptions::default())),
    ])
}

/// Set-up and all tests.
pub fn test() -> Done {
    steps(&[
        ("setup", setup::run),
        ("host", host),
        ("firmware", || firmware::run(&firmware::Options::default())),
        ("size", firmware::size),
        ("pil", || firmware::pil(&firmware::PilOptions::default())),
    ])
}

/// Formatting and lints.
pub fn lint() -> Done {
    process::run(cargo(&["fmt", "--all", "--check"]))?;
    process::run(cargo(&[
        "clippy",
        "-q",
        "--workspace",
        "--all-targets",
        "--all-features",
        "--",
        "-D",
        "warnings",
    ]))?;
    // The targets have no test crate, so --all-targets is not for them.
    let mut arguments = vec![
        "clippy", "-q", "-p", "trendid", "--target", M4F.target, "--lib",
    ];
    arguments.extend(
        FIRMWARE_EXAMPLES
            .iter()
            .flat_map(|example| ["--example", example]),
    );
    arguments.extend(["--", "-D", "warnings"]);
    process::run(cargo(&arguments))
}

/// Tests on the host.
pub fn host() -> Done {
    process::run(cargo(&["test", "-q", "--workspace", "--all-features"]))?;
    process::run(cargo(&["test", "-q", "--workspace", "--release"]))
}

/// Documentation.
pub fn doc() -> Done {
    // Warnings of rustdoc; the variable of its own leaves the linker arguments alone.
    let mut command = cargo(&["doc", "-q", "--workspace", "--no-deps", "--all-features"]);
    command.env("RUSTDOCFLAGS", "-D warnings");
    process::run(command)
}

/// The core without and with its feature, on the host and for both ends of the Cortex-M line.
pub fn features() -> Done {
    let sets: [&[&str]; 2] = [&["--no-default-features"], &["--all-features"]];
    for set in sets {
        process::run(cargo(
            &[
                &["clippy", "-q", "-p", "trendid", "--lib"],
                set,
                &["--", "-D", "warnings"],
            ]
            .concat(),
        ))?;
        for target in [M4F.target, M0.target] {
            process::run(cargo(
                &[
                    &["build", "-q", "-p", "trendid", "--lib", "--target", target],
                    set,
                ]
                .concat(),
            ))?;
        }
    }
    Ok(())
}
