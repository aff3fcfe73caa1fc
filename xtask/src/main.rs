//! Tasks of the project: `cargo xtask --help`.
//!
//! The steps of continuous integration are these tasks under these names, so that what fails there is repeated here.

mod ci;
mod defmt;
mod elf;
mod firmware;
mod icount;
mod process;
mod quote;
mod record;
mod setup;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Tasks of the project. On a fresh machine: `cargo xtask test`.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Adds what is missing: thumb targets by rustup, qemu-system-arm by apt where it may; else says what to install.
    Setup,
    /// Sets up, then runs every test, on the host and on the emulated targets.
    Test,
    /// Formatting and lints, on the host and on the target.
    Lint,
    /// The tests on the host, in debug and release.
    Host,
    /// The documentation, with warnings as errors.
    Doc,
    /// Each feature of the core alone, none and all; the core for Cortex-M4F and Cortex-M0.
    Features,
    /// Builds the firmware images, checks them and runs them in the emulator.
    Firmware(firmware::Options),
    /// Instructions per update on the emulated Cortex-M4F, with code size, memory and stack.
    Icount(icount::Options),
    /// Code size of the images; no panic may be reachable from an update.
    Size,
    /// The controller on the emulated target against the simulated plant on the host, bit for bit.
    Pil(firmware::PilOptions),
    /// Everything above.
    Ci,
    /// Writes the record of the self-test again (the same bytes on every machine).
    Record,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().task {
        Task::Setup => setup::run(),
        Task::Test => ci::test(),
        Task::Lint => ci::lint(),
        Task::Host => ci::host(),
        Task::Doc => ci::doc(),
        Task::Features => ci::features(),
        Task::Firmware(options) => firmware::run(&options),
        Task::Icount(options) => icount::run(&options),
        Task::Size => firmware::size(),
        Task::Pil(options) => firmware::pil(&options),
        Task::Ci => ci::all(),
        Task::Record => record::write(&process::root()).map_err(|error| error.to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("error: {sentence}");
            ExitCode::FAILURE
        }
    }
}
