//! `trendid demo --linear`: the core finds the parameters of a simulated servo.

use serde_json::json;
use trendid::Outcome;
use trendid::estimation::Terms;
use trendid::trends::{FilteredTrends, Scheme};
use trendid_host_tests::signals::experiment::Record;
use trendid_identify::dynamic::{Filter, Setup, settings};
use trendid_identify::tuning::binomial;
use trendid_identify::{Choice, Freedom};

use crate::output::{Refusal, emit, emit_json};
use crate::servo::linear_args::LinearArgs;
use crate::servo::linear_report::{courses, figure, json_of, note, text};

/// Rough design values, all that the identifier gets: rad/s, and mm of movement.
const BANDWIDTH: f64 = 20.0;
const MOVEMENT: f32 = 50.0;
const COMMAND: f32 = 0.4;

/// Runs the command.
///
/// # Errors
///
/// One sentence on an option that makes no sense or a file that cannot be written.
pub(super) fn run(args: &LinearArgs) -> Result<(), Refusal> {
    let record = args.noise.record()?;
    let mut core = setup(&record, args.scheme.into(), args.filter)?.build()?;
    let mut courses = courses();
    for sample in record.samples() {
        let outcome = core.update(&[sample.u as f32], sample.y as f32);
        if matches!(outcome, Outcome::Estimated { .. }) {
            note(&mut courses, core.as_ref(), sample.t);
        }
    }
    let picture = figure(&courses, args).save(&args.out, "transients")?;
    if args.json {
        let mut value = json_of(&courses, core.as_ref());
        value["pictures"] = json!([picture.display().to_string()]);
        emit_json(&value)?;
        return Ok(());
    }
    emit(&text(&courses, core.as_ref(), args))?;
    emit(&format!(
        "\nPicture of the transients: {}\n",
        picture.display()
    ))?;
    Ok(())
}

/// The default of the core, or a filter of one pole without constant and initial state.
fn setup(record: &Record, scheme: Scheme, choice: Choice<Option<f64>>) -> Result<Setup, Refusal> {
    let freedom = Freedom {
        pole: choice,
        ..Freedom::default()
    };
    freedom.check(record.dt)?;
    let filter = match choice {
        Choice::Auto => {
            let default =
                FilteredTrends::<3>::for_bandwidth(scheme, record.dt as f32, BANDWIDTH as f32)?;
            Filter::Polynomial(default.filter().to_vec())
        }
        Choice::Given(Some(pole)) => Filter::Polynomial(binomial(pole, 3)),
        Choice::Given(None) => Filter::None,
    };
    let default = matches!(choice, Choice::Auto);
    Ok(Setup {
        order: 3,
        output: Terms::between(1, 3),
        inputs: vec![Terms::up_to(1)],
        constant: default,
        initial_state: default,
        sample_time: record.dt as f32,
        scheme,
        filter,
        settings: settings(BANDWIDTH as f32, &[COMMAND], MOVEMENT),
    })
}
