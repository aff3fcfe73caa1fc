//! Arguments of the tables.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use trendid_host_tests::signals::noise::Reading;

use crate::output::Refusal;

/// Arguments of `trendid paper table1`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid paper table1 --seeds 10
  trendid paper table1 --csv > table1.csv
  trendid paper table1 --reading relative --vary white --seeds 1000 --check")]
pub(super) struct Table1Args {
    /// Records per condition
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub seeds: u64,
    /// Seed of the first record
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub first_seed: u64,
    /// Length of each record [s]; default 0.5 in ABSOLUTE, 3 in RELATIVE
    #[arg(long, value_name = "S")]
    pub duration: Option<f64>,
    /// One reading of the noise only
    #[arg(long, value_enum)]
    pub reading: Option<ReadingName>,
    /// One block only; may be repeated
    #[arg(long, value_enum, value_name = "BLOCK")]
    pub vary: Vec<Block>,
    /// One line per condition and method, for machines
    #[arg(long, conflicts_with_all = ["brief", "check"])]
    pub csv: bool,
    /// Paper, bound, opponents and the default only, one row per condition
    #[arg(long, conflicts_with = "check")]
    pub brief: bool,
    /// Only the comparison with the limits that the project sets itself
    #[arg(long)]
    pub check: bool,
    /// Writes the errors over the noise level as DIR/table1.svg; needs the block `white`
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
}

/// Arguments of `trendid paper table2`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid paper table2
  trendid paper table2 --csv --seeds 10 --duration 1")]
pub(super) struct Table2Args {
    /// Records per structure
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub seeds: u64,
    /// Seed of the first record; the record on which IQ is evaluated has the seed N + 500000
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub first_seed: u64,
    /// Length of each record [s]
    #[arg(long, value_name = "S", default_value_t = 3.0)]
    pub duration: f64,
    /// Reading of the noise
    #[arg(long, value_enum, default_value = "absolute")]
    pub reading: ReadingName,
    /// One line per structure and method, for machines
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// The same as JSON
    #[arg(long)]
    pub json: bool,
}

/// The two readings of the printed widths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReadingName {
    Absolute,
    Relative,
}

impl ReadingName {
    pub const ALL: [Self; 2] = [Self::Absolute, Self::Relative];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Absolute => "absolute",
            Self::Relative => "relative",
        }
    }
}

impl From<ReadingName> for Reading {
    fn from(name: ReadingName) -> Self {
        match name {
            ReadingName::Absolute => Self::Absolute,
            ReadingName::Relative => Self::Relative,
        }
    }
}

/// The blocks of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Block {
    Drift,
    Noise,
    Resolution,
    Sampling,
    /// The noise block with the white noise alone
    White,
}

impl Block {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Drift => "drift",
            Self::Noise => "noise",
            Self::Resolution => "resolution",
            Self::Sampling => "sampling",
            Self::White => "white",
        }
    }
}

/// Refuses a length of the records that is out of bounds.
///
/// # Errors
///
/// The length and the bounds.
pub(super) fn check(duration: Option<f64>) -> Result<(), Refusal> {
    match duration {
        Some(duration) if !(0.3..=60.0).contains(&duration) => Err(Refusal::new(format!(
            "--duration is {duration} s, not between 0.3 and 60"
        ))),
        _ => Ok(()),
    }
}
