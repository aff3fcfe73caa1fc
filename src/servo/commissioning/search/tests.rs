//! What a search takes for noise, how long it simulates, and what it ranks its starts by.

use super::*;
use crate::servo::commissioning::oracle::Dice;
use crate::servo::commissioning::predictor::Prediction;
use crate::servo::commissioning::sweep::Sweep;
use crate::servo::commissioning::tests::design;
use crate::servo::commissioning::verdict::tests::THETA;
use crate::servo::commissioning::{Commissioning, Progress};

/// An axis that stays, as a sensor sees it that is wrong by `noise` to either side.
fn record(noise: f32) -> MotionRecord {
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    for k in 0..400 {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        record.push(0.5 + side * noise, 0.0);
    }
    record
}

#[test]
fn an_error_within_three_deviations_of_the_noise_speaks_against_no_model() {
    for sigma in [1e-5_f32, 1e-3] {
        // The simulation begins at the last position that it is told: 0 and 2 of noise away from
        // the next ones.
        let three = 3.0 * sigma / sqrt(2.0);
        for (noise, exact) in [(0.98 * three, 1.0), (1.02 * three, 0.0)] {
            let record = record(noise);
            let mut search = Search::new(1e-3, 0.0, None);
            search.begin(0, View::of(4e-3, sigma, 1.0), sigma, [20.0, 0.0]);
            let view = search.window(&record);
            search.simulate(&record, view, THETA, 200);
            let found = (0..400).find_map(|_| search.misfit(&record));
            let [misfit, silent] = found.expect("the end of the record");
            assert_eq!(silent, exact, "{sigma} {noise}");
            // What does not move is no movement that a model could explain.
            let square = noise * noise;
            let expected = 2.0 * square / (square + 0.005 * 0.005);
            assert!(
                (misfit / expected - 1.0).abs() < 0.01,
                "{misfit} {expected}"
            );
        }
    }
}

#[test]
fn a_free_simulation_takes_four_and_a_half_of_the_time_of_the_drive_within_its_range() {
    let mut search = Search::new(1e-3, 0.0, None);
    search.begin(0, View::of(4e-3, 1e-5, 1.0), 1e-5, [20.0, 0.0]);
    // 0.225 s, 0.1 s at least and 0.4 s at most.
    for (w, points) in [(20.0_f32, 56), (100.0, 25), (5.0, 100)] {
        let theta = Theta { a1: w * w, ..THETA };
        assert!(search.points(&theta).abs_diff(points) <= 1, "{w}");
    }
}

/// A drive of 20 rad/s under random levels, more points of it than a fit reads.
fn driven() -> MotionRecord {
    let mut dice = Dice::new(1);
    let mut at = Prediction {
        x: 0.5,
        ..Prediction::default()
    };
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    let mut u = 0.0;
    for k in 0..WINDOW + 100 {
        if k % 15 == 0 {
            u = 0.4 * dice.roll() - 0.3 * (at.x - 0.5).signum();
        }
        record.push(at.x, u);
        let direction = at.v.signum();
        THETA.slide(&mut at, THETA.flow(u), direction, 4e-3);
    }
    record
}

#[test]
fn a_start_is_ranked_by_the_last_two_fifths_of_what_it_was_fitted_to() {
    let record = driven();
    let mut search = Search::new(1e-3, 0.0, Some(0.0));
    search.begin(0, View::of(4e-3, 1e-5, 1.0), 1e-5, [20.0, 0.03]);
    while !matches!(search.phase, Phase::Ranking(_)) {
        assert_eq!(search.update(&record, 1.0), None);
    }
    let theta = search.started.expect("a drive that shows itself");
    let release = record.end() - WINDOW * 2 / 5;
    let mut expected = search.clone();
    let view = search.window(&record);
    expected.simulate(&record, view, theta, release);
    assert_eq!(search.simulation, expected.simulation);
}

