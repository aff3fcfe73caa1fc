//! Tasks of the project: `cargo xtask --help`.
//!
//! The steps of continuous integration are these tasks under these names, so that what fails there
//! is repeated here.

mod browser;
mod capi;
mod ci;
mod coverage;
mod dated;
mod deny;
mod docs;
mod edges;
mod elf;
mod firmware;
mod frameworks;
mod fuzz;
mod golden;
mod icount;
mod log;
mod miri;
mod msrv;
mod mutants;
mod printed;
mod process;
mod python;
mod quote;
mod record;
mod rtt;
mod setup;
mod soak;
mod table;
mod tool;
mod watch;
mod web;
mod workflow;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

/// Tasks of the project. On a fresh machine: `cargo xtask test`.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Adds what is missing: thumb targets by rustup, qemu-system-arm by apt where it may; else
    /// says what to install.
    Setup,
    /// Sets up, then runs every test, on the host and on the emulated targets; what takes long is
    /// in `statistics`.
    Test,
    /// Formatting and lints, on the host and on the target.
    Lint,
    /// The tests on the host.
    Host,
    /// The documentation, with warnings as errors.
    Doc,
    /// What the documents quote: compares it with what the commands print now, or writes it.
    Docs(docs::Options),
    /// Each feature of the core alone, none and all; the core for Cortex-M4F and Cortex-M0.
    Features,
    /// Every package with the oldest compiler that is promised.
    Msrv(msrv::Options),
    /// What would be published, built from the package.
    Package,
    #[command(flatten)]
    Printed(printed::Task),
    /// The Python package: wheel, tests in a fresh environment, types, and the page that is
    /// executed.
    Python(python::Options),
    /// The claims that need hundreds of runs.
    Statistics,
    /// Monitor and playground driven in a headless browser; installs what is missing.
    Browser,
    /// Telemetry of the firmware over RTT, through the memory of the emulator.
    Rtt,
    /// The firmware in the emulator, watched on a page: rates, losses, memory, redraws.
    Watch(watch::Options),
    /// Simulated hours of the identifier and of the loop.
    Soak(soak::Options),
    /// The workflow of continuous integration, by actionlint; its tasks are those of this program.
    Workflow,
    /// libFuzzer on every target of `fuzz/`, with a stable compiler.
    Fuzz(fuzz::Options),
    /// Undefined behaviour in the tests of core, link, support and store, by interpretation (needs
    /// a nightly compiler).
    Miri(miri::Options),
    /// Which lines of the core the tests run: 95 % at least.
    Coverage,
    /// Whether a test notices when a line of the core is wrong: 90 % at least.
    Mutants(mutants::Options),
    /// Licences, sources and versions of the dependencies, against `deny.toml`.
    Deny(deny::Options),
    /// Dependencies that nobody uses.
    Machete,
    /// Whether a published package breaks its users, against the last release.
    Semver,
    /// The MEX function in GNU Octave, against Rust.
    Octave,
    /// Units of FMI 2.0 of identifier and loop, validated and simulated by FMPy, against Rust.
    Fmu,
    /// What the core is linked from, one after another: capi, octave, fmu, rtic, embassy, python.
    Edges,
    /// Every test and check of `.ci/run`.
    Ci,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().task {
        Task::Setup => setup::run(),
        Task::Test => ci::test(),
        Task::Lint => ci::lint(),
        Task::Host => ci::host(),
        Task::Doc => ci::doc(),
        Task::Docs(options) => docs::run(&options),
        Task::Features => ci::features(),
        Task::Msrv(options) => msrv::run(&options),
        Task::Python(options) => python::run(&options),
        Task::Package => ci::package(),
        Task::Printed(task) => task.print(),
        Task::Statistics => ci::statistics(),
        Task::Browser => browser::run(),
        Task::Rtt => rtt::run(),
        Task::Watch(options) => watch::run(&options),
        Task::Soak(options) => soak::run(&options),
        Task::Workflow => {
            let command = Arguments::command();
            let names = command.get_subcommands().map(|task| task.get_name());
            workflow::run(&names.map(str::to_owned).collect())
        }
        Task::Fuzz(options) => fuzz::run(&options),
        Task::Miri(options) => miri::run(&options),
        Task::Coverage => coverage::run(),
        Task::Mutants(options) => mutants::run(&options),
        Task::Deny(options) => deny::deny(&options),
        Task::Machete => deny::machete(),
        Task::Semver => ci::semver(),
        Task::Octave => edges::octave(),
        Task::Fmu => edges::fmu(),
        Task::Edges => ci::edges(),
        Task::Ci => ci::all(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("error: {sentence}");
            ExitCode::FAILURE
        }
    }
}
