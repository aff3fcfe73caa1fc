//! Challengers that do not explain the movement.

use super::*;

/// The window of a kind by which an estimate of twice the load has won, of the first nine.
fn wins_by(design: &SupervisionDesign, window: &WindowSums) -> Option<u32> {
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    (1..10).find(|_| after(&mut evidence, design, window).is_ok_and(|winner| winner.is_some()))
}

#[test]
fn far_better_is_good_enough_after_a_window_more() -> Result<(), Error> {
    let design = design()?;
    // A quarter of the errors of the model in use, which leaves 0.6, and half of what moved.
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    let far = window(POOR, 0.14);
    for _ in 0..2 {
        assert_eq!(after(&mut evidence, &design, &far), Ok(None));
    }
    let found = after(&mut evidence, &design, &far);
    assert_eq!(found, Ok(Some((estimate(2.0).model, [4.0, 9.0, 16.0]))));
    Ok(())
}

#[test]
fn a_model_that_explains_little_wins_by_many_windows_unless_it_makes_the_loop_stronger()
-> Result<(), Error> {
    let design = design()?;
    // All are astray, one of them less: by 0.39 in each, 1.5 in four.
    let window = window([0.9; bank::SIZE], 0.51);
    let mut evidence = Evidence::NONE;
    evidence.propose(&estimate(2.0));
    for _ in 0..3 {
        assert_eq!(after(&mut evidence, &design, &window), Ok(None));
    }
    let verdict = after(&mut evidence, &design, &window);
    assert_eq!(verdict, Ok(Some((estimate(2.0).model, [4.0, 9.0, 16.0]))));
    let mut evidence = Evidence::NONE;
    evidence.propose(&weak());
    assert_eq!(after(&mut evidence, &design, &window), Err(Reason::PoorFit));
    // One that explains them may.
    let mut evidence = Evidence::NONE;
    evidence.propose(&weak());
    let poor = self::window(POOR, 0.01);
    assert_eq!(after(&mut evidence, &design, &poor), Ok(None));
    let verdict = after(&mut evidence, &design, &poor).unwrap_or(None);
    assert_eq!(verdict.map(|(model, _)| model), Some(weak().model));
    Ok(())
}

#[test]
fn a_model_that_explains_little_has_to_be_better_by_a_window_and_a_half() -> Result<(), Error> {
    let design = design()?;
    // By 0.29 in each: 1.45 in five, 1.74 in six.
    let window = window([0.9; bank::SIZE], 0.61);
    assert_eq!(wins_by(&design, &window), Some(6));
    Ok(())
}

#[test]
fn half_of_the_movement_is_not_far_better_where_the_model_in_use_leaves_the_rest()
-> Result<(), Error> {
    let design = design()?;
    // A third of a window, but more than a quarter of what the model in use leaves.
    let window = window([0.9; bank::SIZE], 0.35);
    assert_eq!(wins_by(&design, &window), Some(4));
    Ok(())
}

#[test]
fn a_loop_is_stronger_on_less_than_nine_tenths_of_the_velocity_gain() -> Result<(), Error> {
    let design = design()?;
    let window = window([0.9; bank::SIZE], 0.51);
    for load in [0.5_f32, 1.0, 2.0] {
        for (gain, refused) in [(0.89, true), (0.91, false), (1.5, false)] {
            let model = Model::linear(load * 625.0, 25.0, gain * load * 1e6);
            let mut evidence = Evidence::NONE;
            evidence.propose(&Candidate::known(model));
            let verdict = after(&mut evidence, &design, &window);
            let exact = if refused {
                Err(Reason::PoorFit)
            } else {
                Ok(None)
            };
            assert_eq!(verdict, exact, "{load} {gain}");
        }
    }
    Ok(())
}
