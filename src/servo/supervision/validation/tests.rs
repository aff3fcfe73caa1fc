//! Windows on drives of the bank: what each model leaves, and how much a window counts.

use super::*;
use crate::servo::config::Config;
use crate::servo::error::Error;
use crate::servo::motion::Travel;

const USED: Model = Model::linear(900.0, 15.0, 9e5);

/// A window on a drive under a flow that changes its sign so often per second.
fn seen(
    drive: &Model,
    challenger: Option<Model>,
    per_second: f32,
) -> Result<ValidationWindow, Error> {
    seen_by(&USED, drive, challenger, per_second, 0.0)
}

/// The same with another model in use, of whose dead zone so much is not known.
fn seen_by(
    used: &Model,
    drive: &Model,
    challenger: Option<Model>,
    per_second: f32,
    unknown: f32,
) -> Result<ValidationWindow, Error> {
    seen_there(1.0, used, drive, challenger, per_second, unknown)
}

/// The same where the drive is so many times as stiff as in the middle.
fn seen_there(
    stiffness: f32,
    used: &Model,
    drive: &Model,
    challenger: Option<Model>,
    per_second: f32,
    unknown: f32,
) -> Result<ValidationWindow, Error> {
    let (a1, b0) = (stiffness * drive.a1, stiffness * drive.b0);
    let there = Model { a1, b0, ..*drive };
    let at = |flow| PlacedFlow { flow, stiffness };
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let design = Config::new(1e-3, 30.0, travel).resolve()?.supervision;
    let mut motion = Motion::at(200.0);
    let mut window = ValidationWindow::none(&design.validation);
    window.begin(&design.validation, used, challenger, motion, at(0.0));
    let mut samples = 0;
    while !window.is_over() {
        let turned = libm::sinf(per_second * core::f32::consts::PI * 1e-3 * samples as f32);
        let flow = if turned < 0.0 { -0.3 } else { 0.3 };
        window.update(at(flow), motion.position, motion.velocity);
        there.advance(&mut motion, flow - libm::copysignf(unknown, flow), 1e-3);
        samples += 1;
    }
    assert_eq!(
        samples,
        design.validation.observe + design.validation.window
    );
    while !window.explain() {}
    Ok(window)
}

/// Root mean square of what moved.
fn rms(window: &ValidationWindow) -> f32 {
    let moved = window.sums(0.0, 1.0, 0.0).map_or(0.0, |sums| sums.moved);
    sqrt(moved / window.samples as f32)
}

#[test]
fn the_model_of_the_drive_leaves_least_whatever_it_is() -> Result<(), Error> {
    for (k, drive) in bank::about(&USED).into_iter().enumerate() {
        let window = seen(&drive, None, 4.0)?;
        let sums = window.sums(0.0, 1.0, 0.0).unwrap_or(WindowSums {
            bank: [f32::NAN; bank::SIZE],
            challenger: None,
            weight: f32::NAN,
            moved: 0.0,
        });
        for (j, sum) in sums.bank.iter().enumerate() {
            let right = *sum < 1e-4 * sums.moved;
            assert_eq!(right, j == k, "{k}: {sums:?}");
        }
    }
    Ok(())
}

#[test]
fn near_an_end_the_model_of_the_middle_leaves_least_not_one_as_stiff_as_the_axis_is_there()
-> Result<(), Error> {
    for stiffness in [1.3_f32, 1.732, 2.5] {
        for (k, drive) in bank::about(&USED).into_iter().enumerate() {
            let window = seen_there(stiffness, &USED, &drive, None, 4.0, 0.0)?;
            let sums = window.sums(0.0, 1.0, 0.0).expect("it moves");
            let own = sums.bank[k];
            // The velocity that the place acts on is held for a sample.
            assert!(own < 4e-3 * sums.moved, "{stiffness}, {k}: {sums:?}");
            for (j, sum) in sums.bank.iter().enumerate() {
                assert!(j == k || *sum > 4.0 * own, "{stiffness}, {k}: {sums:?}");
            }
        }
    }
    Ok(())
}

#[test]
fn a_challenger_runs_beside_them_and_is_reported() -> Result<(), Error> {
    let drive = Model::linear(400.0, 30.0, 6e5);
    let window = seen(&drive, Some(drive), 3.0)?;
    let Some(sums) = window.sums(1.0, 1.0, 0.0) else {
        panic!("the axis moved");
    };
    assert!(sums.challenger.is_some_and(|sse| sse < 1e-3 * sums.moved));
    let report = window.report(&sums);
    assert!(report.r_squared() > 0.999, "{report:?}");
    let own = window.runners[bank::USED].errors.squares;
    assert!(own >= sums.bank[bank::USED] && report.incumbent_sse == Some(own));
    assert_eq!((report.sst, report.samples), (sums.moved, window.window));
    // Without one the report is that of the model in use.
    let window = seen(&drive, None, 3.0)?;
    let report = window.report(&WindowSums {
        challenger: None,
        ..sums
    });
    assert_eq!(Some(report.sse), report.incumbent_sse);
    Ok(())
}

