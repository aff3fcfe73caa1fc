//! `trendid tune`: gains for the loop that a user already has.

mod figures;
mod report;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use trendid_identify::tune::{Goal, Model, tune};
use trendid_identify::{Choice, Freedom, Options, Problem, Structure, identify};

use crate::identify::parse::{delay, filter};
use crate::identify::signals::SignalArgs;
use crate::output::{Bar, Refusal, emit, emit_json};
use crate::tune::report::Report;

const EXAMPLE: &str = "\
Examples:
  trendid tune model --numerator 1e6 --denominator 1,20,400,0 --sample-time 0.001
  trendid tune record servo.csv --order 3 --integrator --bandwidth auto --plot pictures

Three controllers: position P around velocity PI, PID with a filtered derivative of the
output, and state feedback with an observer that finds a constant disturbance. `auto` is
the largest bandwidth whose sensitivity max |1/(1+L)| stays at or below 1.7, for the
model and for two standard deviations to both sides along each axis of its covariance.
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

/// What a loop is asked for.
#[derive(Debug, Args)]
struct LoopArgs {
    /// Bandwidth in rad/s, or the largest robust one
    #[arg(long, value_name = "W|auto", default_value = "auto", value_parser = parse_bandwidth)]
    bandwidth: Choice<f64>,
    /// Write pictures of the step and of the open loop (SVG) into this directory
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct RecordArgs {
    #[command(flatten)]
    signals: SignalArgs,
    /// Order of the model, 1 to 4, the integrator included
    #[arg(long, value_name = "M")]
    order: usize,
    /// The plant integrates: a0 = 0
    #[arg(long)]
    integrator: bool,
    /// Number of zeros
    #[arg(long, value_name = "K", default_value_t = 0)]
    zeros: usize,
    /// Delay of the plant in samples of the record, or the best
    #[arg(long, value_name = "D|auto", default_value = "auto", value_parser = delay)]
    delay: Choice<usize>,
    /// Filter poles in rad/s, or `auto`
    #[arg(long, value_name = "POLE|auto", default_value = "auto", value_parser = filter, allow_negative_numbers = true)]
    filter: Choice<Option<f64>>,
    /// Sample time of the controller in s; that of the record without
    #[arg(long, value_name = "S")]
    sample_time: Option<f64>,
    #[command(flatten)]
    wanted: LoopArgs,
}

#[derive(Debug, Args)]
struct ModelArgs {
    /// Numerator, highest power of s first
    #[arg(
        long,
        value_name = "B,..",
        value_delimiter = ',',
        required = true,
        allow_negative_numbers = true
    )]
    numerator: Vec<f64>,
    /// Denominator, highest power of s first
    #[arg(
        long,
        value_name = "A,..",
        value_delimiter = ',',
        required = true,
        allow_negative_numbers = true
    )]
    denominator: Vec<f64>,
    /// Delay in samples of the controller, also between them
    #[arg(long, value_name = "D", default_value_t = 0.0)]
    delay: f64,
    /// Sample time of the controller in s
    #[arg(long, value_name = "S")]
    sample_time: f64,
    #[command(flatten)]
    wanted: LoopArgs,
}

/// `--bandwidth W|auto` for clap.
fn parse_bandwidth(text: &str) -> Result<Choice<f64>, String> {
    match (text, text.parse::<f64>()) {
        ("auto", _) => Ok(Choice::Auto),
        (_, Ok(bandwidth)) if bandwidth > 0.0 && bandwidth.is_finite() => {
            Ok(Choice::Given(bandwidth))
        }
        _ => Err("expected a number of rad/s above 0, or `auto`".into()),
    }
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record, the model or the wishes.
pub(crate) fn run(args: &TuneArgs) -> Result<(), Refusal> {
    let (model, around, sample_time, wanted) = match &args.source {
        Source::Model(args) => (args.model()?, Vec::new(), args.sample_time, &args.wanted),
        Source::Record(args) => {
            let (model, around, dt) = args.model()?;
            (model, around, args.sample_time.unwrap_or(dt), &args.wanted)
        }
    };
    let goal = Goal {
        sample_time,
        bandwidth: match wanted.bandwidth {
            Choice::Given(bandwidth) => Some(bandwidth),
            Choice::Auto => None,
        },
    };
    let tuned = tune(&model, &around, goal)?;
    let report = Report {
        model: &model,
        goal,
        tuned: &tuned,
    };
    match wanted.json {
        true => emit_json(&report.json())?,
        false => emit(&report.text())?,
    }
    if let Some(dir) = &wanted.plot {
        let written = figures::save(dir, &tuned)?;
        if !wanted.json {
            let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
            emit(&format!("\nPictures: {}\n", names.join(", ")))?;
        }
    }
    Ok(())
}

impl ModelArgs {
    fn model(&self) -> Result<Model, Refusal> {
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
        Ok(Model {
            a: monic(lower),
            b: monic(&self.numerator),
            delay: self.delay * self.sample_time,
        })
    }
}

impl RecordArgs {
    /// The model, those within two standard deviations, and the sample time of the record.
    fn model(&self) -> Result<(Model, Vec<Model>, f64), Refusal> {
        let loaded = self.signals.load()?;
        let signals = loaded.signals();
        let structure = Structure {
            order: self.order,
            integrator: self.integrator,
            zeros: self.zeros,
            constant: self.signals.constant,
        };
        let options = Options {
            scheme: self.signals.scheme.into(),
            memory: None,
        };
        let problem = Problem::new(&signals, structure, options)?;
        let freedom = Freedom {
            pole: self.filter,
            delay: self.delay,
        };
        let bar = Bar::new("choosing filter and delay");
        let found = identify(&problem, freedom, 0, &bar)?;
        bar.finish();
        let delay = found.delay * loaded.dt;
        let around = Model::around(&problem, &found.estimate, delay);
        Ok((Model::of(&found.estimate, delay), around, loaded.dt))
    }
}
