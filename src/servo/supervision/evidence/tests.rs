//! Windows by hand: sums of squares, and what they decide.

use super::*;
use crate::servo::config::Config;
use crate::servo::error::Error;
use crate::servo::motion::Travel;

const USED: Model = Model {
    friction: 40.0,
    ..Model::linear(625.0, 25.0, 1e6)
};

/// An estimate with deviations of its own.
fn estimate(load: f32) -> Candidate {
    Candidate {
        variances: [4.0, 9.0, 16.0],
        ..Candidate::known(Model::linear(load * 625.0, 30.0, 1e6))
    }
}

fn design() -> Result<SupervisionDesign, Error> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    Ok(Config::new(1e-3, 25.0, travel).resolve()?.supervision)
}

/// A window in which the axis moved by 100 and the bank left so much, the challenger so much of it.
fn window(bank: [f32; bank::SIZE], challenger: f32) -> Sums {
    Sums {
        bank,
        challenger: Some(challenger),
        moved: 100.0,
    }
}

/// The model in use leaves 60, all others of the bank more.
const POOR: [f32; bank::SIZE] = [90.0, 80.0, 60.0, 80.0, 90.0, 90.0, 80.0, 80.0, 90.0];
/// A load of 1.73 leaves nothing.
const LOAD: [f32; bank::SIZE] = [90.0, 80.0, 60.0, 0.0, 60.0, 90.0, 80.0, 80.0, 90.0];

/// What the evidence says after a window: a model with its deviations, or why there is none.
fn after(
    evidence: &mut Evidence,
    design: &SupervisionDesign,
    window: &Sums,
) -> Result<Option<(Model, [f32; 3])>, Reason> {
    evidence.add(window);
    let verdict = evidence.verdict(design, &USED)?;
    Ok(verdict.map(|winner| (winner.model, winner.variances)))
}

#[test]
fn an_estimate_has_to_win_two_windows_together() -> Result<(), Error> {
    let design = design()?;
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    // There is one challenger at a time.
    evidence.propose(&estimate(3.0));
    assert_eq!(evidence.challenger(), Some(estimate(2.0).model));
    assert_eq!(after(&mut evidence, &design, &window(POOR, 1.0)), Ok(None));
    let winner = (estimate(2.0).model, [4.0, 9.0, 16.0]);
    assert_eq!(
        after(&mut evidence, &design, &window(POOR, 1.0)),
        Ok(Some(winner))
    );
    assert_eq!(evidence.challenger(), None);
    // Its sums count together: 1 of 200 in two windows, but 8 of 200 in the next two.
    for (second, won) in [(8.9, true), (9.1, false)] {
        evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        let _ = after(&mut evidence, &design, &window(POOR, 1.0));
        let verdict = after(&mut evidence, &design, &window(POOR, second));
        assert_eq!(verdict.is_ok_and(|v| v.is_some()), won, "{second}");
    }
    Ok(())
}

#[test]
fn a_challenger_that_is_not_clearly_better_or_fits_poorly_is_refused() -> Result<(), Error> {
    let design = design()?;
    for (own, reason) in [
        (43.0, Reason::NotBetter),
        (f32::NAN, Reason::NotBetter),
        (16.0, Reason::PoorFit),
    ] {
        let mut evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        let verdict = after(&mut evidence, &design, &window(POOR, own));
        assert_eq!(verdict, Err(reason), "{own}");
        assert_eq!(evidence.challenger(), None);
    }
    // Better by a share, but of next to nothing.
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    let small = POOR.map(|sum| 0.1 * sum);
    let verdict = after(&mut evidence, &design, &window(small, 0.0));
    assert_eq!(verdict, Err(Reason::NotBetter));
    Ok(())
}

