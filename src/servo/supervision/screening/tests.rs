//! The bounds of what may control, and of what is better.

use super::*;
use crate::servo::config::Config;
use crate::servo::error::Error;
use crate::servo::motion::Travel;

const MODEL: Model = Model::linear(625.0, 25.0, 1e6);

fn design() -> Result<SupervisionDesign, Error> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    Ok(Config::new(1e-3, 25.0, travel).resolve()?.supervision)
}

#[test]
fn a_model_controls_within_its_bounds_and_not_beyond() -> Result<(), Error> {
    let screening = design()?.screening;
    let factor = screening.factor_squared;
    let [least, most] = [screening.min_gain, screening.max_gain];
    let dead_zone = |dead_zone| Model { dead_zone, ..MODEL };
    let offset = |offset| Model { offset, ..MODEL };
    let friction = |friction| Model { friction, ..MODEL };
    // The frequency about the rough bandwidth of 25 rad/s, the gain kept.
    let frequency = |share: f32| Model::linear(share * 625.0, 25.0, share * 1e6);
    let gain = |gain: f32| Model::linear(625.0, 25.0, gain * 625.0);
    let damping = |xi: f32| Model::linear(625.0, 50.0 * xi, 1e6);
    for (inside, outside) in [
        (frequency(0.999 * factor), frequency(1.001 * factor)),
        (frequency(1.001 / factor), frequency(0.999 / factor)),
        (gain(0.999 * most), gain(1.001 * most)),
        (gain(1.001 * least), gain(0.999 * least)),
        (damping(2.999), damping(3.001)),
        (dead_zone(0.0), dead_zone(-1e-3)),
        (dead_zone(0.299), dead_zone(VALVE_MAX)),
        (offset(0.299), offset(VALVE_MAX)),
        (offset(-0.299), offset(-VALVE_MAX)),
        (friction(0.0), friction(-1.0)),
        (
            friction(ACCELERATION_MAX),
            friction(1.01 * ACCELERATION_MAX),
        ),
    ] {
        assert_eq!(screening.admits(&inside), Ok(()), "{inside:?}");
        let refused = screening.admits(&outside);
        assert_eq!(refused, Err(Reason::OutOfRange), "{outside:?}");
    }
    Ok(())
}

#[test]
fn a_model_that_is_wrong_itself_is_refused_for_its_reason() -> Result<(), Error> {
    let screening = design()?.screening;
    for (model, reason) in [
        (Model { b0: 0.0, ..MODEL }, Reason::WrongSign),
        (Model { b0: -1e6, ..MODEL }, Reason::WrongSign),
        (Model { a1: 0.0, ..MODEL }, Reason::Unstable),
        (Model { a2: 0.0, ..MODEL }, Reason::Unstable),
        (
            Model {
                a1: -625.0,
                ..MODEL
            },
            Reason::Unstable,
        ),
        (
            Model {
                a2: f32::NAN,
                ..MODEL
            },
            Reason::NotFinite,
        ),
        (
            Model {
                friction: f32::INFINITY,
                ..MODEL
            },
            Reason::NotFinite,
        ),
    ] {
        assert_eq!(screening.admits(&model), Err(reason), "{model:?}");
    }
    Ok(())
}

#[test]
fn a_candidate_is_certain_in_gain_frequency_and_damping() -> Result<(), Error> {
    let screening = design()?.screening;
    let limit = screening.max_variance_adapting;
    let certain = Candidate::known(MODEL);
    assert_eq!(screening.screen(&certain), Ok(()));
    let gain = |gain_variance| Candidate {
        gain_variance,
        ..certain
    };
    let frequency = |frequency_variance| Candidate {
        frequency_variance,
        ..certain
    };
    let damping = |damping_variance| Candidate {
        damping_variance,
        ..certain
    };
    for (inside, outside) in [
        (gain(0.99 * limit), gain(limit)),
        (frequency(0.99 * limit), frequency(limit)),
        // Four times the deviation: damping is known worst, and matters least.
        (damping(15.9 * limit), damping(16.0 * limit)),
    ] {
        assert_eq!(screening.screen(&inside), Ok(()), "{inside:?}");
        let refused = screening.screen(&outside);
        assert_eq!(refused, Err(Reason::Uncertain), "{outside:?}");
    }
    // What is certain may still be out of range.
    let slow = Candidate::known(Model::linear(1.0, 1.0, 1e3));
    assert_eq!(screening.screen(&slow), Err(Reason::OutOfRange));
    Ok(())
}

#[test]
fn a_wrong_sign_is_one_of_three_sigma() -> Result<(), Error> {
    let screening = design()?.screening;
    let at = |b0, sigma: f32| Candidate {
        variances: [0.0, 0.0, sigma * sigma],
        ..Candidate::known(Model { b0, ..MODEL })
    };
    for sign in [1.0, -1.0] {
        assert!(at(3.01 * sign, 1.0).has_certain_sign());
        assert!(!at(2.99 * sign, 1.0).has_certain_sign());
        assert!(!at(sign, f32::INFINITY).has_certain_sign());
    }
    assert_eq!(screening.screen(&at(-1e6, 1e5)), Err(Reason::WrongSign));
    assert_eq!(screening.screen(&at(-1e6, 1e6)), Err(Reason::Uncertain));
    assert_eq!(screening.screen(&at(0.0, 1.0)), Err(Reason::Uncertain));
    Ok(())
}

#[test]
fn better_is_a_smaller_error_by_a_share_and_by_what_it_explains() -> Result<(), Error> {
    let design = design()?;
    let (ratio, least) = (design.replace_ratio, design.min_improvement);
    // By the share alone, where next to nothing was moved.
    assert!(design.is_better(0.99 * ratio, 1.0, 0.0));
    assert!(!design.is_better(1.01 * ratio, 1.0, 0.0));
    // By what it explains of a large movement.
    assert!(design.is_better(0.0, 1.0, 0.99 / least));
    assert!(!design.is_better(0.0, 1.0, 1.01 / least));
    // By the difference, whatever is left of both.
    let left = 0.5 * ratio;
    for (share, better) in [(0.99, true), (1.01, false)] {
        let moved = share * (1.0 - left) / least;
        assert_eq!(design.is_better(left, 1.0, moved), better, "{share}");
    }
    for [sse, other] in [[f32::NAN, 1.0], [0.0, f32::NAN], [f32::INFINITY; 2]] {
        assert!(!design.is_better(sse, other, 1.0));
    }
    Ok(())
}
