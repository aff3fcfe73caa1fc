//! Drives that go their own way, and those that only swing.

use super::*;

const STEP: f32 = 1e-3;
const SCALE: [f32; 2] = [1e-3, STEP];

/// A drive of order 3 with `w` and `xi` and a gain of one travel per s, from a velocity and
/// acceleration, under a constant flow; the largest velocity that it is found to have against it.
fn found(w: f32, xi: f32, [v, a]: [f32; 2], flow: f32, swings: f32) -> Option<f32> {
    let (mut y, mut v, mut a) = (0.5_f32, v, a);
    let mut defiance = Defiance::default();
    for _ in 0..4000 {
        if let Some(velocity) = defiance.update(y, [flow, flow], [0.0, swings], SCALE) {
            return Some(velocity);
        }
        for _ in 0..10 {
            let jerk = w * w * (flow - v) - 2.0 * xi * w * a;
            y += 0.1 * STEP * v;
            v += 0.1 * STEP * a;
            a += 0.1 * STEP * jerk;
        }
    }
    None
}

#[test]
fn a_swing_is_no_defiance_whatever_it_begins_with() {
    let mut state = 1_u32;
    let mut draw = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    for _ in 0..300 {
        let w = 8.0 + 140.0 * draw();
        let xi = 0.02 + 1.2 * draw() * draw();
        let start = [2.0 * draw() - 1.0, w * (2.0 * draw() - 1.0)];
        let flow = (0.05 + 0.4 * draw()) * if draw() < 0.5 { 1.0 } else { -1.0 };
        let swings = core::f32::consts::TAU / w + 2.0 * xi / w;
        assert_eq!(
            found(w, xi, start, flow, swings),
            None,
            "{w} {xi} {start:?} {flow}"
        );
        // A valve that opens the other way.
        let mut defiance = Defiance::default();
        let velocity = (0..4000).find_map(|k| {
            let y = 0.5 - flow * STEP * k as f32;
            defiance.update(y, [flow, flow], [0.02, swings], SCALE)
        });
        let velocity = velocity.expect("it goes against the flow");
        assert!((velocity / -flow - 1.0).abs() < 0.05, "{velocity} {flow}");
    }
}

#[test]
fn drive_and_time_must_both_be_used_up() {
    let calls = |held: f32, swings: f32, flow: f32| {
        let mut defiance = Defiance::default();
        (0..10_000).position(|k| {
            let y = 0.5 - 0.5 * STEP * k as f32;
            let seen = defiance.update(y, [0.3, flow], [held, swings], SCALE);
            seen.is_some()
        })
    };
    // Four samples more for the movements that count at half a travel per s.
    for (held, swings, samples) in [(0.02, 0.1, 200), (0.02, 0.5, 500), (0.1, 0.1, 1000)] {
        let found = calls(held, swings, 0.1).expect("it defies");
        assert!(
            (samples..samples + 10).contains(&found),
            "{held} {swings}: {found}"
        );
    }
    // A command that may be no flow says nothing.
    assert_eq!(calls(0.0, 0.0, 0.0), None);
}

#[test]
fn a_closed_valve_says_why() {
    for direction in [1.0, -1.0] {
        let after = |share: f32, place: f32| {
            let mut closing = ValveClosing::new(0.2 * direction, 0.1);
            (0..1000).find_map(|k| {
                let v = direction * 0.2 * if k < 50 { 1.0 } else { share };
                let shown = closing.update(place, v, STEP);
                shown.map(|shown| (k, shown))
            })
        };
        let end = 0.5 + 0.495 * direction;
        // 1.2 half periods and 40 ms.
        let takes = |found: Option<(i32, Shown)>, shown| {
            let (samples, found) = found.expect("it ends");
            assert_eq!(found, shown);
            assert!((158..163).contains(&samples), "{samples}");
        };
        takes(after(0.4, 0.5), Shown::Why(Reason::WrongSign));
        takes(after(0.6, 0.5), Shown::Why(Reason::ValveStuck));
        // An end stops everything.
        takes(after(0.0, end), Shown::Nothing);
        // What has slowed down comes to it.
        let mut slow = ValveClosing::new(0.2 * direction, 0.1);
        assert_eq!(slow.update(0.5, 0.08 * direction, STEP), None);
        assert_eq!(
            slow.update(end, 0.08 * direction, STEP),
            Some(Shown::Why(Reason::WrongSign))
        );
        // Beyond its travel no axis goes.
        let beyond = 0.5 + 0.511 * direction;
        assert_eq!(after(1.0, beyond), Some((0, Shown::Why(Reason::WrongSign))));
    }
}

#[test]
fn in_doubt_a_closed_valve_shows_nothing_but_that_the_axis_stops() {
    for direction in [1.0, -1.0] {
        // It stops in its tenth sample.
        let mut closing = ValveClosing::in_doubt(0.2 * direction, 0.1);
        let stops = (1..1000).find_map(|k| {
            let v = direction * 0.02 * (10.0 - k as f32);
            closing.update(0.5, v, STEP).map(|shown| (k, shown))
        });
        assert_eq!(stops, Some((10, Shown::Stops)));
        // What goes on does so for 1.2 half periods and 40 ms, at an end too.
        for place in [0.5, 0.5 + 0.495 * direction] {
            let mut closing = ValveClosing::in_doubt(0.2 * direction, 0.1);
            let over = (1..1000).find_map(|k| {
                let shown = closing.update(place, 0.05 * direction, STEP);
                shown.map(|shown| (k, shown))
            });
            let (samples, shown) = over.expect("it ends");
            assert_eq!(shown, Shown::Stops);
            assert!((159..164).contains(&samples), "{samples}");
        }
        let mut closing = ValveClosing::in_doubt(0.2 * direction, 0.1);
        let beyond = closing.update(0.5 + 0.511 * direction, 0.2 * direction, STEP);
        assert_eq!(beyond, Some(Shown::Why(Reason::WrongSign)));
    }
}
