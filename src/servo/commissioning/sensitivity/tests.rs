//! The transition over an interval, and the slopes against differences.

use super::*;
use crate::servo::commissioning::oracle::{Dice, close, moved};

const TIME: f32 = 2e-3;

/// A drive that acts as a unit of acceleration, rate or state does: nothing else acts on it.
fn alone(theta: &Theta) -> Theta {
    Theta {
        b0: 1.0,
        kappa: 0.0,
        friction: 1.0,
        imbalance: 0.0,
        ..*theta
    }
}

#[test]
fn a_transition_is_what_units_become() {
    let mut dice = Dice::new(1);
    for _ in 0..200 {
        let theta = alone(&dice.theta());
        let k = dice.within(0.0, 5.0);
        // What is left out of the shortest series is 6e-5 of it.
        let time = 0.02 / crate::math::sqrt(theta.a1);
        let on = Transition::new(&theta, k, time);
        // The loss acts on the drive alone, as a flow of one and this kappa would.
        let lossy = Theta {
            kappa: k,
            b0: 0.0,
            ..theta
        };
        let unit = |x: f32, v: f32, p: f32| Prediction { x, v, p };
        let [none, v, p] = [
            unit(0.0, 0.0, 0.0),
            unit(0.0, 1.0, 0.0),
            unit(0.0, 0.0, 1.0),
        ];
        let pushed = Theta { b0: 1.0, ..lossy };
        let cases = [
            (
                unit_of(on.acceleration),
                moved(&lossy, &none, 1.0, -1.0, time),
            ),
            (unit_of(on.rate), moved(&pushed, &none, 1.0, 0.0, time)),
            (beside(&v, on.velocity), moved(&lossy, &v, 1.0, 0.0, time)),
            (beside(&p, on.drive), moved(&lossy, &p, 1.0, 0.0, time)),
        ];
        for (found, expected) in cases {
            let size = found.x.abs().max(1e-3 * time * time * time);
            let sizes = [size, found.v.abs().max(size), found.p.abs().max(size)];
            assert!(
                close(&found, expected, sizes, 1e-4),
                "{found:?} {expected:?}"
            );
        }
    }
}

fn unit_of([x, v, p]: [f32; 3]) -> Prediction {
    Prediction { x, v, p }
}

fn beside(start: &Prediction, [x, v, p]: [f32; 3]) -> Prediction {
    Prediction {
        x,
        v: start.v + v,
        p: start.p + p,
    }
}

#[test]
fn a_corrected_step_is_a_correction_and_a_step() {
    let mut dice = Dice::new(2);
    for _ in 0..100 {
        let theta = dice.theta();
        let (k, time) = (dice.within(0.0, 5.0), 2e-3);
        let on = Transition::new(&theta, k, time);
        let gains = theta.gains(60.0, time);
        let start = unit_of([dice.roll(), dice.roll(), 20.0 * dice.roll()]);
        // By hand: the position is wrong by itself, which each gain takes from its state.
        let mut by_hand = start;
        by_hand.correct(gains, -start.x);
        on.corrected([0.0; 3]).advance(&mut by_hand, &on.rate, 7.0);
        let mut at_once = start;
        on.corrected(gains).advance(&mut at_once, &on.rate, 7.0);
        for (a, b) in [
            (by_hand.x, at_once.x),
            (by_hand.v, at_once.v),
            (by_hand.p, at_once.p),
        ] {
            assert!(
                (a - b).abs() < 1e-5 * (1.0 + a.abs()),
                "{by_hand:?} {at_once:?}"
            );
        }
    }
}

/// Point `k` of a motion with reversals and a rest, and the commands of its interval.
fn sample(k: usize) -> (Point, [f32; 3]) {
    let phase = k as f32 / 25.0;
    let sine = libm::sinf(core::f32::consts::PI * phase);
    let rests = (60..70).contains(&k);
    let point = Point {
        time: TIME,
        y: 0.4 + 0.15 * sine,
        velocity: if rests {
            0.0
        } else {
            libm::cosf(core::f32::consts::PI * phase)
        },
        direction: if rests {
            0.0
        } else {
            libm::cosf(core::f32::consts::PI * phase).signum()
        },
        rests,
    };
    let command = |k: usize| {
        if (k / 15).is_multiple_of(2) {
            0.35
        } else {
            -0.3
        }
    };
    (point, [command(k), command(k.saturating_sub(1)), 0.4])
}

