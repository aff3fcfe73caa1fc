//! `trendid identify`: the core over a recorded drive.

use std::path::PathBuf;

use clap::Args;
use trendid_identify::dead_zone::DeadZone;
use trendid_identify::{
    Choice, Error, Freedom, Identification, Options, Problem, Signals, identify,
};

use crate::identify::figures;
use crate::identify::parse::{delay, filter};
use crate::identify::signals::SignalArgs;
use crate::identify::structure::StructureArgs;
use crate::output::{Bar, Refusal, emit, emit_json};

const EXAMPLE: &str = "\
Example (a drive with Coulomb friction, whose record has the columns t, u, y):
  trendid identify emps.csv --order 2 --integrator --coulomb --constant

The model is A(s) y = B(s) u(t - d dt) + c sgn(v) + constant. The fit is
100 (1 - |y - y_sim| / |y - mean|) of a free simulation of the second half with the
model of the first half, its filter and delay chosen there too: `x0` with the initial
state refitted, `x0+c` with the constant refitted too, the fair figure behind an
integrator. Parameters are found by instruments, the inputs filtered twice, which no
noise of the output biases; least squares stands beside them. A delay that is searched
is an unknown, also between samples; its deviation is in those of the parameters. The
friction of --order 2 --integrator --coulomb turns and rests with the velocity of the
model where that simulates better, and where its motion leaves noise alone, the model
is that whose motion leaves least: output error. Standard deviations come
from sixteen blocks of the record and from the noise that the simulation leaves, and
take no noise for white. An input of one step, or of one sine where gain and phase are
all that is unknown, is said in the verdict and as `poor_input` of --json (`one step`,
`one sine`, null) where the delay is searched; one sine for more is refused. With --memory,
--scheme goodwin or --filter none the recursion of the core is used alone.";

/// Rows of the picture of the parameters, about.
const TRACE_POINTS: usize = 1000;

/// Identify a continuous-time model from a record
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct IdentifyArgs {
    #[command(flatten)]
    signals: SignalArgs,
    #[command(flatten)]
    structure: StructureArgs,
    /// Delay of the inputs in samples, or the best of 0 to 200
    #[arg(long, value_name = "D|auto", default_value = "0", value_parser = delay, allow_negative_numbers = true)]
    delay: Choice<usize>,
    /// Filter poles in rad/s, `auto` (those whose model is sharpest where it simulates eighths of
    /// the record that it has not seen as well as the best, or the poles of that model itself where
    /// they do better), or `none` for raw trends
    #[arg(long, value_name = "POLE|auto|none", default_value = "auto", value_parser = filter, allow_negative_numbers = true)]
    filter: Choice<Option<f64>>,
    /// Memory of the estimator; without it nothing is forgotten
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    memory: Option<f64>,
    /// Write pictures (SVG) into this directory
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record or the structure.
pub(crate) fn run(args: &IdentifyArgs) -> Result<(), Refusal> {
    let structure = args.structure.with(args.signals.constant);
    let options = Options {
        scheme: args.signals.scheme.into(),
        memory: args.memory,
    };
    let freedom = Freedom {
        pole: args.filter,
        delay: args.delay,
    };
    let (loaded, first_half) = match args.signals.dead_zone {
        Some(Choice::Auto) => {
            let find = |signals: &Signals| DeadZone::find(signals, structure, options, freedom);
            let [whole, half] = args.signals.load_finding(find)?;
            (whole, Some(half))
        }
        _ => (args.signals.load()?, None),
    };
    let signals = loaded.signals();
    let problem = Problem::new(&signals, structure, options)?;
    let bar = Bar::new("choosing filter and delay");
    let trace_points = if args.plot.is_some() { TRACE_POINTS } else { 0 };
    let found = identify(&problem, freedom, trace_points, &bar);
    let mut found = found.map_err(|error| loaded.refusal(error))?;
    if let Some(half) = &first_half {
        let signals = half.signals();
        let half = Problem::new(&signals, structure, options)?;
        hold_out(&mut found, identify(&half, freedom, 0, &()));
    }
    bar.finish();
    // Before the report, so that nothing is printed where they cannot be written.
    let written = args.plot.as_ref();
    let written = written.map(|dir| figures::save(dir, &problem, &found, loaded.start));
    let written = written.transpose()?;
    let report = args.signals.report(&loaded, &problem, freedom, &found);
    if args.json {
        emit_json(&report.json())?;
    } else {
        emit(&report.text())?;
    }
    if let Some(written) = written.filter(|_| !args.json) {
        let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
        emit(&format!("\nPictures: {}\n", names.join(", ")))?;
    }
    Ok(())
}

/// Takes the simulation of the second half from a model whose dead zone has not seen it either.
fn hold_out(found: &mut Identification, of_half: Result<Identification, Error>) {
    found.held_out = false;
    if let Ok(half) = of_half
        && half.held_out
    {
        (found.free_run, found.held_out) = (half.free_run, true);
    }
}
