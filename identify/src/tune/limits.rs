//! What has no controller, said with its value and its limit.

use super::model::Model;
use super::plant::SampledPlant;
use super::tuned_loop::{FASTEST, Goal, SLOWEST};
use crate::delay_choice::LONGEST_DELAY;
use crate::error::Error;

/// Sizes of a coefficient that is not 0.
const SIZES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;
/// Sample times \[s\].
const SAMPLE_TIMES: std::ops::RangeInclusive<f64> = 1e-12..=1e12;
/// Fastest plant \[rad per sample\]: any that is faster has long settled in between.
const FASTEST_PLANT: f64 = 1e6;

/// A number of samples.
fn in_words(samples: f64) -> String {
    match samples.abs() < 1e6 {
        true => format!("{samples:.1}"),
        false => format!("{samples:.1e}"),
    }
}

fn refuse(what: String) -> Result<(), Error> {
    Err(Error::Model(what))
}

/// Whether gains for a model, and for those within what is known of it, can be looked for.
pub(super) fn check(model: &Model, around: &[Model], goal: Goal) -> Result<(), Error> {
    let dt = goal.sample_time;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(Error::SampleTime(dt));
    }
    if !SAMPLE_TIMES.contains(&dt) {
        return refuse(format!(
            "a sample time of {dt:e} s; {:e} to {:e} s are possible",
            SAMPLE_TIMES.start(),
            SAMPLE_TIMES.end()
        ));
    }
    let fastest = FASTEST / dt;
    if let Some(bandwidth) = goal.bandwidth {
        if !(bandwidth > 0.0 && bandwidth <= fastest) {
            return Err(Error::Bandwidth { bandwidth, fastest });
        }
        let slowest = SLOWEST / dt;
        if bandwidth < slowest {
            return refuse(format!(
                "a bandwidth of {bandwidth:e} rad/s, below {slowest:e} rad/s, {SLOWEST:e} radians per sample: a controller with a longer sample time does as well"
            ));
        }
    }
    coefficients(model)?;
    let samples = model.delay / dt;
    if !(samples >= 0.0 && samples.is_finite()) {
        return refuse(format!("its delay is {} s, not 0 or more", model.delay));
    }
    let most = LONGEST_DELAY as f64;
    if samples > most {
        return refuse(format!(
            "its delay is longer than {LONGEST_DELAY} samples: a controller with a longer sample time does as well"
        ));
    }
    for other in around {
        let longest = other.delay / dt;
        if !(longest <= most) {
            return refuse(format!(
                "its delay is not known, {samples:.1} samples of the controller and {} within two standard deviations, more than {LONGEST_DELAY}: give the delay, or excite more often",
                in_words(longest)
            ));
        }
        coefficients(other).map_err(|error| match error {
            Error::Model(what) => Error::Model(format!("within two standard deviations {what}")),
            other => other,
        })?;
    }
    Ok(())
}

/// What a model is sampled to, all numbers of it finite.
pub(super) fn sampled(model: &Model, dt: f64) -> Result<SampledPlant, Error> {
    let plant = SampledPlant::new(model, dt);
    let per_sample = plant.rate * dt;
    if per_sample > FASTEST_PLANT || !plant.is_finite() {
        let why = match per_sample > FASTEST_PLANT {
            true => format!("up to {FASTEST_PLANT:e} is possible"),
            false => "and it is unstable".into(),
        };
        let what = format!("its rate is {per_sample:.3e} radians per sample; {why}");
        return Err(Error::Model(what));
    }
    Ok(plant)
}

fn coefficients(model: &Model) -> Result<(), Error> {
    let m = model.a.len();
    if !(1..=4).contains(&m) {
        return refuse(format!("its order is {m}, not 1 to 4"));
    }
    if model.b.is_empty() || model.b.len() > m {
        return refuse(format!(
            "{} numerator coefficients for order {m}; 1 to {m} are possible",
            model.b.len()
        ));
    }
    let mut all = model.a.iter().chain(&model.b);
    if !all.clone().all(|v| v.is_finite()) {
        return refuse("a coefficient is not a finite number".into());
    }
    if let Some(v) = all.find(|v| **v != 0.0 && !SIZES.contains(&v.abs())) {
        return refuse(format!(
            "a coefficient is {v:e} where that of the highest power is 1; sizes of {:e} to {:e}, and 0, are possible",
            SIZES.start(),
            SIZES.end()
        ));
    }
    if model.b[0] == 0.0 {
        return refuse("its numerator is 0 at rest: a constant command moves nothing".into());
    }
    Ok(())
}
