//! A model beside a record of its own drive, and beside one of another.

use super::*;
use crate::servo::commissioning::oracle::Dice;

const TIME: f32 = 4e-3;
const RELEASE: usize = 120;
const END: usize = 400;

/// A record of `truth`, which shares its stiffness with the model of the middle.
fn record(truth: &Theta, dice: &mut Dice) -> (MotionRecord, View) {
    let mut record = MotionRecord::new();
    assert!(record.fix(1));
    let mut at = Prediction {
        x: 0.5,
        ..Prediction::default()
    };
    let mut u = 0.0;
    for k in 0..END {
        if k % 15 == 0 {
            u = 0.3 * dice.roll() - 0.25 * (at.x - 0.5).signum();
        }
        record.push(at.x, u);
        let flow = truth.flow_at(&record, 1.0, k, 1.0 / TIME);
        let there = truth.stiffer(stiffness(truth.stiffening, at.x));
        let direction = at.v.signum();
        there.slide(&mut at, flow, direction, TIME);
    }
    let view = View {
        end: END,
        ..View::of(TIME, 1e-6, 1.0)
    };
    (record, view)
}

fn judged(record: &MotionRecord, view: View, theta: Theta) -> [f32; 2] {
    let mut simulation = Simulation::new(record, view, theta, 2.0, RELEASE);
    let mut calls = 0;
    loop {
        calls += 1;
        if let Some(found) = simulation.advance(record, 7) {
            assert!(calls > END / 7 - 2, "all points are taken");
            return found;
        }
    }
}

#[test]
fn a_model_follows_its_own_drive_and_the_variance_is_that_of_the_position() {
    let mut dice = Dice::new(1);
    for _ in 0..20 {
        let truth = Theta {
            friction: 0.0,
            ..dice.theta()
        };
        let (record, view) = record(&truth, &mut dice);
        let [error, variance] = judged(&record, view, truth);
        let last = END - view.beyond();
        let count = (last - RELEASE) as f32;
        let mean: f32 = (RELEASE..last).map(|i| record.y(i)).sum::<f32>() / count;
        let exact = (RELEASE..last)
            .map(|i| (record.y(i) - mean) * (record.y(i) - mean))
            .sum::<f32>()
            / count;
        assert!((variance / exact - 1.0).abs() < 1e-3, "{variance} {exact}");
        assert!(error < 1e-4 * variance, "{error} of {variance}");
        // A wrong gain is an error of its size.
        let weak = Theta {
            b0: 0.7 * truth.b0,
            ..truth
        };
        let [error, same] = judged(&record, view, weak);
        assert!(
            error > 1e-3 * variance && same == variance,
            "{error} of {variance}"
        );
    }
}

#[test]
fn up_to_the_release_the_record_corrects() {
    // A model that begins with a wrong velocity has forgotten it when it is released.
    let mut dice = Dice::new(2);
    let truth = Theta {
        friction: 0.0,
        kappa: 0.0,
        ..dice.theta()
    };
    let (record, view) = record(&truth, &mut dice);
    let mut simulation = Simulation::new(&record, view, truth, 2.0, RELEASE);
    simulation.at.v += 1.0;
    simulation.at.p += 10.0;
    simulation.at.x += 0.1;
    while simulation.next < RELEASE {
        assert_eq!(simulation.advance(&record, 1), None);
        assert_eq!((simulation.sums, simulation.count), ([0.0; 3], 0.0));
    }
    assert!((record.y(RELEASE) - simulation.at.x).abs() < 1e-3);
    assert_eq!(simulation.advance(&record, 1), None);
    assert_eq!(simulation.count, 1.0);
}

#[test]
fn a_correction_is_no_quicker_than_the_points_allow() {
    let mut dice = Dice::new(3);
    let truth = dice.theta();
    let (record, view) = record(&truth, &mut dice);
    let w = sqrt(truth.a1);
    let slow = Simulation::new(&record, view, truth, 0.5, RELEASE);
    assert_eq!(slow.gains, truth.gains(0.5 * w, TIME));
    let quick = Simulation::new(&record, view, truth, 50.0, RELEASE);
    assert_eq!(quick.gains, truth.gains(STEP_MAX / TIME, TIME));
}

#[test]
fn the_end_of_a_simulation_takes_a_call_without_points() {
    let mut dice = Dice::new(4);
    let truth = dice.theta();
    let (record, view) = record(&truth, &mut dice);
    let all = END - view.beyond();
    for (first, second) in [(all, None), (all + 7, None), (all - 3, Some(7))] {
        let mut simulation = Simulation::new(&record, view, truth, 2.0, RELEASE);
        assert_eq!(simulation.advance(&record, first), None, "{first}");
        if let Some(second) = second {
            assert_eq!(simulation.advance(&record, second), None, "{first}");
        }
        assert_eq!(simulation.next, all);
        assert!(simulation.advance(&record, 7).is_some(), "{first}");
    }
}