/// The prediction at the end of 100 points, with its slopes.
fn run(theta: Theta, gains: [f32; 3]) -> Sensitivity {
    let mut at = Sensitivity::new();
    at.begin(theta, &sample(0).0);
    for k in 0..100 {
        let (point, commands) = sample(k);
        at.advance(&point, gains, commands, 1.0 / TIME);
    }
    at
}

#[test]
fn a_slope_is_what_a_small_change_of_the_parameter_does() {
    let mut dice = Dice::new(3);
    let mut worst = [0.0_f32; PARAMETERS];
    for _ in 0..20 {
        let theta = dice.theta();
        let gains = theta.gains(1.5 * crate::math::sqrt(theta.a1), TIME);
        let at = run(theta, gains);
        let scale = crate::servo::commissioning::range::scales(&theta);
        for j in 0..PARAMETERS {
            // The delay is in the share between two commands here, which are given.
            if j == 6 {
                continue;
            }
            let step = 0.02 * scale[j];
            let other = |sign: f32| {
                let mut other = theta.to_array();
                other[j] += sign * step;
                run(Theta::from_array(other), gains).at
            };
            let (more, less) = (other(1.0), other(-1.0));
            let (found, p) = (at.slopes[j].x * scale[j], at.slopes[j].p * scale[j]);
            let by_difference = (more.x - less.x) / 0.04;
            let drive = (more.p - less.p) / 0.04;
            // What follows the state acts with its mean over the interval.
            let error = (found - by_difference).abs() / (2e-4 + found.abs());
            let error = error.max((p - drive).abs() / (0.02 * theta.b0 * TIME + p.abs()));
            worst[j] = worst[j].max(error);
        }
    }
    assert!(worst.iter().all(|error| *error < 0.05), "{worst:?}");
}

#[test]
fn the_slope_of_the_delay_is_that_of_its_share() {
    let mut dice = Dice::new(4);
    for _ in 0..20 {
        // Without what has a corner where the mean flow is zero: a loss, an imbalance.
        let theta = Theta {
            kappa: 0.0,
            imbalance: 0.0,
            ..dice.theta()
        };
        let gains = theta.gains(30.0, TIME);
        let run = |part: f32| {
            let mut at = Sensitivity::new();
            at.begin(theta, &sample(0).0);
            // Some points behind a change of the command.
            for k in 0..35 {
                let (point, [newer, older, _]) = sample(k);
                at.advance(&point, gains, [newer, older, part], 1.0 / TIME);
            }
            at
        };
        let (found, at) = (run(0.4), |slope: &Prediction| [slope.x, slope.v, slope.p]);
        let [more, less] = [run(0.6), run(0.2)].map(|run| at(&run.at));
        for (k, slope) in at(&found.slopes[6]).into_iter().enumerate() {
            let (slope, difference) = (slope * TIME, (more[k] - less[k]) / 0.4);
            let size = theta.b0 * TIME * libm::powf(TIME, 2.0 - k as f32);
            let error = (slope - difference).abs();
            assert!(
                error < 0.02 * slope.abs() + size,
                "{k}: {slope} {difference}"
            );
        }
    }
}

#[test]
fn a_prediction_without_its_slopes_is_that_of_the_model() {
    let mut dice = Dice::new(5);
    for _ in 0..20 {
        let theta = dice.theta();
        let gains = theta.gains(50.0, TIME);
        let mut at = Sensitivity::new();
        let first = sample(0).0;
        at.begin(theta, &first);
        let mut other = Prediction {
            x: first.y,
            v: first.velocity,
            p: theta.a2 * first.velocity + theta.friction * first.direction,
        };
        for k in 0..100 {
            let (point, commands) = sample(k);
            let (error, slope) = at.error(&point);
            assert_eq!(slope, at.slopes.map(|slope| slope.x));
            assert!(
                (error - (point.y - other.x)).abs() < 1e-4,
                "{k}: {error} {other:?}"
            );
            at.advance(&point, gains, commands, 1.0 / TIME);
            let off = point.y - other.x;
            if point.rests {
                other.x = point.y;
            } else {
                other.correct(gains, off);
            }
            theta.stiffer(stiffness(theta.stiffening, point.y)).advance(
                &mut other,
                theta.mean_flow(commands),
                &point,
            );
        }
        assert_eq!(at.theta(), &theta);
        assert_eq!(at.seen(first), first.under(at.at.p, theta.friction));
    }
}

#[test]
fn a_flow_has_a_direction_or_none() {
    assert_eq!([2.0, -3.0, 0.0].map(sign), [1.0, -1.0, 0.0]);
}
