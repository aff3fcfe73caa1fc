//! The steps of continuous integration.

use std::time::Instant;

use crate::printed::Task;
use crate::process::{self, Done, M0, M4F, cargo};
use crate::{deny, docs, edges, python, setup, soak};

/// The examples that are firmware; the others need an operating system.
const FIRMWARE_EXAMPLES: [&str; 5] = ["selftest", "icount", "footprint", "servo", "pil"];

/// What is published.
const PUBLISHED: [&str; 3] = ["trendid", "trendid-link", "trendid-identify"];

/// Built by the step that needs it alone: its dependencies take longer than all others.
const DECODER: &str = "trendid-log";

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

/// The steps of the tests.
const TESTS: [Step; 5] = [
    ("setup", setup::run),
    ("host", host),
    ("firmware", || Task::Firmware(Default::default()).print()),
    ("size", || Task::Size.print()),
    ("pil", || Task::Pil.print()),
];

/// What is checked beside the tests.
const CHECKS: [Step; 6] = [
    ("lint", lint),
    ("doc", doc),
    ("features", features),
    ("package", package),
    ("icount", || Task::Icount(Default::default()).print()),
    ("docs", || docs::run(&docs::Options::default())),
];

/// The edges: every other language and framework that the core is linked from.
const EDGES: [Step; 6] = [
    ("capi", || Task::Capi(Default::default()).print()),
    ("octave", edges::octave),
    ("fmu", edges::fmu),
    ("rtic", || Task::Rtic.print()),
    ("embassy", || Task::Embassy.print()),
    ("python", || python::run(&python::Options::default())),
];

/// All edges, each with a line of what it took.
pub(crate) fn edges() -> Done {
    steps(&EDGES)
}

/// Every step but the long ones.
pub(crate) fn all() -> Done {
    steps(&TESTS)?;
    steps(&CHECKS)
}

/// Set-up and all tests.
pub(crate) fn test() -> Done {
    steps(&TESTS)
}

/// The claims over hundreds of seeds and over hours; those about records of real drives where
/// `TRENDID_RECORDS` names their directory.
pub(crate) fn statistics() -> Done {
    let arguments = [
        "test",
        "-q",
        "--release",
        "-p",
        "trendid-host-tests",
        "-p",
        "trendid-cli",
        // What is ignored without it runs in `host`.
        "--features",
        "trendid-host-tests/thorough,trendid-cli/thorough",
    ];
    let mut command = cargo(&arguments);
    command.args(["--no-fail-fast", "--", "--ignored"]);
    if std::env::var_os("TRENDID_RECORDS").is_none() {
        eprintln!("without the records of real drives: TRENDID_RECORDS names no directory");
        command.args(["--skip", "records::", "--skip", "records_spread::"]);
    }
    process::run(command)?;
    soak::of_every_change()
}

/// Formatting and lints.
pub(crate) fn lint() -> Done {
    process::run(cargo(&["fmt", "--all", "--check"]))?;
    process::run(cargo(&[
        "clippy",
        "-q",
        "--workspace",
        "--exclude",
        DECODER,
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

/// Tests on the host, the thorough ones too: with overflow checks, and the bits of the self-test as
/// the optimiser makes them, too.
pub(crate) fn host() -> Done {
    process::run(cargo(&[
        "test",
        "-q",
        "--workspace",
        "--exclude",
        DECODER,
        "--all-features",
    ]))?;
    process::run(cargo(&["test", "-q", "--release", "--example", "selftest"]))
}

/// Packs and builds what is published.
///
/// In a directory of its own every time: cargo keeps the packages of an earlier run by their path
/// and version, and would build one package against another's past.
pub(crate) fn package() -> Done {
    let place = process::target_directory()?.join(format!("packages-{}", std::process::id()));
    let mut command = cargo(&["package", "-q", "--allow-dirty", "--target-dir"]);
    command.arg(&place);
    command.args(PUBLISHED.iter().flat_map(|name| ["-p", name]));
    let done = process::run(command);
    // What is left is only room on the disk.
    let _ = std::fs::remove_dir_all(&place);
    done
}

/// What is published, against its last release.
pub(crate) fn semver() -> Done {
    deny::semver(&PUBLISHED)
}

/// Documentation.
pub(crate) fn doc() -> Done {
    // Warnings of rustdoc; the variable of its own leaves the linker arguments alone.
    let mut command = cargo(&["doc", "-q", "--workspace", "--no-deps", "--all-features"]);
    command.env("RUSTDOCFLAGS", "-D warnings");
    process::run(command)
}

/// The core without and with its feature, on the host and for both ends of the Cortex-M line.
pub(crate) fn features() -> Done {
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
