//! Errors between reference and axis.

use super::*;
use crate::servo::monitoring::bounds::FollowingBounds;

/// A loop that is quicker than its drive and waits for nothing.
const QUICK: Efforts = Efforts {
    bandwidth: f32::INFINITY,
    pushes: false,
    awaited: 0.0,
};

#[test]
fn an_error_that_no_lag_explains_and_that_stays_is_noticed() {
    let bounds = example::bounds(&MODEL);
    let until = |r: Setpoint, y: fn(u32) -> f32, pushes: bool| {
        let mut following = Following::default();
        let efforts = Efforts { pushes, ..QUICK };
        (1..200_000_u32).find(|k| following.update(&r, y(*k), &efforts, &bounds))
    };
    let rest = Setpoint::at(0.0);
    // What friction and a wrong flow leave at rest.
    let edge = bounds.following.error;
    assert!((1.0..100.0).contains(&edge), "{edge}");
    assert_eq!(until(Setpoint::at(0.99 * edge), |_| 0.0, false), None);
    let found = until(Setpoint::at(1.01 * edge), |_| 0.0, false);
    assert_eq!(found, Some(bounds.following.hundredths / 100 + 1));
    assert_eq!(until(Setpoint::at(-1.01 * edge), |_| 0.0, false), found);
    // While a push grows a sample counts a tenth.
    let pushed = until(Setpoint::at(1.01 * edge), |_| 0.0, true);
    assert_eq!(pushed, Some(bounds.following.hundredths / 10 + 1));
    // In a motion the lag of the loop is none.
    let fast = Setpoint {
        velocity: -300.0,
        ..rest
    };
    let lag = edge + 300.0 * bounds.following.lag;
    let behind = |error: f32| {
        let r = Setpoint {
            position: error,
            ..fast
        };
        until(r, |_| 0.0, false)
    };
    assert_eq!(behind(0.99 * lag), None);
    assert_eq!(behind(1.01 * lag), found);
    // An error that shrinks by a tenth in the time is worked off.
    let far = Setpoint::at(1000.0);
    assert_eq!(
        until(far, |k| 1000.0 - 900.0 * 0.9995_f32.powi(k as i32), false),
        None
    );
    let grows = until(far, |k| 0.01 * k as f32, false);
    assert!(grows.is_some_and(|k| k > bounds.following.hundredths / 100));
    // The memory of a speed lasts for four windows.
    let mut following = Following::default();
    let _ = following.update(&fast, 0.0, &QUICK, &bounds);
    for _ in 0..4 * 200 {
        let _ = following.update(&rest, 0.0, &QUICK, &bounds);
    }
    let at = |share: f32| Setpoint::at(edge + share * 300.0 * bounds.following.lag);
    let left = libm::expf(-1.0);
    let within = !following
        .clone()
        .update(&at(0.98 * left), 0.0, &QUICK, &bounds);
    assert!(within);
    let mut other = following.clone();
    let late = (0..10_u32).any(|_| other.update(&at(1.02 * left), 0.0, &QUICK, &bounds));
    assert!(!late, "it only begins to count");
}

#[test]
fn a_loop_that_is_slower_than_its_drive_has_as_much_more_time() {
    let bounds = example::bounds(&MODEL);
    let FollowingBounds {
        error,
        lag,
        hundredths,
    } = bounds.following;
    let after = |share: f32, pushes: bool, r: Setpoint| {
        let efforts = Efforts {
            bandwidth: share * bounds.frequency,
            pushes,
            awaited: 0.0,
        };
        let mut following = Following::default();
        (1..1_000_000_u32).find(|_| following.update(&r, 0.0, &efforts, &bounds))
    };
    // Time over that of a loop as fast as its drive, and lag over that.
    for (share, slower, behind) in [(3.0, 1.0, 1.0), (0.5, 2.0, 1.0), (0.1, 10.0, 2.5)] {
        let stays = Setpoint::at(1.01 * error);
        let expected = (slower * hundredths as f32 / 100.0) as u32 + 1;
        assert_eq!(after(share, false, stays), Some(expected), "{share}");
        let pushed = after(share, true, stays).expect("it ends");
        let tenth = pushed as f32 / (10.0 * expected as f32);
        assert!((tenth - 1.0).abs() < 0.01, "{share}: {pushed}");
        let moves = |part: f32| Setpoint {
            velocity: 300.0,
            ..Setpoint::at(error + part * behind * lag * 300.0)
        };
        assert_eq!(after(share, false, moves(0.99)), None, "{share}");
        assert_eq!(after(share, false, moves(1.01)), Some(expected), "{share}");
    }
    // Whatever a loop says of itself, the time ends.
    for share in [0.0, -1.0, f32::NAN] {
        let found = after(share, true, Setpoint::at(1.01 * error));
        assert!(
            found.is_some_and(|k| k <= hundredths + 1),
            "{share}: {found:?}"
        );
    }
}

#[test]
fn an_error_for_which_a_loop_waits_is_no_lag() {
    let bounds = example::bounds(&MODEL);
    let error = bounds.following.error;
    let found = |awaited: f32, share: f32| {
        let efforts = Efforts { awaited, ..QUICK };
        let mut following = Following::default();
        let r = Setpoint::at(share * error);
        (1..200_000_u32).any(|_| following.update(&r, 0.0, &efforts, &bounds))
    };
    for (awaited, share, stays) in [
        (0.0, 1.01, true),
        (0.5 * error, 0.99, false),
        (0.5 * error, 1.01, true),
        (2.0 * error, 1.99, false),
        (2.0 * error, 2.01, true),
    ] {
        assert_eq!(found(awaited, share), stays, "{awaited} {share}");
    }
}