#[test]
fn a_model_is_held_out_from_points_behind_its_fit() {
    let record = driven();
    let mut search = Search::new(1e-3, 0.0, Some(0.0));
    search.begin(0, View::of(4e-3, 1e-5, 1.0), 1e-5, [20.0, 0.03]);
    for _ in 0..100_000 {
        assert_eq!(search.update(&record, 1.0), None);
        if let Phase::Holding(from, until) = search.phase {
            assert_eq!(from, search.fit.end());
            assert_eq!(until, from + search.points(&search.fit.found()));
            return;
        }
    }
    panic!("a fit has an end");
}

/// Whether an estimate is accepted so many s after the begin that changed its gain by a share.
fn accepted(time: f32, change: f32) -> bool {
    let mut commissioning = Commissioning::new(design());
    commissioning.time = time;
    commissioning.record = record(0.0);
    let search = &mut commissioning.search;
    search.begin(0, View::of(4e-3, 1e-5, 1.0), 1e-5, [20.0, 0.0]);
    let found = search.fit.found();
    search.previous = Some(Theta {
        b0: found.b0 / (1.0 + change),
        ..found
    });
    search.fit.know([0.0; 4]);
    let view = search.window(&commissioning.record);
    search.simulate(&commissioning.record, view, found, 200);
    search.phase = Phase::Validating;
    for _ in 0..400 {
        let sweep = Sweep::new(0.5, 0.2, 0.03, 0.5, 1);
        let progress = commissioning.sweep(sweep, 0.5, 0.0);
        if let Some(refusal) = commissioning.search.refusal() {
            assert_eq!(refusal, Reason::Uncertain);
            return false;
        }
        if let Progress::Found(..) = progress {
            return true;
        }
    }
    panic!("a validation has an end");
}

#[test]
fn bounds_widen_by_six_tenths_between_the_second_and_the_third_second() {
    for (time, slack) in [
        (0.5, 1.0),
        (1.7, 1.0),
        (2.05, 1.15),
        (2.3, 1.3),
        (2.8, 1.6),
        (9.0, 1.6),
    ] {
        assert!(accepted(time, 0.98 * 0.15 * slack), "{time}");
        assert!(!accepted(time, 1.02 * 0.15 * slack), "{time}");
    }
}

#[test]
fn starts_are_tried_until_one_follows_and_the_best_one_is_refined() {
    let record = record(0.0);
    let other = Theta { a2: 30.0, ..THETA };
    let begun = || {
        let mut search = Search::new(1e-3, 0.0, None);
        search.begin(0, View::of(4e-3, 1e-5, 1.0), 1e-5, [20.0, 0.0]);
        search
    };
    for (misfits, best, latest) in [
        (&[0.03][..], 0, Some(THETA)),
        (&[0.05, 0.5, 0.039], 2, Some(THETA)),
        (&[0.5, 0.05, f32::NAN, 0.06], 1, Some(THETA)),
        (&[0.5, 0.31, 0.4, 0.6], 1, None),
    ] {
        let mut search = begun();
        for (k, misfit) in misfits.iter().enumerate() {
            assert_eq!(search.phase == Phase::Refining, k == misfits.len());
            search.started = Some(if k == best { THETA } else { other });
            search.ranked(&record, k, *misfit);
            let tries = (k + 1 < misfits.len()).then_some(Phase::Trying(k + 1));
            assert_eq!(
                search.phase,
                tries.unwrap_or(Phase::Refining),
                "{misfits:?}"
            );
        }
        assert_eq!(search.best.map(|(theta, _)| theta), Some(THETA));
        assert_eq!(search.latest().copied(), latest, "{misfits:?}");
        assert_eq!(search.refusal(), None);
    }
    // No start that shows a drive: they are tried again.
    let mut search = begun();
    search.ranked(&record, 3, f32::NAN);
    assert_eq!(search.phase, Phase::Trying(0));
    assert_eq!(search.refusal(), Some(Reason::PoorFit));
}
