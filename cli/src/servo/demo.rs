//! `trendid demo`: a pneumatic axis commissions itself, tracks and follows a change; or the
//! identification of a linear servo.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::scenario::Scenario;

use crate::identify::names::SchemeName;
use crate::identify::parse::filter;
use crate::output::Refusal;
use crate::servo::demo_axis;
use crate::servo::demo_loop;
use crate::servo::linear;
use crate::servo::linear_args::{LinearArgs, NoiseArgs};
use crate::servo::population::family_names;
use trendid_identify::Choice;

const EXAMPLE: &str = "\
Examples:
  trendid demo                                 the mass triples in motion
  trendid demo --fixed                         the same with the gains of the commissioning
  trendid demo --scenario supply --seeds 20 --json
  trendid demo --axis 5007                     an axis of the population, told sample time and travel
  trendid demo --linear --eta 100 --eps 50 --seed 7 --out pictures

Scenarios, all after a commissioning without prior knowledge but sign, travel and rough bandwidth:
  nominal       60 mm steps, sines of 0.5 and 1 Hz (also: commissioning, step, sine)
  mass          the moving mass is tripled in motion
  supply        the supply falls from 6 to 4 bar in motion
  valve-gain    the valve loses 30 % of its gain in motion
  friction      friction doubles in motion
  rest          60 s at rest under noise, then motion
  wrong-sign, wrong-order, stuck-sensor, stuck-valve, blocked-axis
                a fault; the axis is commissioned again and must refuse with the right reason

The axis is a simulated pneumatic cylinder at 1 kHz with friction, a valve with a dead zone of 3 %, a
sensor with 10 um of resolution and +-10 um of noise. The drive of --linear is the servo of
K. Janiszowski (1999), Table 2: C w0^2 / (s (s^2 + 2 xi w0 s + w0^2)) with C = 2500 mm/s per unit of
u, w0 = 20 rad/s, xi = 0.5; u is a binary sequence of +-0.4 held for 50 ms, noise as in Fig. 1.";

/// Other names of the nominal scenario, which shows all three.
const NOMINAL: [&str; 3] = ["commissioning", "step", "sine"];

fn scenario_names() -> PossibleValuesParser {
    let names = Scenario::ALL.iter().map(|s| s.name());
    PossibleValuesParser::new(names.chain(NOMINAL))
}

/// Watch an axis commission itself, track and recover from a change (the default command)
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct DemoArgs {
    /// Change or fault of the axis
    #[arg(
        long,
        value_name = "NAME",
        default_value = "mass",
        hide_possible_values = true,
        value_parser = scenario_names()
    )]
    scenario: String,
    /// The gains stay as the commissioning found them
    #[arg(long)]
    fixed: bool,
    /// The first seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Runs of as many seeds; the picture shows the first
    #[arg(long, value_name = "N", default_value_t = 1)]
    seeds: u64,
    /// Directory of the picture
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Print JSON, one object per seed
    #[arg(long)]
    json: bool,
    /// The axis of this seed of the population of `trendid loop --population` instead
    #[arg(long, value_name = "SEED", conflicts_with_all = ["scenario", "seed", "seeds", "linear"])]
    axis: Option<u64>,
    /// Family of that axis
    #[arg(long, value_name = "NAME", default_value = "pneumatic", requires = "axis", value_parser = family_names())]
    family: String,
    /// Drawn from the half of each range about an ordinary machine
    #[arg(long, requires = "axis")]
    usual: bool,
    /// Identify a linear servo instead, without a controller
    #[arg(long, conflicts_with_all = ["scenario", "fixed", "seeds"])]
    linear: bool,
    #[command(flatten)]
    identification: Identification,
}

/// Options of `--linear`.
#[derive(Debug, Args)]
#[command(next_help_heading = "With --linear")]
struct Identification {
    /// Duration [s], 1 without
    #[arg(long, value_name = "S", requires = "linear")]
    seconds: Option<f64>,
    /// Full width of the white noise of the position [um], 20 without
    #[arg(long, value_name = "UM", requires = "linear")]
    eta: Option<f64>,
    /// Full width of the slow drift of the position [um], 200 without
    #[arg(long, value_name = "UM", requires = "linear")]
    w: Option<f64>,
    /// Resolution of the position sensor [um], 10 without
    #[arg(long, value_name = "UM", requires = "linear")]
    eps: Option<f64>,
    /// Trends of Goodwin (4) or modified Tustin (8), tustin without
    #[arg(long, value_enum, requires = "linear")]
    scheme: Option<SchemeName>,
    /// Filter poles in rad/s, `none` for the paper's raw trends, `auto` for the default of the
    /// core, auto without
    #[arg(long, value_name = "POLE|none|auto", requires = "linear", value_parser = filter, allow_negative_numbers = true)]
    filter: Option<Choice<Option<f64>>>,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on an option that makes no sense or a file that cannot be written.
pub(crate) fn run(args: &DemoArgs) -> Result<(), Refusal> {
    if args.linear {
        let asked = &args.identification;
        return linear::run(&LinearArgs {
            noise: NoiseArgs {
                seed: args.seed,
                seconds: asked.seconds.unwrap_or(1.0),
                eta: asked.eta.unwrap_or(20.0),
                w: asked.w.unwrap_or(200.0),
                eps: asked.eps.unwrap_or(10.0),
            },
            scheme: asked.scheme.unwrap_or(SchemeName::Tustin),
            filter: asked.filter.unwrap_or(Choice::Auto),
            out: args.out.clone(),
            json: args.json,
        });
    }
    if let Some(seed) = args.axis {
        return demo_axis::run(&demo_axis::Task {
            family: Family::from_name(&args.family).unwrap_or(Family::Pneumatic),
            usual: args.usual,
            seed,
            fixed: args.fixed,
            out: &args.out,
            json: args.json,
        });
    }
    if !(1..=1000).contains(&args.seeds) {
        return Err(Refusal::new(format!(
            "--seeds {} is not between 1 and 1000",
            args.seeds
        )));
    }
    let Some(last) = args.seed.checked_add(args.seeds - 1) else {
        return Err(Refusal::new("--seed is too large for so many seeds"));
    };
    demo_loop::run(&demo_loop::Task {
        scenario: Scenario::from_name(&args.scenario).unwrap_or(Scenario::Nominal),
        fixed: args.fixed,
        seeds: args.seed..=last,
        out: &args.out,
        json: args.json,
    })
}
