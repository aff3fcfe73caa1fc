//! Steps of the state, the observer, and its prediction over the delay.

use super::*;
use crate::servo::control::axis_state::{AxisState, Step};
use crate::servo::control::estimator::StateEstimator;
use crate::servo::control::observer::Observer;
use crate::servo::design::{EstimatorDesign, ObserverDesign};
use crate::servo::motion::Travel;

const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

#[test]
fn a_step_of_the_state_is_the_drive_with_friction_and_disturbance() {
    for stiffness in [1.0, 1.7] {
        let mut step = Step::of(&MODEL, 1e-4);
        step.go(&MODEL, stiffness);
        assert_eq!((step.a1, step.a2), (stiffness * 400.0, 20.0));
        assert_eq!(step.b0, stiffness * 1e6);
        let mut state = AxisState {
            position: 3.0,
            velocity: -80.0,
            drive: 500.0,
            disturbance: 30_000.0,
        };
        // The same by steps a hundred times as small, of first order.
        let (mut x, mut v, mut p) = (3.0_f32, -80.0_f32, 500.0_f32);
        let small = 1e-6;
        for k in 0..2000 {
            let flow = if k < 1000 { 0.05 } else { -0.02 };
            state.advance(flow, &step);
            for _ in 0..100 {
                let rest = (v == 0.0 || v * (v + small * p) <= 0.0) && p.abs() < 800.0;
                if rest {
                    v = 0.0;
                }
                let sliding = if v > 0.0 { 800.0 } else { -800.0 };
                let a = if rest { 0.0 } else { p - 20.0 * v - sliding };
                p += small * (stiffness * (1e6 * flow - 400.0 * v) + 30_000.0);
                x += small * v;
                v += small * a;
            }
            assert!(
                (state.velocity - v).abs() < 0.8,
                "{k}: {} {v}",
                state.velocity
            );
            assert!((state.drive - p).abs() < 40.0, "{k}: {} {p}", state.drive);
        }
        assert!((state.position - x).abs() < 0.2, "{} {x}", state.position);
    }
}

#[test]
fn an_undamped_drive_neither_grows_nor_fades_and_friction_leaves_no_velocity() {
    let model = Model::linear(400.0, 0.0, 1e6);
    let step = Step::of(&model, STEP);
    let mut state = AxisState {
        velocity: 100.0,
        ..AxisState::default()
    };
    let energy =
        |state: &AxisState| 400.0 * state.velocity * state.velocity + state.drive * state.drive;
    let before = energy(&state);
    for _ in 0..100_000 {
        state.advance(0.0, &step);
    }
    assert!((energy(&state) / before - 1.0).abs() < 1e-2);
    // A velocity that friction can take within the sample is taken whole.
    let step = Step::of(&MODEL, STEP);
    for velocity in [0.7, -0.7] {
        let mut state = AxisState {
            velocity,
            ..AxisState::default()
        };
        state.advance(0.0, &step);
        assert_eq!(state.velocity, 0.0);
    }
    // Held, the drive goes on by the flow and the disturbance; a closed valve lets nothing through.
    let mut state = AxisState {
        disturbance: 1000.0,
        ..AxisState::default()
    };
    state.hold(0.01, &step);
    assert!((state.drive - 11.0).abs() < 1e-4);
    state.hold(0.0, &step);
    assert!((state.drive - 11.0).abs() < 1e-4);
    assert_eq!((state.velocity, state.position), (0.0, 0.0));
}

