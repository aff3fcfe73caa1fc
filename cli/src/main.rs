//! Command line of trendid.
#![allow(missing_docs)] // a program: its documentation is `--help`

mod auto;
mod estimate;
mod format;
mod freerun;
mod friction;
mod identify;
mod output;
mod pil;
mod plot;
mod record;
mod signals;
mod symmetric;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Recursive identification of low-order continuous-time models of servo drives
#[derive(Parser)]
#[command(
    name = "trendid",
    version,
    about,
    after_help = "Example:\n  trendid demo --seed 3 --out pictures"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Identify(identify::IdentifyArgs),
    /// The controller on an emulated or real processor against the simulated servo, bit for bit
    Pil(pil::PilArgs),
}

/// Exit code of bad input, the same that clap uses for bad arguments.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match &cli.command {
        Command::Identify(args) => identify::run(args),
        Command::Pil(args) => pil::run(args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(refusal) => {
            eprintln!("error: {refusal}");
            ExitCode::from(BAD_INPUT)
        }
    }
}
