//! What a fit finds.

use super::*;
use crate::servo::commissioning::predictor::Prediction;
use crate::servo::control::load::loss_over_gain;
use crate::servo::control::place::stiffness;

const TIME: f32 = 5e-3;
/// Standard deviation of the position in travels.
const SIGMA: f32 = 1e-4;

/// A drive of 30 rad/s under random commands, each held for 12 points, in the middle of its travel.
fn record(seed: u32, points: usize) -> (MotionRecord, View, Theta) {
    let truth = Theta::from_array([900.0, 18.0, 1800.0, 0.03, 0.01, 1.0, 8e-3, 0.0, 0.0, 0.0]);
    let (record, view) = record_of(&truth, seed, points);
    (record, view, truth)
}

/// The same of this drive.
fn record_of(truth: &Theta, seed: u32, points: usize) -> (MotionRecord, View) {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    let mut at = Prediction {
        x: 0.5,
        ..Prediction::default()
    };
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    let (mut u, mut before) = (0.0, [0.0; 3]);
    for k in 0..points {
        if k % 12 == 0 {
            u = 0.4 * random() - 0.3 * (at.x - 0.5).signum();
        }
        let noise = SIGMA * (random() + random() + random());
        record.push(at.x + noise, u);
        before = [u, before[0], before[1]];
        let part = truth.delay / TIME - 1.0;
        let flow = truth.mean_flow([before[1], before[2], part]);
        let direction = at.v.signum();
        let stiffer = truth.stiffer(stiffness(truth.stiffening, at.x));
        stiffer.slide(&mut at, flow, direction, TIME);
    }
    let view = View {
        end: points,
        ..View::of(TIME, SIGMA, 1.0)
    };
    (record, view)
}

/// Until the fit is done.
fn run(fit: &mut Fit, record: &MotionRecord) {
    while !(fit.advance(record, 50) && fit.next_pass() && fit.is_done(8)) {}
}

#[test]
fn what_goes_on_finds_what_a_fit_of_all_points_finds() {
    for seed in 1..=40 {
        let (record, view, truth) = record(seed, 300);
        let mut early = Fit::new(true);
        let start = Theta {
            a1: 1.3 * truth.a1,
            b0: 0.8 * truth.b0,
            friction: 0.0,
            ..truth
        };
        early.begin(View { end: 200, ..view }, start, 2.0);
        run(&mut early, &record);
        assert!(!early.went_on(), "seed {seed}");
        let before = early.found();
        assert!(early.go_on(300), "seed {seed}");
        run(&mut early, &record);
        let mut whole = Fit::new(true);
        whole.begin(view, before, 2.0);
        run(&mut whole, &record);
        // A search begins anew what went on and has more to gain.
        assert!(early.went_on() && !whole.went_on(), "seed {seed}");
        let (added, all) = (early.found(), whole.found());
        while !whole.weigh() {}
        let std = whole.std();
        let errors = [
            (added.a1 / all.a1 - 1.0, std[0]),
            (added.b0 / added.a1 * all.a1 / all.b0 - 1.0, std[2]),
            ((added.dead_zone - all.dead_zone) / 0.05, std[3]),
        ];
        for (error, std) in errors {
            assert!(error.abs() < 0.5 * std, "seed {seed}: {error} of {std}");
        }
    }
}

#[test]
fn what_has_not_ended_well_does_not_go_on() {
    let (record, view, truth) = record(7, 200);
    let mut fit = Fit::new(true);
    assert!(!fit.go_on(200));
    fit.begin(view, truth, 2.0);
    assert!(!fit.go_on(200));
    assert!(!fit.advance(&record, 1) && !fit.advance(&record, 50));
    assert!(!fit.go_on(200));
}

#[test]
fn a_correction_is_as_quick_as_it_is_told_and_its_points_allow() {
    let (_, view, truth) = record(1, 40);
    let mut fit = Fit::new(false);
    fit.begin(view, truth, 0.5);
    assert!((fit.rate - 15.0).abs() < 1e-4);
    assert_eq!(fit.end(), 40);
    fit.begin(view, truth, 100.0);
    assert!((fit.rate * TIME / STEP_MAX - 1.0).abs() < 1e-5);
}

#[test]
fn a_pass_adds_nothing_before_its_correction_has_settled() {
    let (record, view, truth) = record(1, 300);
    for (correction, settled) in [(1.0, 13), (2.0, 6)] {
        let mut fit = Fit::new(true);
        fit.begin(view, truth, correction);
        // Two time constants of it, of 33 and 17 ms.
        assert!(!fit.advance(&record, 1));
        assert_eq!(fit.settled, settled, "{correction}");
    }
}

#[test]
fn a_pass_reads_nothing_behind_the_end_of_its_view() {
    for reach in 1..=3 {
        let [alone, followed] = [200, 260].map(|points| {
            let (record, view, truth) = record(1, points);
            let mut fit = Fit::new(true);
            let view = View {
                end: 200,
                reach,
                ..view
            };
            fit.begin(view, truth, 2.0);
            run(&mut fit, &record);
            fit
        });
        assert_eq!(alone, followed, "{reach}");
    }
}

#[test]
fn a_pass_that_takes_less_than_a_tenth_from_the_cost_is_the_last_one() {
    let (_, view, truth) = record(1, 40);
    for (cost, better, last, damping) in [
        (0.89, true, false, 2e-3),
        (0.91, true, true, 2e-3),
        (1.01, false, false, 0.1),
        (f32::NAN, false, false, 0.1),
    ] {
        let mut fit = Fit::new(true);
        fit.begin(view, truth, 2.0);
        (fit.best_sums.cost, fit.sums.cost) = (1.0, cost);
        assert!(!fit.next_pass());
        assert_eq!((fit.follows, fit.is_done(2)), (better, last), "{cost}");
        assert!(fit.is_done(1), "there was one pass");
        assert!((fit.damping / damping - 1.0).abs() < 1e-5, "{cost}");
        assert_eq!(fit.best_sums.cost, if better { cost } else { 1.0 });
    }
}