#[test]
fn an_observer_has_three_equal_poles() {
    let model = Model::linear(400.0, 20.0, 1e6);
    let design = ObserverDesign {
        rate: 50.0,
        sample_time: 1e-4,
    };
    let mut observer = Observer::new(&design, model);
    observer.place(Motion::at(1.0));
    let mut deviation = Motion::at(1.0);
    // A wrong position fades by the third-order response s^2 + a2 s + a1 over (s + 50)^3.
    for k in 1..=1000 {
        observer.observe(0.0, 0.0);
        let t = 1e-4 * k as f32;
        let x = 50.0 * t;
        // Partial fractions about -50: s^2 + 20 s + 400 = (s+50)^2 - 80 (s+50) + 1900.
        let exact = libm::expf(-x) * (1.0 - 80.0 * t + 0.5 * 1900.0 * t * t);
        let found = observer.motion().position;
        assert!((found - exact).abs() < 0.02, "{k}: {found} {exact}");
        observer.deviate_observed(&mut deviation, 0.0);
        assert!((deviation.position - found).abs() < 1e-5, "{k}");
    }
    assert_eq!(observer.model(), &model);
    observer.forget_position();
    assert_eq!(observer.motion().position, 0.0);
    // With friction it sticks at the measured position until the drive is enough.
    let mut sticky = Observer::new(&design, MODEL);
    sticky.place(Motion::at(5.0));
    sticky.observe(0.0, 5.2);
    assert_eq!(sticky.motion(), Motion::at(5.2));
    let mut samples = 0;
    while sticky.motion().acceleration == 0.0 {
        sticky.predict(0.1);
        samples += 1;
    }
    // 1.2 frictions by 1e5 per s.
    assert!((95..=98).contains(&samples), "{samples}");
}

/// Poles of a loop on the model, and an estimator with so many samples of delay.
fn estimator(delay: usize, model: Model) -> StateEstimator {
    let design = EstimatorDesign {
        sample_time: STEP,
        delay,
        travel: TRAVEL,
        dead_volume: f32::INFINITY,
        imbalance: 0.0,
    };
    let poles = Poles {
        bandwidth: 20.0,
        damping: 0.8,
        observer: 80.0,
        disturbance: 6.0,
    };
    StateEstimator::new(&design, model, poles)
}

#[test]
fn an_estimate_follows_the_drive_and_what_is_ahead_is_a_delay_later() {
    for delay in [0, 1, 7] {
        let model = Model::linear(400.0, 20.0, 1e6);
        let mut estimator = estimator(delay, model);
        // A disturbance of 0.03 of flow that it has to find.
        let mut real = Motion::at(200.0);
        estimator.place(Motion::at(199.0), core::iter::empty());
        let (mut flows, mut foreseen) = ([0.0; 16], [0.0; 16]);
        for k in 0..4000_usize {
            let flow = if (k / 150).is_multiple_of(2) {
                0.2
            } else {
                -0.2
            };
            // It acts a delay after it was set.
            let _ = estimator.update(real.position, None, false);
            let ahead = estimator.ahead();
            if k > 3000 {
                let now = estimator.motion();
                assert!((now.velocity - real.velocity).abs() < 2.0, "{delay} {k}");
                assert!(
                    (now.acceleration - real.acceleration).abs() < 150.0,
                    "{delay} {k}"
                );
                let then = foreseen[(k + 16 - delay) % 16];
                let found = if delay == 0 { ahead.position } else { then };
                assert!((found - real.position).abs() < 0.1, "{delay} {k}: {found}");
                let d = estimator.now().disturbance;
                assert!((d - 0.03e6).abs() < 1500.0, "{delay} {k}: {d}");
            }
            foreseen[k % 16] = ahead.position;
            estimator.applied(flow);
            flows.rotate_right(1);
            flows[0] = flow;
            assert_eq!(estimator.flow_in_force(), flows[delay], "{delay} {k}");
            model.advance(&mut real, flows[delay] + 0.03, STEP);
        }
        estimator.disturb(-0.03);
        assert!(estimator.now().disturbance.abs() < 1500.0);
        estimator.forget_disturbance();
        assert_eq!(estimator.now().disturbance, 0.0);
    }
}

