use super::*;

/// A sensor without noise and one of variance 1, a drive of 0.01 within a sample.
const PLAN: StartPlan = StartPlan {
    bend: 0.01,
    longest: 30,
};

/// What is said after each sample of a beginning; the noise is known after ten.
fn said(y: impl Fn(f32) -> f32, noise: f32, plan: StartPlan) -> (u32, Verdict) {
    let mut start = Start::new(y(0.0));
    for k in 0..1000_u16 {
        let known = if k < 9 { -1.0 } else { noise };
        let verdict = start.take(y(f32::from(k)), known, plan);
        if verdict != Verdict::Wait {
            return (u32::from(k) + 1, verdict);
        }
    }
    (1000, Verdict::Wait)
}

#[test]
fn a_line_is_as_long_as_chance_outweighs_the_bend() {
    // 0.01 n^2 against 2 / sqrt(n).
    let crossing = |noise: f32, plan| said(|k| 3.0 + 0.5 * k, noise, plan).0;
    assert_eq!(crossing(1.0, PLAN), 10);
    let bend = 1e-4;
    assert_eq!(crossing(1.0, StartPlan { bend, longest: 99 }), 53);
    assert_eq!(crossing(100.0, StartPlan { bend, longest: 99 }), 99);
    assert_eq!(crossing(1.0, StartPlan { bend, longest: 30 }), 30);
    // What has no noise does not wait; what is not known waits as long as it may.
    assert_eq!(crossing(0.0, PLAN), 10);
    assert_eq!(crossing(-1.0, PLAN), 30);
}

#[test]
fn the_line_begins_where_it_is_met() {
    // y(0) is off by 5, all others are on a line through -2.
    let y = |k: f32| if k == 0.0 { 3.0 } else { 0.5 * k - 2.0 };
    let bend = 1e-4;
    let (n, verdict) = said(y, 1.0, StartPlan { bend, longest: 99 });
    let Verdict::Begin(at) = verdict else {
        panic!("{verdict:?}");
    };
    // The first sample itself draws with 4/n, less 2/n^2.
    let n = n as f32;
    let own = 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0));
    assert!((at + 5.0 * (1.0 - own)).abs() < 1e-4, "{at}");
}

#[test]
fn a_sensor_without_noise_keeps_its_first_sample() {
    for noise in [0.0, 1e-3] {
        assert_eq!(said(|k| k * k, noise, PLAN), (10, Verdict::Stay));
    }
}

#[test]
fn what_has_no_memory_or_is_sampled_slowly_has_no_start_to_find() {
    let plan = StartPlan::new(50.0, 0.02, true);
    assert!((plan.bend - 50.0 * 4e-4 / 12.0).abs() < 1e-9);
    assert_eq!(plan.longest, 50);
    assert_eq!(StartPlan::new(50.0, 0.02, false).longest, 0);
    assert_eq!(StartPlan::new(50.0, 0.11, true).longest, 0);
}

#[test]
fn whatever_is_drawn_it_ends_and_is_finite() {
    let mut state = 7_u32;
    let mut draw = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    for _ in 0..2000 {
        let mut size = || libm::powf(10.0, 6.0 * draw());
        let (range, angle, noise, scale) = (size(), 0.05 * size().min(1.0), size(), size());
        let plan = StartPlan::new(range, angle, true);
        if plan.longest == 0 || plan.longest > 100_000 {
            continue;
        }
        let mut start = Start::new(scale);
        for k in 0.. {
            match start.take(scale * draw(), noise, plan) {
                Verdict::Wait => assert!(k < plan.longest),
                Verdict::Begin(at) => {
                    assert!(at.is_finite());
                    break;
                }
                Verdict::Stay => break,
            }
        }
    }
}

#[test]
fn where_a_line_begins_is_known_as_well_as_it_says() {
    let mut state = 3_u32;
    // Of variance 1: even within +-sqrt(3).
    let mut draw = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((state >> 8) as f32 / 8_388_608.0 - 1.0) * 3_f32.sqrt()
    };
    let (bend, mut sum, mut said) = (1e-4, 0.0, 0.0);
    for _ in 0..4000 {
        let first = draw();
        let mut start = Start::new(first);
        let at = (0..).find_map(|k| {
            let y = if k == 0 { first } else { draw() };
            match start.take(y, 1.0, StartPlan { bend, longest: 40 }) {
                Verdict::Wait => None,
                Verdict::Begin(at) => Some(at + first),
                Verdict::Stay => Some(0.0),
            }
        });
        let at = at.expect("a begin");
        sum += at * at;
        said += start.variance();
    }
    // 4/n, which is 2/n^2 too much.
    assert!((sum / said - 1.0).abs() < 0.1, "{sum} {said}");
}
