//! Windows by hand: sums of squares, and what they decide.

mod sums;
mod unexplained;

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
        ..Candidate::known(Model::linear(load * 625.0, 30.0, load * 1.1e6))
    }
}

/// An estimate of half of the velocity gain.
fn weak() -> Candidate {
    Candidate::known(Model::linear(2.0 * 625.0, 30.0, 1e6))
}

fn design() -> Result<SupervisionDesign, Error> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    Ok(Config::new(1e-3, 25.0, travel).resolve()?.supervision)
}

/// The sum of squares that has such a share in itself and in a motion of 100.
fn of_share(share: f32) -> f32 {
    100.0 * share / (1.0 - share)
}

/// A window in which the axis moved by 100 and the bank and the challenger left such shares.
fn window(bank: [f32; bank::SIZE], challenger: f32) -> WindowSums {
    WindowSums {
        bank: bank.map(of_share),
        challenger: Some(of_share(challenger)),
        moved: 100.0,
        weight: 1.0,
    }
}

/// The same window without a challenger.
fn alone(bank: [f32; bank::SIZE]) -> WindowSums {
    WindowSums {
        challenger: None,
        ..window(bank, 0.0)
    }
}

/// Shares: the model in use leaves 0.6, all others of the bank more.
const POOR: [f32; bank::SIZE] = [0.9, 0.8, 0.6, 0.8, 0.9, 0.9, 0.8, 0.8, 0.9];
/// A load of 1.73 leaves nothing.
const LOAD: [f32; bank::SIZE] = [0.9, 0.8, 0.6, 0.0, 0.6, 0.9, 0.8, 0.8, 0.9];

/// The model in use leaves nothing.
const GOOD: [f32; bank::SIZE] = [0.7, 0.7, 0.0, 0.7, 0.7, 0.7, 0.7, 0.7, 0.7];

/// What the evidence says after a window: a model with its deviations, or why there is none.
fn after(
    evidence: &mut Evidence,
    design: &SupervisionDesign,
    window: &WindowSums,
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
    let poor = window(POOR, 0.01);
    assert_eq!(after(&mut evidence, &design, &poor), Ok(None));
    let winner = (estimate(2.0).model, [4.0, 9.0, 16.0]);
    assert_eq!(after(&mut evidence, &design, &poor), Ok(Some(winner)));
    assert_eq!(evidence.challenger(), None);
    // Its windows count together: 0.01 of two, but 0.1 of the next two is too much.
    for (second, won) in [(0.089, true), (0.091, false)] {
        evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        let _ = after(&mut evidence, &design, &poor);
        let found = after(&mut evidence, &design, &window(POOR, second));
        assert_eq!(found.is_ok_and(|won| won.is_some()), won, "{second}");
    }
    Ok(())
}

#[test]
fn small_advantages_have_to_add_up() -> Result<(), Error> {
    let design = design()?;
    // By 0.15 better in each: six are more than 0.8, five are not.
    let close = window(POOR.map(|share| share - 0.44), 0.01);
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    for _ in 0..5 {
        assert_eq!(after(&mut evidence, &design, &close), Ok(None));
    }
    assert!(after(&mut evidence, &design, &close).is_ok_and(|won| won.is_some()));
    Ok(())
}

#[test]
fn an_estimate_that_fits_poorly_and_is_better_by_far_needs_one_window_more() -> Result<(), Error> {
    let design = design()?;
    // 0.06 of the movement is more than may be left, and less than a quarter of 1.5.
    let far = window(POOR.map(|share| share.min(0.6)), 0.06);
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    for _ in 0..2 {
        assert_eq!(after(&mut evidence, &design, &far), Ok(None));
    }
    assert!(after(&mut evidence, &design, &far).is_ok_and(|won| won.is_some()));
    Ok(())
}

#[test]
fn no_window_decides_alone_however_much_it_shows() -> Result<(), Error> {
    let design = design()?;
    for large in [1.0, 1e3, 1e30, f32::INFINITY, f32::NAN] {
        // All but one of the bank and the challenger leave all bounds.
        let astray = WindowSums {
            bank: core::array::from_fn(|k| if k == 3 { 0.0 } else { 10_000.0 * large }),
            ..window(GOOD, 0.0)
        };
        let mut evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        assert_eq!(after(&mut evidence, &design, &astray), Ok(None), "{large}");
        let mut evidence = Evidence::NONE;
        evidence.add(&astray);
        // The windows that follow speak for the model in use.
        let good = window(GOOD, 0.7);
        for _ in 0..20 {
            let verdict = after(&mut evidence, &design, &good);
            assert!(!matches!(verdict, Ok(Some(_))), "{large}: {verdict:?}");
        }
        assert_eq!(evidence.challenger(), None, "{large}");
    }
    Ok(())
}

#[test]
fn a_challenger_that_is_not_clearly_better_or_fits_poorly_is_refused() -> Result<(), Error> {
    let design = design()?;
    for (own, reason) in [
        (0.43, Reason::NotBetter),
        (f32::NAN, Reason::NotBetter),
        (0.06, Reason::PoorFit),
    ] {
        let mut evidence = Evidence::NONE;
        evidence.propose(&weak());
        let verdict = after(&mut evidence, &design, &window(POOR, own));
        assert_eq!(verdict, Err(reason), "{own}");
        assert_eq!(evidence.challenger(), None);
    }
    // Better by a share, but of next to nothing.
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    let small = window(POOR.map(|share| 0.1 * share), 0.0);
    let verdict = after(&mut evidence, &design, &small);
    assert_eq!(verdict, Err(Reason::NotBetter));
    Ok(())
}

