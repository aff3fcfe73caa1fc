//! The series, the commands between two points, and what grows with the stiffness.

use super::*;
use crate::math::sqrt;
use crate::servo::commissioning::oracle::{Dice, close, f64_of, moved};

fn at(dice: &mut Dice, theta: &Theta) -> Prediction {
    Prediction {
        x: dice.roll(),
        v: dice.roll(),
        p: theta.a2 * dice.roll() + dice.roll(),
    }
}

#[test]
fn a_slide_is_the_solution_of_the_equation() {
    let mut dice = Dice::new(1);
    for _ in 0..300 {
        let theta = dice.theta();
        // A twentieth of 1/w: what is left out of the series is 1e-6 of what moves.
        let time = 0.05 / sqrt(theta.a1);
        let (flow, direction) = (dice.roll(), dice.roll().signum());
        let start = at(&mut dice, &theta);
        let mut found = start;
        theta.slide(&mut found, flow, direction, time);
        let expected = moved(&theta, &start, flow, theta.friction * direction, time);
        let v = 1.0 + theta.b0 * time;
        assert!(
            close(&found, expected, [1.0, v, 10.0 * v / time], 2e-6),
            "{theta:?} {start:?} {flow}: {found:?}, {expected:?}"
        );
    }
}

#[test]
fn at_rest_only_the_drive_changes() {
    let mut dice = Dice::new(2);
    for _ in 0..100 {
        let theta = dice.theta();
        let start = at(&mut dice, &theta);
        let flow = dice.roll();
        // Where it stands, a drive that pulls in vain: neither stiffness nor damping act.
        let held = Theta {
            a1: 0.0,
            a2: 0.0,
            ..theta
        };
        let time = 1e-4;
        let mut found = start;
        theta.rest(&mut found, flow, time);
        let [_, _, p] = moved(&held, &start, flow, 0.0, time);
        assert_eq!((found.x, found.v), (start.x, 0.0));
        // One step of Euler: the second derivative is left out.
        let loss = theta.kappa * flow.abs() * time;
        let size = theta.b0 * time + loss * start.p.abs();
        let expected = [f64_of(found.x), 0.0, p];
        assert!(
            close(&found, expected, [0.0, 0.0, size], 2e-3),
            "{found:?} {p}"
        );
    }
}

#[test]
fn a_point_that_rests_is_held_and_another_one_slides() {
    let theta = Dice::new(3).theta();
    let point = Point {
        time: 1e-3,
        y: 0.4,
        velocity: 0.0,
        direction: 1.0,
        rests: true,
    };
    let start = Prediction {
        x: 0.4,
        v: 0.1,
        p: 30.0,
    };
    let [mut rest, mut slide, mut advanced] = [start; 3];
    theta.rest(&mut rest, 0.2, 1e-3);
    theta.slide(&mut slide, 0.2, 1.0, 1e-3);
    theta.advance(&mut advanced, 0.2, &point);
    assert_eq!(advanced, rest);
    advanced = start;
    theta.advance(
        &mut advanced,
        0.2,
        &Point {
            rests: false,
            ..point
        },
    );
    assert_eq!(advanced, slide);
    assert_ne!(slide, rest);
    // What friction can hold for sure rests; a drive far above it does not, in either direction.
    for (drive, rests) in [(19.0, true), (-19.0, true), (21.0, false), (-21.0, false)] {
        assert_eq!(point.under(drive, 1.0).rests, rests, "{drive}");
    }
    assert!(
        !Point {
            rests: false,
            ..point
        }
        .under(0.0, 1.0)
        .rests
    );
}

#[test]
fn a_correction_has_its_three_poles_where_they_are_wanted() {
    let mut dice = Dice::new(4);
    for _ in 0..50 {
        let theta = dice.theta();
        let (rate, time) = (dice.within(20.0, 200.0), 1e-3);
        let [l1, l2, l3] = theta
            .gains(rate, time)
            .map(|gain| f64_of(gain) / f64_of(time));
        let [a1, a2] = [theta.a1, theta.a2].map(f64_of);
        // The determinant of s I - (A - l c) for x' = v, v' = p - a2 v, p' = -a1 v.
        for s in [0.0, 1.0, 50.0, -30.0_f32].map(f64_of) {
            let lower = (s + a2) * s + a1;
            let determinant = (s + l1) * lower + l2 * s + l3;
            let r = s + f64_of(rate);
            let scale = f64_of(rate).powi(3) + a1 * f64_of(rate);
            assert!(
                (determinant - r * r * r).abs() < 1e-5 * scale,
                "{theta:?} {rate} {s}"
            );
        }
    }
}

