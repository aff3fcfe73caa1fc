//! `trendid tune`: gains for the loop that a user already has.

mod args;
mod figures;
mod plant;
mod record;
mod report;

use clap::{Args, Subcommand};
use trendid_identify::Choice;
use trendid_identify::tune::{Goal, Model, tune};

use crate::output::{Refusal, emit, emit_json};
use crate::tune::args::LoopArgs;
use crate::tune::plant::Plant;
use crate::tune::record::RecordArgs;
use crate::tune::report::Report;

const EXAMPLE: &str = "\
Examples:
  trendid tune model --numerator 1e6 --denominator 1,20,400,0 --sample-time 0.001
  trendid tune record servo.csv --order 3 --integrator --bandwidth auto --plot pictures

Three controllers: position P around velocity PI, PID with a filtered derivative of the
output, and state feedback with an observer that finds a constant disturbance. `auto` is
the largest bandwidth, from 1e-8 to 0.5 radians per sample, whose sensitivity
max |1/(1+L)| stays at or below 1.7, for the model and for two standard deviations to
both sides along each axis of its covariance, the delay included. A delay that may be
longer than 200 samples within these has no gains.
Margins are those of the sampled loop: held command, delay between samples, the
difference equations that are printed. Nothing in them limits the command.";

/// Gains for a controller, from a record or from a model
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct TuneArgs {
    #[command(subcommand)]
    source: Source,
}

#[derive(Debug, Subcommand)]
enum Source {
    /// Gains for the drive in a record
    #[command(after_help = EXAMPLE)]
    Record(RecordArgs),
    /// Gains for a transfer function
    #[command(after_help = EXAMPLE)]
    Model(ModelArgs),
}

#[derive(Debug, Args)]
struct ModelArgs {
    /// Numerator, highest power of s first
    #[arg(
        long,
        value_name = "B,..",
        value_delimiter = ',',
        required = true,
        allow_hyphen_values = true
    )]
    numerator: Vec<f64>,
    /// Denominator, highest power of s first
    #[arg(
        long,
        value_name = "A,..",
        value_delimiter = ',',
        required = true,
        allow_hyphen_values = true
    )]
    denominator: Vec<f64>,
    /// Delay in samples of the controller, also between them
    #[arg(
        long,
        value_name = "D",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    delay: f64,
    /// Sample time of the controller in s
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    sample_time: f64,
    #[command(flatten)]
    wanted: LoopArgs,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record, the model or the wishes.
pub(crate) fn run(args: &TuneArgs) -> Result<(), Refusal> {
    let (plant, wanted) = match &args.source {
        Source::Model(args) => (args.plant()?, &args.wanted),
        Source::Record(args) => (args.plant()?, &args.wanted),
    };
    let goal = Goal {
        sample_time: plant.sample_time,
        bandwidth: match wanted.bandwidth {
            Choice::Given(bandwidth) => Some(bandwidth),
            Choice::Auto => None,
        },
    };
    let tuned = tune(&plant.model, &plant.around, goal)?;
    let report = Report {
        plant: &plant,
        goal,
        tuned: &tuned,
    };
    // A picture that cannot be written is known before anything is printed.
    let pictures = wanted.plot.as_ref().map(|dir| figures::save(dir, &tuned));
    let pictures = pictures.transpose()?;
    if wanted.json {
        return emit_json(&report.json());
    }
    emit(&report.text())?;
    if let Some(written) = pictures {
        let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
        emit(&format!("\nPictures: {}\n", names.join(", ")))?;
    }
    Ok(())
}

impl ModelArgs {
    fn plant(&self) -> Result<Plant, Refusal> {
        let Some((leading, lower)) = self.denominator.split_first() else {
            return Err(Refusal::new("the denominator has no coefficients"));
        };
        if !(leading.is_finite() && *leading != 0.0) {
            return Err(Refusal::new(format!(
                "the first coefficient of the denominator is {leading}, not a number other than 0"
            )));
        }
        let monic = |coefficients: &[f64]| -> Vec<f64> {
            coefficients.iter().rev().map(|c| c / leading).collect()
        };
        Ok(Plant {
            model: Model {
                a: monic(lower),
                b: monic(&self.numerator),
                delay: self.delay * self.sample_time,
            },
            around: Vec::new(),
            sample_time: self.sample_time,
            record: None,
        })
    }
}
