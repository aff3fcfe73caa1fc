//! The window: what rests in it, and what widens it.

use super::*;

const WINDOW: RestDesign = RestDesign {
    least: 0.01,
    most: 0.1,
    sticky: true,
    lead: 0.0,
};

#[test]
fn a_window_rests_the_axis_and_narrows_with_a_stop_at_once() {
    let fresh = RestWindow::new(&WINDOW);
    assert_eq!((fresh.window(), fresh.rests()), (0.01, false));
    // It rests where it stands within the window, and goes on where it leaves 1.3 of it.
    let mut window = fresh.clone();
    window.update(0.011, true);
    assert!(!window.rests());
    window.update(-0.0099, false);
    assert!(!window.rests(), "it moves");
    window.update(-0.0099, true);
    assert!(window.rests() && window.window() == 0.01);
    window.update(0.0129, true);
    assert!(window.rests());
    window.update(-0.0131, true);
    assert!(!window.rests());
    assert_eq!(window.window(), 0.01, "a slip from the rest is no hunt");
    // A stop at the first attempt narrows it by a fifth, but not below where it stands.
    window.overshot(0.05);
    window.overshot(0.05);
    window.wake();
    let mut wide = window.clone();
    wide.update(0.001, true);
    assert!((wide.window() - 0.8 * window.window()).abs() < 1e-6 && wide.rests());
    let mut held = window.clone();
    held.update(0.015, true);
    assert!((held.window() - 0.015).abs() < 1e-7);
    // Neither a stop behind a slip from the rest narrows it nor one behind a hunt.
    let before = wide.window();
    wide.update(0.05, true);
    wide.update(0.001, true);
    assert_eq!((wide.window(), wide.rests()), (before, true));
    window.overshot(0.05);
    let before = window.window();
    window.update(0.001, true);
    assert_eq!((window.window(), window.rests()), (before, true));
}

#[test]
fn a_window_widens_with_each_hunt() {
    // From one side beyond it to the other: the overshoot of an approach, then hunts.
    let mut window = RestWindow::new(&WINDOW);
    for (error, hunts) in [
        (0.02, 0),
        (0.03, 0),
        (-0.02, 0),
        (-0.02, 0),
        (0.02, 1),
        (-0.02, 2),
        (0.0, 2),
    ] {
        window.update(error, false);
        let expected = 0.01 * f32::powi(1.25, hunts);
        assert!(
            (window.window() - expected).abs() < 1e-6,
            "{error}: {}",
            window.window()
        );
    }
    // An axis that friction cannot hold has no other end of its approach.
    let mut free = RestWindow::new(&RestDesign {
        sticky: false,
        ..WINDOW
    });
    free.update(0.02, false);
    free.update(-0.02, false);
    assert!((free.window() - 0.0125).abs() < 1e-7);
    // Neither has it one in the next motion, where an axis that friction holds has.
    for (other, hunts) in [(&mut free, 2), (&mut window.clone(), 2)] {
        other.wake();
        other.update(0.02, false);
        other.update(-0.02, false);
        let expected = 0.01 * f32::powi(1.25, hunts);
        assert!((other.window() - expected).abs() < 1e-6);
    }
    // A reference that moves and an axis that stands begin anew; the window is kept.
    for stands in [false, true] {
        for error in [0.02, -0.02, 0.02, -0.02] {
            if stands {
                window.update(error, true);
            } else {
                window.wake();
            }
            window.update(error, false);
        }
    }
    assert!((window.window() - 0.01 * 1.25 * 1.25).abs() < 1e-6);
}

#[test]
fn a_hop_past_the_target_is_a_hunt_within_the_limits_of_the_window() {
    let mut hopped = RestWindow::new(&WINDOW);
    // A hop past the target is a hunt where it is beyond the window.
    hopped.overshot(0.009);
    assert_eq!(hopped.window(), 0.01);
    hopped.overshot(-0.011);
    assert!((hopped.window() - 0.0125).abs() < 1e-7);
    assert!(hopped.can_widen());
    for _ in 0..50 {
        hopped.overshot(1.0);
    }
    assert!(!hopped.can_widen());
    assert_eq!(hopped.window(), 0.1);
    // With another model half of it is kept, and never less than the least.
    let mut forgotten = hopped.clone();
    for kept in [0.05, 0.025, 0.0125, 0.01] {
        forgotten.forget();
        assert_eq!(forgotten.window(), kept);
    }
    hopped.redesign(&RestDesign {
        most: 0.05,
        ..WINDOW
    });
    assert_eq!(hopped.window(), 0.05);
    hopped.redesign(&RestDesign {
        least: 0.2,
        most: 0.3,
        ..WINDOW
    });
    assert_eq!(hopped.window(), 0.2);
}

#[test]
fn an_axis_that_nothing_holds_and_that_comes_back_on_one_side_hunts() {
    let free = RestWindow::new(&RestDesign {
        sticky: false,
        ..WINDOW
    });
    let after = |errors: &[f32]| {
        let mut window = free.clone();
        for error in errors {
            window.update(*error, false);
        }
        window.window() / free.window()
    };
    // Well inside, then beyond what freezes the integral action: once for each time inside.
    for side in [1.0, -1.0] {
        let cycle = [0.004, 0.014, 0.0149, 0.016, 0.02, 0.006].map(|error| side * error);
        assert_eq!(after(&cycle), 1.25);
        let mut twice = [0.0; 7];
        twice[..6].copy_from_slice(&cycle);
        twice[6] = side * 0.019;
        assert!((after(&twice) - 1.25 * 1.25).abs() < 1e-6);
    }
    // Neither an approach, nor one that was not well inside, nor a motion between both.
    assert_eq!(after(&[0.05, 0.02, 0.0051, 0.02]), 1.0);
    let mut moved = free.clone();
    moved.update(0.004, false);
    moved.wake();
    moved.update(0.02, false);
    assert_eq!(moved, {
        let mut other = free.clone();
        other.update(0.02, false);
        other
    });
    // An axis that friction holds passes through.
    let mut sticky = RestWindow::new(&WINDOW);
    sticky.update(0.004, false);
    sticky.update(0.02, false);
    assert_eq!(sticky.window(), 0.01);
}