#[test]
fn the_flow_of_an_interval_is_the_mean_of_its_commands() {
    let mut dice = Dice::new(5);
    let mut record = MotionRecord::new();
    let commands: [f32; 40] = core::array::from_fn(|_| 0.3 * dice.roll());
    for u in commands {
        record.push(0.0, u);
    }
    let (time, sign) = (4e-3_f32, -1.0);
    for _ in 0..200 {
        let theta = dice.theta();
        let i = 10 + (dice.within(0.0, 25.0)) as usize;
        // The delayed command in 400 places of the interval.
        let places = 400;
        let mut sum = 0.0;
        for k in 0..places {
            let share = (k as f32 + 0.5) / places as f32;
            let place = i as f32 + share - theta.delay / time;
            sum += theta.flow(sign * commands[libm::floorf(place) as usize]);
        }
        let found = theta.flow_at(&record, sign, i, 1.0 / time);
        assert!(
            (found - sum / places as f32).abs() < 2e-3,
            "{theta:?} {found}"
        );
    }
    let theta = Theta {
        dead_zone: 0.05,
        offset: 0.02,
        ..dice.theta()
    };
    for (command, flow) in [(0.1, 0.07), (-0.1, -0.03), (0.029, 0.0), (-0.069, 0.0)] {
        assert!((theta.flow(command) - flow).abs() < 1e-6, "{command}");
    }
}

#[test]
fn a_point_has_the_velocity_and_the_direction_of_its_interval() {
    let view = View::of(1e-2, 1e-4, 1.0);
    let reach = view.reach;
    let of = |motion: fn(f32) -> f32, at: usize| {
        let mut record = MotionRecord::new();
        for k in 0..40 {
            record.push(motion(1e-2 * k as f32), 0.0);
        }
        (record.y(at), Point::of(&record, at, &view))
    };
    // A straight line, downwards.
    let (y, point) = of(|t| 0.3 - 0.5 * t, 20);
    assert!((point.velocity + 0.5).abs() < 1e-4 && point.y == y && point.time == 1e-2);
    assert!((point.direction + 1.0).abs() < 1e-6 && !point.rests);
    // A parabola: velocity is that of the middle of the interval, and turns with it.
    let (_, point) = of(|t| (t - 0.205) * (t - 0.205), 20);
    assert!(point.velocity.abs() < 1e-4 && point.direction.abs() < 1e-3);
    let (_, point) = of(|t| (t - 0.1) * (t - 0.1), 20);
    assert!((point.velocity - 2.0 * 0.105).abs() < 1e-4, "{point:?}");
    // Where it turns within the interval, the mean of the signs: a third of it backwards.
    let (_, point) = of(
        |t| (t - 0.2 - 1e-2 / 3.0) * (t - 0.2 - 1e-2 / 3.0) * 20.0,
        20,
    );
    assert!(
        (point.direction - 1.0 / 3.0).abs() < 0.35 / reach as f32,
        "{point:?}"
    );
    // Slower than what is distinguished from rest, and at a stop.
    let (_, point) = of(|t| 0.5 + 0.01 * t, 20);
    assert!(point.rests && point.direction == 0.0, "{point:?}");
    let (_, point) = of(|t| if t < 0.2 { t } else { 0.2 }, 19);
    assert!(!point.rests);
}

#[test]
fn a_slide_has_the_terms_of_its_series_to_the_fourth() {
    // A cosine of one rad: 1 - 1/2 + 1/24, and what it has integrated, 1 - 1/6 and 1/2 - 1/24.
    let theta = Theta::from_array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let mut at = Prediction {
        p: 1.0,
        ..Prediction::default()
    };
    theta.slide(&mut at, 0.0, 0.0, 1.0);
    let exact = [0.5 - 1.0 / 24.0, 1.0 - 1.0 / 6.0, 0.5 + 1.0 / 24.0];
    for (found, exact) in [at.x, at.v, at.p].into_iter().zip(exact) {
        assert!((found - exact).abs() < 1e-6, "{found} {exact}");
    }
}

#[test]
fn what_chambers_do_grows_with_their_stiffness() {
    let mut dice = Dice::new(6);
    for _ in 0..50 {
        let theta = dice.theta();
        assert_eq!(Theta::from_array(theta.to_array()), theta);
        let stiffer = theta.stiffer(1.5);
        let [a1, b0, kappa] = [theta.a1, theta.b0, theta.kappa].map(|x| 1.5 * x);
        assert_eq!((stiffer.a1, stiffer.b0, stiffer.kappa), (a1, b0, kappa));
        assert_eq!(
            Theta {
                a1: theta.a1,
                b0: theta.b0,
                kappa: theta.kappa,
                ..stiffer
            },
            theta
        );
    }
}