#[test]
fn far_better_is_good_enough_after_a_window_more() -> Result<(), Error> {
    let design = design()?;
    // A quarter of the errors of the model in use, which leaves 60, and half of what moved.
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    for _ in 0..2 {
        assert_eq!(after(&mut evidence, &design, &window(POOR, 14.0)), Ok(None));
    }
    let verdict = after(&mut evidence, &design, &window(POOR, 14.0));
    assert_eq!(verdict, Ok(Some((estimate(2.0).model, [4.0, 9.0, 16.0]))));
    // All are astray: none of them is a model of this axis.
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    let astray = POOR.map(|sum| 10.0 * sum);
    let verdict = after(&mut evidence, &design, &window(astray, 51.0));
    assert_eq!(verdict, Err(Reason::PoorFit));
    Ok(())
}

#[test]
fn the_simpler_change_is_right_until_the_other_is_clearly_better() -> Result<(), Error> {
    let design = design()?;
    for (left, simpler) in [(2.0, true), (20.0, false)] {
        let bank = LOAD.map(|sum| if sum == 0.0 { left } else { sum });
        let mut evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        let _ = after(&mut evidence, &design, &window(bank, 1.0));
        let found = after(&mut evidence, &design, &window(bank, 1.0));
        let Ok(Some((model, variances))) = found else {
            panic!("{found:?}");
        };
        assert_eq!(variances == bank::variances(&model), simpler);
        let gain = model.b0 / model.a1 / (USED.b0 / USED.a1);
        assert_eq!((gain - 1.0).abs() < 1e-6, simpler, "{model:?}");
        assert_eq!(model == estimate(2.0).model, !simpler);
    }
    Ok(())
}

#[test]
fn a_model_of_the_bank_needs_no_estimate_but_one_window_more() -> Result<(), Error> {
    let design = design()?;
    let mut evidence = Evidence::NONE;
    let alone = |bank| Sums {
        challenger: None,
        ..window(bank, 0.0)
    };
    assert_eq!(after(&mut evidence, &design, &alone(LOAD)), Ok(None));
    assert_eq!(evidence.challenger(), None, "one window is none");
    assert_eq!(after(&mut evidence, &design, &alone(LOAD)), Ok(None));
    let model = evidence.challenger().unwrap_or(USED);
    assert!((model.a1 / USED.a1 - 1.732).abs() < 1e-3, "{model:?}");
    // Its own sums are those of later windows.
    let found = after(&mut evidence, &design, &window(LOAD, 1.0));
    let Ok(Some((model, variances))) = found else {
        panic!("{found:?}");
    };
    assert!((model.a1 / USED.a1 - 1.732).abs() < 1e-3, "{model:?}");
    assert_eq!(variances, bank::variances(&model));
    // One that was verified before needs one window, too, and comes before an estimate.
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    evidence.reconsider(estimate(3.0).model);
    let verdict = after(&mut evidence, &design, &window(POOR, 1.0));
    assert_eq!(verdict, Ok(Some((estimate(3.0).model, UNKNOWN))));
    Ok(())
}

#[test]
fn windows_that_speak_for_the_model_in_use_count_against_a_bank() -> Result<(), Error> {
    let design = design()?;
    let alone = |bank, moved| Sums {
        challenger: None,
        moved,
        ..window(bank, 0.0)
    };
    // The model in use leaves nothing, a load of 1.73 half of what moved.
    let good = LOAD.map(|sum| match sum {
        0.0 => 50.0,
        60.0 => 0.0,
        other => other,
    });
    // A large movement outweighs two small ones, and is forgotten by and by.
    let mut evidence = Evidence::NONE;
    let _ = after(
        &mut evidence,
        &design,
        &alone(good.map(|s| 20.0 * s), 2000.0),
    );
    let mut windows = 0;
    while evidence.challenger().is_none() && windows < 20 {
        let _ = after(&mut evidence, &design, &alone(LOAD, 100.0));
        windows += 1;
    }
    assert!((4..=8).contains(&windows), "{windows}");
    Ok(())
}