#[test]
fn a_simpler_change_that_does_not_explain_what_the_estimate_does_is_none() -> Result<(), Error> {
    let design = design()?;
    for (load, simpler) in [(0.04, true), (0.06, false)] {
        let bank = LOAD.map(|share| if share == 0.0 { load } else { share });
        let mut evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        let _ = after(&mut evidence, &design, &window(bank, 0.03));
        let verdict = after(&mut evidence, &design, &window(bank, 0.03)).unwrap_or(None);
        let same = verdict.is_some_and(|(model, _)| model == estimate(2.0).model);
        assert_eq!(same, !simpler, "{load}");
    }
    Ok(())
}

#[test]
fn of_two_changes_that_explain_the_windows_alike_neither_is_taken() -> Result<(), Error> {
    let design = design()?;
    for (gain, clear) in [(0.06, false), (0.3, true)] {
        let mut bank = LOAD;
        bank[7] = gain;
        let mut evidence = Evidence::NONE;
        let _ = after(&mut evidence, &design, &alone(bank));
        assert_eq!(evidence.challenger().is_some(), clear, "{gain}");
    }
    Ok(())
}

#[test]
fn the_simpler_change_is_right_until_the_other_is_clearly_better() -> Result<(), Error> {
    let design = design()?;
    // Beside an estimate of much more gain the simpler change makes the controller stronger.
    for (left, factor, simpler) in [
        (0.02, 1.1, true),
        (0.2, 1.1, false),
        (0.02, 1.3, false),
        (0.005, 1.3, true),
    ] {
        let bank = LOAD.map(|share| if share == 0.0 { left } else { share });
        let mut evidence = Evidence::NONE;
        let mut estimated = estimate(2.0);
        estimated.model.b0 = factor * 2e6;
        evidence.propose(&estimated);
        let _ = after(&mut evidence, &design, &window(bank, 0.01));
        let found = after(&mut evidence, &design, &window(bank, 0.01));
        let Ok(Some((model, variances))) = found else {
            panic!("{found:?}");
        };
        assert_eq!(variances == bank::variances(&model), simpler);
        let gain = model.b0 / model.a1 / (USED.b0 / USED.a1);
        assert_eq!((gain - 1.0).abs() < 1e-6, simpler, "{model:?}");
        assert_eq!(model == estimated.model, !simpler);
    }
    Ok(())
}

#[test]
fn a_model_of_the_bank_needs_no_estimate_but_one_window_more() -> Result<(), Error> {
    let design = design()?;
    let mut evidence = Evidence::NONE;
    let slight = LOAD.map(|share| 0.5 * share);
    assert_eq!(after(&mut evidence, &design, &alone(slight)), Ok(None));
    assert_eq!(evidence.challenger(), None, "less than 0.35 of a window");
    assert_eq!(after(&mut evidence, &design, &alone(LOAD)), Ok(None));
    let model = evidence.challenger().unwrap_or(USED);
    assert!((model.a1 / USED.a1 - 1.732).abs() < 1e-3, "{model:?}");
    // Its own sums are those of later windows.
    let found = after(&mut evidence, &design, &window(LOAD, 0.01));
    let Ok(Some((model, variances))) = found else {
        panic!("{found:?}");
    };
    assert!((model.a1 / USED.a1 - 1.732).abs() < 1e-3, "{model:?}");
    assert_eq!(variances, bank::variances(&model));
    // One that was verified before needs one window, too, and comes before an estimate.
    evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    evidence.reconsider(estimate(3.0).model);
    let verdict = after(&mut evidence, &design, &window(POOR, 0.01));
    assert_eq!(verdict, Ok(Some((estimate(3.0).model, UNKNOWN))));
    Ok(())
}

#[test]
fn a_verified_model_that_fits_poorly_and_is_not_better_by_far_needs_three_windows()
-> Result<(), Error> {
    let design = design()?;
    // More than a quarter of what the model in use leaves, which is as poor as any other.
    let poor = window([0.9; bank::SIZE], 0.24);
    let mut evidence = Evidence::NONE;
    evidence.reconsider(estimate(3.0).model);
    for _ in 0..2 {
        assert_eq!(after(&mut evidence, &design, &poor), Ok(None));
    }
    let verdict = after(&mut evidence, &design, &poor);
    assert_eq!(verdict, Ok(Some((estimate(3.0).model, UNKNOWN))));
    Ok(())
}

#[test]
fn windows_that_speak_for_the_model_in_use_count_against_a_bank() -> Result<(), Error> {
    let design = design()?;
    // Of two kinds of windows by turns the better half does not decide.
    let mut evidence = Evidence::NONE;
    for k in 0..40 {
        let bank = if k % 2 == 0 { GOOD } else { LOAD };
        let _ = after(&mut evidence, &design, &alone(bank));
        assert_eq!(evidence.challenger(), None, "{k}");
    }
    for _ in 0..20 {
        let _ = after(&mut evidence, &design, &alone(GOOD));
    }
    // What was before is forgotten by and by.
    let mut windows = 0;
    while evidence.challenger().is_none() && windows < 20 {
        let _ = after(&mut evidence, &design, &alone(LOAD));
        windows += 1;
    }
    assert!((4..=8).contains(&windows), "{windows}");
    Ok(())
}
