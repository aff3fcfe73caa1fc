//! `trendid paper`: the tables and the figure of the paper again.

mod args;
mod fig1;
mod found;
mod table1;
mod table1_picture;
mod table1_text;
mod table2;
mod table2_text;

use clap::{Args, Subcommand};

use crate::output::Refusal;

/// Arguments of the command.
#[derive(Debug, Args)]
pub(crate) struct PaperArgs {
    #[command(subcommand)]
    part: Part,
}

/// The parts of the paper.
#[derive(Debug, Subcommand)]
enum Part {
    /// Table 1: errors over the noise, beside bound and opponents
    Table1(args::Table1Args),
    /// Table 2: structures and what IQ says of them
    Table2(args::Table2Args),
    /// Fig. 1: transients of the coefficients
    Fig1(fig1::Fig1Args),
}

/// Runs the part.
///
/// # Errors
///
/// One sentence on an option that makes no sense or a file that cannot be written.
pub(crate) fn run(args: &PaperArgs) -> Result<(), Refusal> {
    match &args.part {
        Part::Table1(args) => table1::run(args),
        Part::Table2(args) => table2::run(args),
        Part::Fig1(args) => fig1::run(args),
    }
}
