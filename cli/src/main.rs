//! Command line of trendid.
#![allow(missing_docs)] // a program: its documentation is `--help`

mod auto;
mod demo;
mod demo_figure;
mod demo_linear;
mod demo_loop;
mod estimate;
mod fig1;
mod format;
mod freerun;
mod friction;
mod identify;
mod options;
mod options_runs;
mod output;
mod pil;
mod plot;
mod position_loop;
mod raster;
mod record;
mod select;
mod signals;
mod simulate;
mod symmetric;
mod table1;
mod table1_picture;
mod table1_text;
mod table2;
mod table2_text;
mod tuning;

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
    Demo(demo::DemoArgs),
    Simulate(simulate::SimulateArgs),
    Identify(identify::IdentifyArgs),
    Select(select::SelectArgs),
    /// Table 1 of the paper again, beside bound and opponents
    Table1(table1::Table1Args),
    /// Table 2 of the paper again: structures and what IQ says of them
    Table2(table2::Table2Args),
    /// Fig. 1 of the paper again: transients of the coefficients
    Fig1(fig1::Fig1Args),
    /// What each option of the core costs in instructions, beside what it gains in accuracy
    Options(options::OptionsArgs),
    /// The adaptive position loop in every scenario, with fixed gains beside
    Loop(position_loop::LoopArgs),
    /// A scenario of the demonstration with the loop on an emulated or real processor, bit for bit as on the host
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
        Command::Demo(args) => demo::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Identify(args) => identify::run(args),
        Command::Select(args) => select::run(args),
        Command::Table1(args) => table1::run(args),
        Command::Table2(args) => table2::run(args),
        Command::Fig1(args) => fig1::run(args),
        Command::Options(args) => options::run(args),
        Command::Loop(args) => position_loop::run(args),
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
