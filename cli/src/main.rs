//! Command line of trendid.
#![allow(missing_docs)] // a program: its documentation is `--help`

#[cfg(test)]
mod drawn_records;
#[cfg(test)]
#[path = "../../identify/tests/draws/mod.rs"]
mod draws;
mod drives;
mod endurance;
mod format;
mod identify;
mod monitor;
mod options;
mod output;
mod paper;
mod pil;
mod plot;
mod record;
mod seeds;
mod servo;
mod sigma;
mod simulate;
mod tune;
mod users;

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
    Demo(servo::demo::DemoArgs),
    Simulate(simulate::SimulateArgs),
    Identify(identify::command::IdentifyArgs),
    Select(identify::select::SelectArgs),
    Tune(tune::TuneArgs),
    /// The tables and the figure of the paper again
    Paper(paper::PaperArgs),
    /// Cost in instructions and gain in accuracy of each option of the core
    Options(options::OptionsArgs),
    /// Whether the estimate stays true over hours: every motion with every memory, other ways to
    /// forget beside
    Endurance(endurance::EnduranceArgs),
    Sigma(sigma::SigmaArgs),
    Drives(drives::DrivesArgs),
    Users(users::UsersArgs),
    /// The adaptive position loop in every scenario, with fixed gains beside
    Loop(servo::position_loop::LoopArgs),
    Monitor(monitor::MonitorArgs),
    /// A scenario of the demonstration with the loop on an emulated or real processor, bit for bit
    /// as on the host
    Pil(pil::PilArgs),
}

/// Exit code of bad input, the same that clap uses for bad arguments.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    // Without arguments: the demonstration.
    let cli = match std::env::args_os().len() {
        0 | 1 => Cli::parse_from(["trendid", "demo"]),
        _ => Cli::parse(),
    };
    let done = match &cli.command {
        Command::Demo(args) => servo::demo::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Identify(args) => identify::command::run(args),
        Command::Select(args) => identify::select::run(args),
        Command::Tune(args) => tune::run(args),
        Command::Paper(args) => paper::run(args),
        Command::Options(args) => options::run(args),
        Command::Endurance(args) => endurance::run_all(args),
        Command::Sigma(args) => sigma::run(args),
        Command::Drives(args) => drives::run(args),
        Command::Users(args) => users::run(args),
        Command::Loop(args) => servo::position_loop::run(args),
        Command::Monitor(args) => monitor::run(args),
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
