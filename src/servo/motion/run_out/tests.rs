//! The run-out against its solution, and its promises against every sample of it.

use super::*;

const LIMITS: MotionLimits = MotionLimits {
    velocity: 800.0,
    acceleration: 9000.0,
    jerk: 2.5e5,
};

/// Numbers without a pattern, from -1 to 1.
fn draw(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*state >> 8) as f32 / 8_388_608.0 - 1.0
}

/// `x`, `v`, `a` and the jerk of the solution at `t`: two poles at the rate.
fn solution(rate: f32, from: &Motion, t: f32) -> [f32; 4] {
    let (v, w) = (from.velocity, from.acceleration + rate * from.velocity);
    let e = libm::expf(-rate * t);
    // The integral of (v + w t) e^(-rate t).
    let moved = (v + w / rate) / rate - e * ((v + w / rate) / rate + w * t / rate);
    [
        from.position + moved,
        e * (v + w * t),
        e * (w - rate * (v + w * t)),
        e * (-2.0 * rate * w + rate * rate * (v + w * t)),
    ]
}

#[test]
fn a_motion_runs_out_as_two_poles_do_and_ends() {
    let run_out = RunOut { rate: 30.0 };
    let from = Motion {
        position: 10.0,
        velocity: 300.0,
        acceleration: -4000.0,
    };
    let step = 1e-4;
    let mut s = Setpoint {
        position: from.position,
        velocity: from.velocity,
        acceleration: from.acceleration,
        jerk: 0.0,
    };
    for k in 1..=3000 {
        let (next, ended) = run_out.next(&s, step, &LIMITS);
        assert!(!ended);
        s = next;
        let [x, v, a, _] = solution(30.0, &from, step * k as f32);
        // First order in the step: half of 30/s times 0.1 ms.
        assert!((s.position - x).abs() < 0.02, "{k}: {} {x}", s.position);
        assert!((s.velocity - v).abs() < 0.6, "{k}: {} {v}", s.velocity);
        assert!(
            (s.acceleration - a).abs() < 25.0,
            "{k}: {} {a}",
            s.acceleration
        );
        let [.., jerk] = solution(30.0, &from, step * (k as f32 - 1.0));
        assert!((s.jerk - jerk).abs() < 1000.0, "{k}: {} {jerk}", s.jerk);
    }
    // It ends at rest, when neither velocity nor acceleration is left.
    let at = |velocity: f32, acceleration: f32| Setpoint {
        position: 5.0,
        velocity,
        acceleration,
        jerk: 0.0,
    };
    let [v, a] = [ENDED * LIMITS.velocity, ENDED * LIMITS.acceleration];
    for (s, ends) in [
        (at(0.9 * v, 0.9 * a), true),
        (at(-0.9 * v, -0.9 * a), true),
        (at(1.1 * v, 0.0), false),
        (at(0.0, -1.1 * a), false),
    ] {
        let (next, ended) = run_out.next(&s, 1e-6, &LIMITS);
        assert_eq!(ended, ends, "{s:?}");
        assert_eq!(next.velocity == 0.0 && next.acceleration == 0.0, ends);
        assert!((next.position - 5.0).abs() < 1e-3);
    }
}

#[test]
fn what_stays_within_the_travel_does_so_in_every_sample() {
    let travel = Travel {
        min: -50.0,
        max: 100.0,
    };
    let mut state = 1;
    let mut counts = [0; 2];
    for _ in 0..1000 {
        let run_out = RunOut {
            rate: 20.0 + 15.0 * draw(&mut state),
        };
        let from = Motion {
            position: 25.0 + 75.0 * draw(&mut state),
            velocity: 1500.0 * draw(&mut state),
            acceleration: 30_000.0 * draw(&mut state),
        };
        let places = (0..4000).map(|k| {
            let [x, ..] = solution(run_out.rate, &from, 1e-3 * k as f32);
            x
        });
        let (low, high) = places.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        // Between the samples, and by rounding.
        if (low - travel.min).abs() < 0.01 || (high - travel.max).abs() < 0.01 {
            continue;
        }
        let inside = low > travel.min && high < travel.max;
        let promised = run_out.stays_within(&from, &travel);
        assert!(!promised || inside, "{from:?} {low} {high}");
        // What it refuses leaves, or would if its velocity did not fade before it turns.
        let turn = -from.velocity / (from.acceleration + run_out.rate * from.velocity);
        let reached = from.position + turn * from.velocity;
        let bound = turn > 0.0 && !travel.contains(reached);
        assert!(promised || !inside || bound, "{from:?} {low} {high}");
        counts[usize::from(promised)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 150), "{counts:?}");
}

#[test]
fn what_keeps_its_limits_does_so_in_every_sample() {
    let mut state = 2;
    let mut counts = [0; 2];
    for _ in 0..700 {
        let rate = 20.0 + 15.0 * draw(&mut state);
        let from = Motion {
            position: 0.0,
            velocity: 900.0 * draw(&mut state),
            acceleration: 12_000.0 * draw(&mut state),
        };
        let (mut a, mut j) = (0.0_f32, 0.0_f32);
        for k in 0..2000 {
            let [_, _, acceleration, jerk] = solution(rate, &from, 2e-4 * k as f32);
            (a, j) = (a.max(acceleration.abs()), j.max(jerk.abs()));
        }
        let kept = a <= LIMITS.acceleration && j <= LIMITS.jerk;
        let keeps = RunOut { rate }.keeps(&from, &LIMITS);
        // It promises no more than is true; what it refuses is near a limit.
        assert!(!keeps || kept, "{rate} {from:?} {a} {j}");
        let near = a > 0.999 * LIMITS.acceleration
            || rate * (2.0 * from.acceleration.abs() + rate * from.velocity.abs()) > LIMITS.jerk;
        assert!(keeps || near, "{rate} {from:?} {a} {j}");
        counts[usize::from(keeps)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 70), "{counts:?}");
}

#[test]
fn a_motion_that_never_turns_stays_within_the_travel_where_its_end_does() {
    let travel = Travel {
        min: -50.0,
        max: 100.0,
    };
    let run_out = RunOut { rate: 20.0 };
    // `a = -rate v` is one pole: `v e^(-rate t)` goes by `v / rate`, 95 of 100 and 45 of 50.
    for (velocity, within) in [
        (0.0, true),
        (1900.0, true),
        (2100.0, false),
        (-900.0, true),
        (-1100.0, false),
    ] {
        let from = Motion {
            position: 0.0,
            velocity,
            acceleration: -20.0 * velocity,
        };
        assert_eq!(run_out.stays_within(&from, &travel), within, "{velocity}");
    }
}