#[test]
fn the_first_three_points_after_a_start_do_not_count() {
    let (_, view, truth) = record(1, 100);
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    for k in 0..100 {
        record.push(0.5 + 0.004 * (k as f32 - 50.0).max(0.0), 0.0);
    }
    let mut fit = Fit::new(true);
    fit.begin(view, truth, 2.0);
    while !fit.advance(&record, 50) {}
    let points = 0..100 - view.beyond();
    let moving = points.filter(|i| !Point::of(&record, *i, &view).rests);
    assert_eq!(fit.sums.count as usize, moving.count() - 3);
}

#[test]
fn what_must_be_seen_is_drawn_to_what_is_usual_and_the_delay_is_not() {
    let (_, view, truth) = record(1, 40);
    let found = Theta {
        kappa: 2.0,
        stiffening: 1.0,
        ..truth
    };
    for (knows, usual) in [(true, 1.0), (false, 2.2)] {
        let mut fit = Fit::new(knows);
        fit.begin(view, found, 2.0);
        for j in 0..PARAMETERS {
            fit.best_sums.normal[j][j] = 1.0;
            fit.best_sums.gradient[j] = 0.5;
        }
        (fit.best_sums.cost, fit.best_sums.count) = (1e4, 99);
        fit.factor();
        let Some(Ending::Halved(gradient)) = fit.ending else {
            panic!("{:?}", fit.ending);
        };
        let prior = fit.best_sums.prior(&scales(&found));
        let best = found.to_array();
        for (j, found) in gradient.into_iter().enumerate() {
            let exact = match j {
                5 => 0.5 - prior[j] * best[j],
                // The loss of a drive of this stiffening, over a gain of 2.
                7 => 0.5 - prior[j] * (2.0 - 2.0 * loss_over_gain(1.0)),
                8 => 0.5 - prior[j] * (1.0 - usual),
                _ => 0.5,
            };
            let error = (found / exact - 1.0).abs();
            assert!(error < 1e-5, "{j}: {found}, not {exact}");
        }
    }
}

#[test]
fn a_step_is_half_of_a_scale_at_most_or_a_whole_one() {
    let (_, view, _) = record(1, 40);
    let best = Theta::from_array([900.0, 18.0, 1800.0, 0.1, 0.01, 10.0, 8e-3, 5.0, 1.5, 0.05]);
    for side in [1.0, -1.0] {
        let mut fit = Fit::new(true);
        fit.begin(view, best, 2.0);
        for j in 0..PARAMETERS {
            fit.best_sums.normal[j][j] = 1.0;
            fit.best_sums.gradient[j] = side * 1e7;
        }
        (fit.best_sums.cost, fit.best_sums.count) = (1e-4, 100);
        fit.ending = Some(Ending::Judged);
        while !fit.next_pass() {}
        let (found, best) = (fit.found().to_array(), best.to_array());
        // Stiffness, damping and gain are scales of their own, and may not change their sign.
        for (j, scale) in scales(&fit.best).into_iter().enumerate() {
            let part = side * (found[j] - best[j]) / scale;
            let most = if j < 3 { 0.5 } else { 1.0 };
            assert!((part - most).abs() < 1e-3, "{side} {j}: {part}");
        }
    }
}

#[test]
fn a_drive_that_is_known_loses_as_much_as_goes_with_its_stiffening() {
    for (stiffening, lost) in [(0.0, 0.0), (3.2, 2.4)] {
        let (record, view, truth) = record(3, 300);
        let start = Theta {
            kappa: 3.0,
            stiffening,
            ..truth
        };
        let [known, free] = [true, false].map(|knows| {
            let mut fit = Fit::new(knows);
            fit.begin(view, start, 2.0);
            run(&mut fit, &record);
            fit.found()
        });
        let found = known.kappa * known.a1 / known.b0;
        assert!((found - lost).abs() < 0.05, "{found} of {lost}");
        assert_eq!(known.stiffening, stiffening);
        // What is not known is searched: this drive loses nothing.
        let found = free.kappa * free.a1 / free.b0;
        assert!((found - lost).abs() > 0.05, "{found}");
    }
}

#[test]
fn an_imbalance_is_no_offset_of_the_valve() {
    for seed in 1..=20 {
        // Of a cylinder with air, and of a drive as stiff everywhere.
        for (imbalance, stiffening) in [(-0.15, 3.2), (0.15, 3.2), (-0.15, 0.0), (0.15, 0.0)] {
            let truth = Theta {
                kappa: 2.0 * loss_over_gain(stiffening),
                stiffening,
                imbalance,
                ..record(seed, 0).2
            };
            let (record, view) = record_of(&truth, seed, 350);
            let mut fit = Fit::new(true);
            let start = Theta {
                offset: 0.0,
                imbalance: 0.0,
                ..truth
            };
            fit.begin(view, start, 2.0);
            run(&mut fit, &record);
            let found = fit.found();
            let error = found.imbalance - imbalance;
            assert!(error.abs() < 0.03, "{seed}: {error} of {imbalance}");
            let offset = found.offset - truth.offset;
            assert!(offset.abs() < 0.01, "{seed}: {offset}");
        }
    }
}
