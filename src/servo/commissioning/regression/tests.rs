//! The first model, from records of drives that are known.

use super::*;
use crate::servo::commissioning::oracle::Dice;
use crate::servo::commissioning::predictor::Prediction;

const TIME: f32 = 4e-3;

/// A record of `truth` under steps of the command of 12 points, each another one.
fn record(truth: &Theta, sign: f32, dice: &mut Dice) -> (MotionRecord, View) {
    let mut at = Prediction {
        x: 0.5,
        ..Prediction::default()
    };
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    let mut commands = [0.0; 8];
    for k in 0..500 {
        let mut u = commands[0];
        if k % 12 == 0 {
            u = 0.4 * dice.roll() - 0.3 * (at.x - 0.5).signum();
        }
        record.push(at.x, sign * u);
        commands.rotate_right(1);
        commands[0] = u;
        // Twenty steps within a point, so that the delay is exact.
        for part in 0..20 {
            let back = truth.delay / TIME - (part as f32 + 0.5) / 20.0;
            let whole = (libm::floorf(back) + 1.0) as usize;
            let direction = at.v.signum();
            truth.slide(&mut at, truth.flow(commands[whole]), direction, TIME / 20.0);
        }
    }
    let view = View {
        end: 500,
        ..View::of(TIME, 1e-6, sign)
    };
    (record, view)
}

fn solved(
    record: &MotionRecord,
    view: View,
    stated: f32,
    dead_zone: f32,
) -> (Option<Theta>, usize) {
    let mut regression = Regression::new(stated, 1.5);
    regression.begin(record, view, 60.0, dead_zone);
    let mut points = 0;
    while !regression.advance(record, 10) {
        points += 10;
    }
    while !regression.solve_next() {}
    (regression.best(), points)
}

#[test]
fn a_drive_is_found_with_its_delay() {
    let mut dice = Dice::new(1);
    for (k, delay) in (0..24).zip([5e-3, 9e-3, 14e-3, 2e-3].into_iter().cycle()) {
        let w = dice.within(15.0, 35.0);
        let truth = Theta {
            a1: w * w,
            a2: 2.0 * dice.within(0.2, 0.8) * w,
            b0: dice.within(1.5, 3.0) * w * w,
            dead_zone: dice.within(0.02, 0.06),
            offset: dice.within(-0.02, 0.02),
            friction: dice.within(0.2, 1.0),
            delay,
            kappa: 0.0,
            stiffening: 0.0,
            imbalance: 0.0,
        };
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let (record, view) = record(&truth, sign, &mut dice);
        let (found, points) = solved(&record, view, 2e-3, 0.7 * truth.dead_zone);
        let found = found.expect("a drive");
        assert!((480..=500).contains(&points), "{points}");
        assert_eq!(found.delay, delay, "{truth:?} {found:?}");
        for (name, found, truth, share) in [
            ("w", sqrt(found.a1), w, 0.07),
            ("a2", found.a2, truth.a2, 0.2),
            ("gain", found.b0 / found.a1, truth.b0 / truth.a1, 0.15),
        ] {
            assert!(
                (found / truth - 1.0).abs() < share,
                "{k} {name}: {found} for {truth}"
            );
        }
        assert!(
            (found.dead_zone - truth.dead_zone).abs() < 0.006,
            "{truth:?} {found:?}"
        );
        assert!(
            (found.offset - truth.offset).abs() < 0.004,
            "{truth:?} {found:?}"
        );
        assert!(
            (found.friction - truth.friction).abs() < 0.3,
            "{truth:?} {found:?}"
        );
        let usual = loss_over_gain(1.5) * found.b0 / found.a1;
        assert_eq!((found.kappa, found.stiffening), (usual, 1.5));
    }
}

#[test]
fn what_does_not_move_is_no_drive() {
    let mut dice = Dice::new(2);
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    for _ in 0..400 {
        record.push(0.5, 0.4 * dice.roll());
    }
    let view = View {
        end: 400,
        ..View::of(TIME, 1e-4, 1.0)
    };
    assert_eq!(solved(&record, view, 2e-3, 0.01).0, None);
}

#[test]
fn a_regression_that_begins_anew_knows_nothing_of_the_last_one() {
    let mut dice = Dice::new(3);
    let truth = Theta {
        delay: 5e-3,
        kappa: 0.0,
        stiffening: 0.0,
        dead_zone: 0.03,
        ..dice.theta()
    };
    let (first, view) = record(&truth, 1.0, &mut dice);
    let (second, _) = record(&truth, 1.0, &mut dice);
    let mut regression = Regression::new(2e-3, 1.5);
    let mut run = |record: &MotionRecord| {
        regression.begin(record, view, 60.0, 0.02);
        while !regression.advance(record, 10) {}
        while !regression.solve_next() {}
        regression.clone()
    };
    let alone = run(&second);
    assert_ne!(run(&first), alone);
    assert_eq!(run(&second), alone);
}

#[test]
fn equations_begin_when_the_filters_have_settled_and_the_start_is_over() {
    let view = View {
        end: 100,
        ..View::of(TIME, 1e-6, 1.0)
    };
    // At 55 per s and 4 ms: 18 points behind the begin, 5 behind the first one in motion.
    for starts in [0, 8, 30] {
        let mut record = MotionRecord::new();
        assert!(record.fix(1));
        for k in 0..100 {
            let time = TIME * (k as f32 - starts as f32).max(0.0);
            record.push(0.3 + 0.5 * time + 4.0 * time * time, 0.1);
        }
        let moving = (0..90).find(|i| !Point::of(&record, *i, &view).rests);
        let moving = moving.expect("it moves");
        assert!((starts..starts + 3).contains(&(moving + 1)), "{moving}");
        let exact = 18.max(moving + 5);
        let mut regression = Regression::new(2e-3, 1.5);
        regression.begin(&record, view, 55.0, 0.02);
        while regression.squares == 0.0 {
            assert!(!regression.advance(&record, 1), "{starts}");
        }
        assert_eq!(regression.next - 1, exact, "{starts}");
    }
}

#[test]
fn a_friction_and_a_constant_that_one_way_does_not_tell_apart_are_no_obstacle() {
    let truth = Theta {
        a1: 400.0,
        a2: 20.0,
        b0: 800.0,
        dead_zone: 0.0,
        offset: 0.0,
        friction: 0.0,
        delay: 2e-3,
        kappa: 0.0,
        imbalance: 0.0,
        stiffening: 0.0,
    };
    let mut at = Prediction {
        x: 0.0,
        ..Prediction::default()
    };
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    let mut dice = Dice::new(5);
    let (mut u, mut before) = (0.2, 0.2);
    for k in 0..500 {
        record.push(at.x, u);
        for part in 0..20 {
            let flow = truth.flow(if part < 10 { before } else { u });
            truth.slide(&mut at, flow, 1.0, TIME / 20.0);
        }
        before = u;
        if k % 12 == 0 {
            u = 0.2 + 0.1 * dice.roll();
        }
        assert!(at.v >= 0.0, "it goes one way");
    }
    let view = View {
        end: 500,
        ..View::of(TIME, 1e-6, 1.0)
    };
    let (found, _) = solved(&record, view, 2e-3, 0.0);
    let found = found.expect("a drive");
    assert!((found.a1 / truth.a1 - 1.0).abs() < 0.3, "{found:?}");
}