#[test]
fn a_dead_zone_that_is_not_quite_known_speaks_against_no_model() -> Result<(), Error> {
    // Half of it: 0.06 of a flow of 0.3, a fifth of the velocity. The observer is faster than one
    // of the drives and slower than the other.
    let used = Model {
        dead_zone: 0.12,
        ..USED
    };
    let quick = Model {
        dead_zone: 0.12,
        ..Model::linear(5e4, 60.0, 7.5e7)
    };
    for used in [used, quick] {
        for unknown in [-0.06, -0.03, 0.03, 0.06] {
            for per_second in [0.0, 4.0] {
                let window = seen_by(&used, &used, None, per_second, unknown)?;
                let sums = window.sums(0.0, 1.0, 0.0).expect("it moves");
                let own = sums.bank[bank::USED];
                let all = window.report(&sums).sse;
                assert!(own < 1e-3 * all, "{unknown}: {own} of {all}");
            }
        }
    }
    // Of another gain or load there is something left.
    for (k, drive) in bank::about(&used).into_iter().enumerate() {
        let window = seen_by(&used, &drive, None, 4.0, 0.0)?;
        let sums = window.sums(0.0, 1.0, 0.0).expect("it moves");
        let own = sums.bank[bank::USED];
        assert_eq!(own > 1e-4 * sums.moved, k != bank::USED, "{k}: {sums:?}");
    }
    Ok(())
}

#[test]
fn errors_of_a_grain_say_nothing_and_those_beyond_it_what_exceeds_it() -> Result<(), Error> {
    let drive = Model { b0: 8e5, ..USED };
    let window = seen(&drive, Some(drive), 4.0)?;
    let left = |grain| window.sums(0.0, 1.0, grain).expect("it moves");
    let (all, count) = (left(0.0), window.samples as f32);
    let rms = sqrt(all.bank[bank::USED] / count);
    let half = left(0.5 * rms);
    for (beyond, sse) in half.bank.iter().zip(all.bank) {
        let exact = f32::max(sse - 0.25 * rms * rms * count, 0.0);
        assert!((beyond - exact).abs() < 1e-4 * sse);
    }
    assert_eq!(half.challenger, Some(0.0));
    assert_eq!(left(1.01 * rms).bank[bank::USED], 0.0);
    assert_eq!((half.moved, half.weight), (all.moved, all.weight));
    Ok(())
}

#[test]
fn a_window_without_motion_shows_nothing() -> Result<(), Error> {
    let window = seen(&USED, None, 4.0)?;
    let rms = rms(&window);
    let at = |least| window.sums(least, 1.0, 0.0);
    assert!(at(0.99 * rms).is_some() && at(1.01 * rms).is_none());
    Ok(())
}

#[test]
fn a_window_counts_by_its_motion_up_to_a_whole_one() -> Result<(), Error> {
    let window = seen(&USED, None, 4.0)?;
    let rms = rms(&window);
    for (whole, weight) in [(0.0, 1.0), (0.5, 1.0), (1.0, 1.0), (2.0, 0.5), (8.0, 0.125)] {
        let found = window.sums(0.0, whole * rms, 0.0).map(|sums| sums.weight);
        let found = found.unwrap_or(f32::NAN);
        assert!((found - weight).abs() < 1e-5, "{whole}: {found}");
    }
    Ok(())
}

#[test]
fn a_share_is_the_weight_at_most_whatever_the_errors() {
    let sums = WindowSums {
        bank: core::array::from_fn(|k| [0.0, 1.0, 3.0, 1e38, f32::INFINITY][k.min(4)]),
        challenger: Some(f32::NAN),
        moved: 1.0,
        weight: 1.0,
    };
    for weight in [1.0, 0.5, 0.125] {
        let shares = WindowSums { weight, ..sums }.shares();
        assert_eq!(shares.bank[..3], [0.0, 0.5 * weight, 0.75 * weight]);
        assert!(shares.bank[3..].iter().all(|share| *share == weight));
        assert_eq!((shares.challenger, shares.moved), (Some(weight), weight));
    }
}

#[test]
fn a_share_that_is_explained_is_one_of_the_movement() {
    let report = |sse, sst| FitReport {
        sse,
        sst,
        ..FitReport::default()
    };
    assert_eq!(report(1.0, 4.0).r_squared(), 0.75);
    assert_eq!(report(8.0, 4.0).r_squared(), -1.0);
    assert_eq!(report(1.0, 0.0).r_squared(), f32::NEG_INFINITY);
}

#[test]
fn a_small_motion_keeps_its_digits_far_from_zero() -> Result<(), Error> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let design = Config::new(1e-3, 30.0, travel).resolve()?.supervision;
    let place = |k: u32| 390.0 + 0.02 * libm::sinf(0.2 * k as f32);
    let rest = PlacedFlow {
        flow: 0.0,
        stiffness: 1.0,
    };
    let mut window = ValidationWindow::none(&design.validation);
    window.begin(&design.validation, &USED, None, Motion::at(place(0)), rest);
    for k in 0.. {
        window.update(rest, place(k), 0.0);
        if window.is_over() {
            break;
        }
    }
    let found = rms(&window) / (0.02 * core::f32::consts::FRAC_1_SQRT_2);
    assert!((found - 1.0).abs() < 0.05, "{found}");
    Ok(())
}
