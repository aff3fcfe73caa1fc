//! The tasks whose output documents quote.

use clap::{Parser, Subcommand};

use crate::{capi, firmware, frameworks, icount, table, web};

/// A task that gives text.
#[derive(Subcommand)]
pub(crate) enum Task {
    /// Builds the firmware images, checks them and runs them in the emulator.
    Firmware(firmware::Options),
    /// Instructions per update on the emulated Cortex-M4F, with code size, memory and stack.
    Icount(icount::Options),
    /// Code size of the images; no panic may be reachable from an update or from a frame.
    Size,
    /// The controller on the emulated target against the simulated plant on the host, bit for bit.
    Pil,
    /// The servo loop in RTIC 2, in the emulator; the same hash as on the host.
    Rtic,
    /// The C interface: header, no panic, the example on host and target against Rust, instructions
    /// over the edge.
    Capi(capi::Options),
    /// The servo loop in Embassy, in the emulator, with requests over its serial line; the same
    /// hash as on the host.
    Embassy,
    /// The table that a test of the simulated axes prints.
    Table(table::Options),
    /// The playground as static files, in `target/web-page`; prints their sizes.
    Web,
}

impl Task {
    /// What it prints.
    pub(crate) fn text(&self) -> Result<String, String> {
        match self {
            Self::Firmware(options) => firmware::run(options),
            Self::Icount(options) => icount::run(options),
            Self::Size => firmware::size(),
            Self::Pil => firmware::pil(),
            Self::Rtic => frameworks::rtic(),
            Self::Capi(options) => capi::task(options),
            Self::Embassy => frameworks::embassy(),
            Self::Table(options) => table::run(options),
            Self::Web => web::run(),
        }
    }

    /// Runs it and prints.
    pub(crate) fn print(&self) -> Result<(), String> {
        self.text().map(|text| print!("{text}"))
    }
}

#[derive(Parser)]
struct Line {
    #[command(subcommand)]
    task: Task,
}

/// What the task `words` prints; the first word is the program.
pub(crate) fn text(words: &[&str]) -> Result<String, String> {
    let line = Line::try_parse_from(words).map_err(|error| error.to_string())?;
    line.task.text()
}
