//! `trendid select`: orders, integrator, zeros and delays against what a record shows.

use clap::Args;
use trendid_identify::structure_choice::{Range, select};
use trendid_identify::{Choice, Freedom, Options};

use crate::identify::names::SchemeName;
use crate::identify::parse::{delay, filter};
use crate::identify::select_report::SelectReport;
use crate::identify::signals::SignalArgs;
use crate::identify::simulated::Simulated;
use crate::output::{Bar, Refusal, emit, emit_json};

const EXAMPLE: &str = "\
Examples:
  trendid select dryer.csv --constant
  trendid select --simulated 300 --first-seed 200001

Every structure is estimated by instruments at its own filter and delay, and judged by
free simulations of eighths of the record that its model has not seen, with initial
state and constant refitted (x0+c). Recommended is the structure with the fewest
parameters among those that simulate about as well as the best: an error of at most
1.03 times the best one, or one within three standard errors over the eighths and at
most 1.5 times as large, or with friction as an input one of at most 0.2 % of the
movement, which the sign of a velocity does not hold. Dropped are models that are
unstable, that rest on a parameter which is not significant, or whose zero is not
told from a pole or faster than the sampling shows. An input of one step or one sine is
said, and is `poor_input` of --json (`one step`, `one sine`, null); one sine with a
delay that is searched is refused.";

/// Compare orders, zeros and delays on a record
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE, mut_arg("file", |file| file.required(false).required_unless_present("simulated")))]
pub(crate) struct SelectArgs {
    #[command(flatten)]
    signals: Option<SignalArgs>,
    /// Highest order tried, 1 to 4, the integrator included
    #[arg(long, value_name = "M", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=4), allow_negative_numbers = true)]
    max_order: u8,
    /// Try only structures with an integrator (a0 = 0)
    #[arg(long)]
    integrator: bool,
    /// Delay in samples, or the best of 0 to 200
    #[arg(long, value_name = "D|auto", default_value = "auto", value_parser = delay, allow_negative_numbers = true)]
    delay: Choice<usize>,
    /// Filter poles in rad/s, or `auto`: for each structure its own
    #[arg(long, value_name = "POLE|auto", default_value = "auto", value_parser = filter, allow_negative_numbers = true)]
    filter: Choice<Option<f64>>,
    /// Without a record: how often the structure of so many simulated plants is found
    #[arg(long, value_name = "N", conflicts_with = "file")]
    simulated: Option<u64>,
    /// Seed of the first simulated plant
    #[arg(long, value_name = "S", default_value_t = 1, requires = "simulated")]
    first_seed: u64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record, or that no structure fits it.
pub(crate) fn run(args: &SelectArgs) -> Result<(), Refusal> {
    if let Some(plants) = args.simulated {
        let simulated = Simulated::run(plants, args.first_seed)?;
        match args.json {
            true => emit_json(&simulated.json())?,
            false => emit(&simulated.text())?,
        }
        return Ok(());
    }
    let Some(record) = &args.signals else {
        return Err(Refusal::new(
            "a record or --simulated N is needed".to_owned(),
        ));
    };
    if args.filter == Choice::Given(None) {
        return Err(Refusal::new(
            "the structures are compared behind a filter: `none` is possible in `identify` only"
                .to_owned(),
        ));
    }
    if record.scheme != SchemeName::Tustin {
        return Err(Refusal::new(
            "the structures are compared by sums of Tustin's trends: `--scheme goodwin` is possible in `identify` only"
                .to_owned(),
        ));
    }
    let loaded = record.load()?;
    let signals = loaded.signals();
    let range = Range {
        max_order: args.max_order.into(),
        integrating: args.integrator,
        constant: record.constant,
    };
    let options = Options {
        scheme: record.scheme.into(),
        memory: None,
    };
    let freedom = Freedom {
        pole: args.filter,
        delay: args.delay,
    };
    let bar = Bar::new("structures");
    let selection = select(&signals, range, options, freedom, &bar);
    let selection = selection.map_err(|error| loaded.refusal(error))?;
    bar.finish();
    let report = SelectReport {
        file: &record.file,
        signals: &signals,
        notes: &loaded.notes,
        selection: &selection,
    };
    match args.json {
        true => emit_json(&report.json())?,
        false => emit(&report.text())?,
    }
    Ok(())
}