#[test]
fn an_axis_that_is_held_stands_while_its_drive_goes_on() {
    let mut estimator = estimator(2, MODEL);
    estimator.place(Motion::at(100.0), core::iter::empty());
    for _ in 0..3 {
        estimator.applied(0.05);
    }
    for k in 0..10 {
        let innovation = estimator.update(100.5, Some(100.0), false);
        assert_eq!(innovation, 0.5);
        let now = *estimator.now();
        assert_eq!((now.position, now.velocity), (100.0, 0.0));
        assert!(
            (now.drive - 50.0 * (k + 1) as f32).abs() < 1.0,
            "{k}: {}",
            now.drive
        );
        // Two more samples of the flow are on their way.
        assert!((estimator.ahead().drive - now.drive - 100.0).abs() < 1.0);
        assert_eq!(estimator.motion(), Motion::at(100.0));
        estimator.applied(0.05);
    }
    assert!(estimator.pushes());
    // Up to four frictions.
    for _ in 0..200 {
        let _ = estimator.update(100.0, Some(100.0), false);
        estimator.applied(0.05);
    }
    assert_eq!(estimator.now().drive, 3200.0);
    assert!(!estimator.pushes());
    // Let go, the drive is at least what moved it; on the other side what it must be.
    estimator.release(1.0, 100.4, 900.0);
    assert_eq!(
        (estimator.now().drive, estimator.now().position),
        (3200.0, 100.4)
    );
    estimator.release(-1.0, 100.4, 900.0);
    assert_eq!(estimator.now().drive, -900.0);
    assert!(!estimator.pushes(), "it slides");
}

#[test]
fn a_state_begins_at_a_motion_with_the_flows_on_their_way() {
    let mut estimator = estimator(3, MODEL);
    for velocity in [50.0, -50.0] {
        let motion = Motion {
            position: 150.0,
            velocity,
            acceleration: 300.0,
        };
        estimator.place(motion, [0.4, 0.3, 0.2, 0.1].into_iter());
        let found = estimator.motion();
        assert!((found.acceleration - 300.0).abs() < 1e-2 && found.velocity == velocity);
        let sliding = 800.0 * f32::signum(velocity);
        assert!((estimator.now().drive - (300.0 + 20.0 * velocity + sliding)).abs() < 1e-2);
        // The newest of them acts three samples later.
        for flow in [0.1, 0.2, 0.3, 0.4] {
            assert_eq!(estimator.flow_in_force(), flow);
            estimator.applied(0.7);
        }
        assert_eq!(estimator.flow_in_force(), 0.7);
    }
    // What is no number is not believed.
    let _ = estimator.update(f32::INFINITY, None, false);
    let _ = estimator.update(7.0, None, false);
    let now = estimator.now();
    assert_eq!((now.position, now.velocity, now.drive), (7.0, 0.0, 0.0));
    // A disturbance of more than the full command is none; frozen it stays.
    let mut estimator = super::seen::estimator(0, Model::linear(400.0, 20.0, 1e6));
    estimator.place(Motion::at(0.0), core::iter::empty());
    for k in 0..2000 {
        let _ = estimator.update(0.05 * k as f32 * k as f32, None, false);
        assert!(estimator.now().disturbance.abs() <= 1e6);
    }
    let d = estimator.now().disturbance;
    assert_eq!(d, 1e6);
    let _ = estimator.update(0.0, None, true);
    assert_eq!(estimator.now().disturbance, d);
}

#[test]
fn a_state_of_small_units_is_finite_whatever_its_product() {
    // A gain as in units of 1e-20 of a metre.
    let model = Model::linear(400.0, 20.0, 1e26);
    let mut estimator = estimator(0, model);
    let motion = Motion {
        position: 0.0,
        velocity: 1e20,
        acceleration: 1e20,
    };
    estimator.place(motion, core::iter::empty());
    let _ = estimator.update(1e17, None, false);
    let velocity = estimator.motion().velocity;
    assert!((velocity / 1e20 - 1.0).abs() < 0.1, "{velocity}");
}
