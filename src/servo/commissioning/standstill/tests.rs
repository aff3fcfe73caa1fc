//! Drives that friction explains, and those that it does not.

use super::*;
use crate::servo::commissioning::probe::LATENESS;
use crate::servo::motion::Motion;

const STEP: f32 = 1e-3;

const MODEL: Theta = Theta {
    a1: 400.0,
    a2: 20.0,
    b0: 800.0,
    dead_zone: 0.05,
    offset: 0.01,
    friction: 3.0,
    delay: 0.01,
    kappa: 0.0,
    stiffening: 0.0,
    imbalance: 0.0,
};

/// Calls until a constant command is more than friction explains.
fn until(
    standstill: &mut Standstill,
    command: f32,
    model: Option<&Theta>,
) -> Option<(u32, Standing)> {
    (1..60_000).find_map(|k| {
        let standing = standstill.update(0.5, true, command, STEP, model);
        (standing != Standing::HeldByFriction).then_some((k, standing))
    })
}

/// The drive that moved the axis first: half of the command at 1.5 per s.
fn first(command: f32) -> f32 {
    let flow = 0.5 * command;
    5.4 * flow * flow / 3.0
}

#[test]
fn what_moved_the_axis_first_moves_it_from_wherever_friction_holds_it() {
    for command in [0.1_f32, 0.3] {
        for upward in [true, false] {
            let side = if upward { 1.0 } else { -1.0 };
            let fresh = Standstill::new(0.5, 1e-3, command, upward);
            // In the direction of the first movement the valve opens at half of its command.
            let flow = 0.4 - 0.5 * command;
            let needed = first(command) + 0.08 * flow;
            let (calls, standing) = until(&mut fresh.clone(), side * 0.4, None).expect("exhausted");
            assert_eq!(standing, Standing::Exhausted);
            let drive = STEP * calls as f32 * flow;
            assert!(
                (drive / needed - 1.0).abs() < 0.01,
                "{command} {upward}: {drive} {needed}"
            );
            // The other direction may open later by twice an offset of 0.08.
            let flow = flow - 0.16;
            let needed = first(command) + 0.08 * flow;
            let mut other = fresh;
            let (calls, _) = until(&mut other, -side * 0.4, None).expect("exhausted");
            let drive = STEP * calls as f32 * flow;
            assert!(
                (drive / needed - 1.0).abs() < 0.01,
                "{command} {upward}: {drive} {needed}"
            );
            // Both directions: nothing moves what must move.
            let (_, standing) = (0..60_000)
                .map(|k| (k, other.update(0.5, true, side * 0.4, STEP, None)))
                .find(|(_, standing)| *standing == Standing::Unresponsive)
                .expect("both are used up");
            assert_eq!(standing, Standing::Unresponsive);
            // A command that the valve may not pass is none.
            for closed in [0.49 * side * command, -side * (0.5 * command + 0.15)] {
                assert_eq!(until(&mut fresh.clone(), closed, None), None);
            }
            let [own, opposite] = [fresh.push(upward), fresh.push(!upward)];
            assert!((own - 1.5 * command).abs() < 1e-6);
            assert!((opposite - own - 0.16).abs() < 1e-6);
        }
    }
}

#[test]
fn a_movement_begins_anew_and_what_friction_held_is_remembered() {
    let mut standstill = Standstill::new(0.5, 1e-3, 0.1, true);
    for _ in 0..400 {
        let _ = standstill.update(0.5, true, 0.15, STEP, None);
    }
    let held = 0.4 * 0.1;
    for y in [0.5005, 0.4995] {
        assert_eq!(
            standstill.update(y, true, 0.0, STEP, None),
            Standing::HeldByFriction
        );
    }
    assert_eq!(
        standstill.update(0.5011, true, 0.0, STEP, None),
        Standing::Moved
    );
    assert_eq!((standstill.anchor, standstill.drive), (0.5011, 0.0));
    // Half as much again as friction held in good work.
    let silent = |standstill: &mut Standstill, drive: f32| {
        let calls = (drive / (STEP * 0.1)) as u32;
        (0..calls)
            .all(|_| standstill.update(0.5011, true, 0.15, STEP, None) == Standing::HeldByFriction)
    };
    assert!(first(0.1) < held);
    let needed = 1.5 * held + 0.08 * 0.1;
    assert!(silent(&mut standstill.clone(), 0.98 * needed));
    assert!(!silent(&mut standstill.clone(), 1.03 * needed));
    assert_eq!(
        standstill.update(0.5, true, 0.0, STEP, None),
        Standing::Moved,
        "downward too"
    );
    // Noise may hide a slow motion: twice as much.
    let mut noisy = Standstill::new(0.5, 1e-3, 0.3, true);
    let mut quiet = noisy;
    let _ = noisy.update(0.5, false, 0.0, STEP, None);
    let [a, b] = [&mut noisy, &mut quiet].map(|s| until(s, 0.4, None).map_or(0, |(k, _)| k));
    assert!((a as f32 / b as f32 - 2.0).abs() < 0.02, "{a} {b}");
    assert!(noisy.code_changes() && !quiet.code_changes());
}

#[test]
fn a_model_says_what_friction_holds_and_when_motion_comes() {
    let fresh = Standstill::new(0.5, 1e-3, 0.1, true);
    for (command, flow) in [(0.3, 0.26), (-0.3, -0.24)] {
        // Five Coulomb frictions and two movements of the axis, then 2 rad of its frequency.
        let held: f32 = (5.0 * 3.0 + 2.0 * 1e-3 * 400.0) / 800.0;
        let needed = held.max(first(0.1)) + (0.01 + 2.0 / 20.0) * f32::abs(flow);
        let (calls, _) = until(&mut fresh.clone(), command, Some(&MODEL)).expect("exhausted");
        let drive = STEP * calls as f32 * f32::abs(flow);
        assert!(
            (drive / needed - 1.0).abs() < 0.01,
            "{command}: {drive} {needed}"
        );
    }
    for closed in [0.039, -0.059] {
        assert_eq!(until(&mut fresh.clone(), closed, Some(&MODEL)), None);
    }
    // Half a period says the same before there is a model.
    let mut informed = fresh;
    informed.inform(core::f32::consts::PI / 20.0, 0.0);
    assert!((informed.relayed.late - (2.0 / 20.0 + 0.02)).abs() < 1e-5);
    // A sign that was mistaken: the larger command counts, and either side may open later.
    let mut mistaken = fresh;
    mistaken.mistook(0.2);
    assert!((mistaken.push(true) - (0.3 + 0.16)).abs() < 1e-6);
    assert_eq!(mistaken.push(true), mistaken.push(false));
    assert!((mistaken.first - first(0.2)).abs() < 1e-6);
    mistaken.mistook(0.05);
    assert!((mistaken.push(true) - (0.3 + 0.16)).abs() < 1e-6);
}

#[test]
fn a_movement_is_of_the_other_sign_only_where_its_own_was_used_up_and_that_one_tried() {
    for upward in [true, false] {
        let side = if upward { 1.0 } else { -1.0 };
        // The other way counts after half of the 80 ms by which motion may come late.
        for (used_up, tried, turned) in [(true, 44, true), (true, 36, false), (false, 44, false)] {
            let mut standstill = Standstill::new(0.5, 1e-3, 0.1, upward);
            let calls = until(&mut standstill.clone(), side * 0.4, None).map_or(0, |(k, _)| k);
            let calls = if used_up { calls } else { calls / 2 };
            for _ in 0..calls {
                let _ = standstill.update(0.5, true, side * 0.4, STEP, None);
            }
            // The other way, by less than friction holds.
            for _ in 0..tried {
                let standing = standstill.update(0.5, true, -side * 0.4, STEP, None);
                assert_ne!(standing, Standing::Unresponsive);
            }
            let moved = standstill.update(0.5 + 2e-3 * side, false, -side * 0.4, STEP, None);
            assert_eq!(moved, Standing::Moved);
            assert_eq!(standstill.turned(), turned, "{upward} {used_up} {tried}");
        }
    }
}

#[test]
fn the_drive_counts_from_where_it_was_furthest_the_other_way() {
    let fresh = Standstill::new(0.5, 1e-3, 0.1, true);
    for command in [0.3, -0.3] {
        let (alone, _) = until(&mut fresh.clone(), command, Some(&MODEL)).expect("exhausted");
        let mut standstill = fresh;
        for _ in 0..alone / 2 {
            let standing = standstill.update(0.5, true, -command, STEP, Some(&MODEL));
            assert_eq!(standing, Standing::HeldByFriction);
        }
        let (calls, standing) = until(&mut standstill, command, Some(&MODEL)).expect("exhausted");
        assert_eq!(standing, Standing::Exhausted);
        assert!(
            calls.abs_diff(alone) <= 1,
            "{command}: {calls}, not {alone}"
        );
    }
}

#[test]
fn a_dead_zone_is_no_wider_than_the_command_that_moved_the_axis_first() {
    let fresh = Standstill::new(0.5, 1e-3, 0.1, true);
    // A dead zone as wide as all commands is that of an axis that stood against them.
    let wide = Theta {
        dead_zone: 0.6,
        offset: 0.0,
        ..MODEL
    };
    for (command, closed) in [(0.4, 0.1), (-0.4, 0.1 + 0.16)] {
        let flow = 0.4 - closed;
        let held = first(0.1).max(Known::of(&wide, 1e-3).held);
        let needed = held + Known::of(&wide, 1e-3).late * flow;
        let (calls, standing) = until(&mut fresh.clone(), command, Some(&wide)).expect("exhausted");
        assert_eq!(standing, Standing::Exhausted);
        let drive = STEP * calls as f32 * flow;
        assert!(
            (drive / needed - 1.0).abs() < 0.02,
            "{command}: {drive} {needed}"
        );
    }
}

#[test]
fn on_a_stop_the_other_direction_first_takes_back_what_has_pressed() {
    for (place, inward) in [(0.5, -1.0), (0.999, -1.0), (0.001, 1.0)] {
        let mut standstill = Standstill::new(place, 1e-3, 0.1, true);
        let mut calls = |command: f32, found: Standing| {
            (1..60_000)
                .position(|_| standstill.update(place, true, command, STEP, Some(&MODEL)) == found)
        };
        let pressed = calls(0.3 * inward, Standing::Exhausted).expect("the first direction");
        let back = calls(-0.3 * inward, Standing::Unresponsive).expect("the other one");
        let at_end = place != 0.5;
        // The flows differ by the offset.
        let share = back as f32 / pressed as f32;
        let exact = if at_end { 2.0 } else { 1.0 };
        assert!((share - exact).abs() < 0.2, "{place}: {pressed} {back}");
    }
}

#[test]
fn a_strike_begins_anew() {
    let mut standstill = Standstill::new(0.5, 1e-3, 0.1, true);
    for _ in 0..50 {
        let _ = standstill.update(0.99, true, 0.3, STEP, Some(&MODEL));
    }
    let held = standstill.held;
    standstill.strike(1.0);
    assert_eq!((standstill.anchor, standstill.drive), (1.0, 0.0));
    assert_eq!(standstill.defiance, Defiance::default());
    assert_eq!(standstill.held, held);
    assert!(!standstill.turned());
}

#[test]
fn a_swing_takes_a_period_and_more_where_damping_slows_it() {
    let mut standstill = Standstill::new(0.5, 1e-3, 0.1, true);
    for (a2, slower) in [(0.0, 0.0), (20.0, 0.05), (160.0, 0.4)] {
        let model = Theta { a2, ..MODEL };
        let exact = 0.01 + core::f32::consts::TAU / 20.0 + slower;
        assert!((Known::of(&model, 1e-3).swing - exact).abs() < 1e-5, "{a2}");
    }
    // The longer one of model and relay, whose half periods are two of them.
    standstill.inform(0.8, 0.0);
    let swing = standstill.known(Some(&MODEL)).swing;
    assert!((swing - 1.6 - LATENESS).abs() < 1e-5, "{swing}");
    // Before there is a model what a relay shows of a lightly damped axis is too short: 0.3 s.
    for (half, exact) in [(0.05, 0.3), (0.135, 0.3), (0.145, 0.31), (0.8, 1.62)] {
        standstill.inform(half, 0.0);
        let swing = standstill.known(None).swing;
        assert!((swing - exact).abs() < 1e-5, "{half}: {swing}");
    }
}

#[test]
fn a_model_says_how_far_a_swing_takes_an_axis_better_than_a_relay() {
    for (model, frequency) in [(None, 5.0 / 1.2), (Some(MODEL), 20.0)] {
        let mut standstill = Standstill::new(0.5, 1e-3, 0.1, true);
        standstill.inform(core::f32::consts::PI / 5.0, 0.0);
        // It goes back at half a travel per s, as an axis does that swings by that over w.
        let gone = (0..1000).find_map(|k| {
            let position = 0.5 - 0.5 * STEP * k as f32;
            let _ = standstill.update(position, false, 0.3, STEP, model.as_ref());
            let motion = Motion {
                velocity: -0.5,
                ..Motion::at(position)
            };
            (standstill.is_out_of_reach(&motion, 0.3, STEP)).then_some(0.5 - position)
        });
        // Two swings behind where it was after the lateness, and two movements that count.
        let exact = 0.5 * LATENESS + 2.0 * 0.5 / frequency + 2e-3;
        let gone = gone.expect("no swing goes on");
        assert!((gone - exact).abs() < 2e-3, "{frequency}: {gone} {exact}");
    }
}
