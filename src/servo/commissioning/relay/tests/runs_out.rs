//! An axis that runs away: when it obeys the other sign.

use super::*;

#[test]
fn an_axis_that_coasts_outward_keeps_its_sign_and_one_that_gains_speed_does_not() {
    for side in [1.0, -1.0] {
        // Of 0.1 per s within 30 ms; what gains little is braked for longer, and so is what the
        // first movement has left fast.
        for (speed, gain, turns) in [
            (0.2, -0.03, false),
            (0.2, 0.0, false),
            (0.2, 0.08, false),
            (0.2, 0.12, true),
            (0.3, 0.0, false),
        ] {
            let mut relay = beside(side);
            let mut last = 1.0;
            for k in 1..=195 {
                let time = STEP * k as f32;
                let v = speed + gain * (time - 0.155).max(0.0) / 0.03;
                let y = 0.5 + side * (0.02 + speed * time);
                match relay.update(y, side * v, STEP, AMPLITUDE) {
                    Relayed::Command { sign, .. } => last = sign,
                    other => panic!("{other:?}"),
                }
            }
            assert_eq!(
                last,
                if turns { -1.0 } else { 1.0 },
                "{side} {speed} {gain}"
            );
        }
    }
}

#[test]
fn an_axis_that_is_fast_all_at_once_obeys_the_other_sign_before_it_is_far() {
    for side in [1.0, -1.0] {
        // Looks every 30 or 31 ms: at 0.25 per s, behind 60 ms.
        for (speed, begins, turns) in [
            (0.24, 70, None),
            (0.26, 70, Some(90)),
            (0.26, 40, None),
            (0.6, 100, Some(120)),
        ] {
            let mut relay = beside(side);
            let turned = (1..=140).find(|k| {
                let v = if *k < begins { 0.0 } else { side * speed };
                reverses(&mut relay, 0.5 + 0.02 * side, v)
            });
            let near = |at: u32| turned.is_some_and(|k| (at..at + 4).contains(&k));
            let as_told = turns.map_or(turned.is_none(), near);
            assert!(as_told, "{side} {speed} {begins}: {turned:?}");
        }
    }
}

#[test]
fn an_axis_that_is_near_keeps_its_sign_whatever_speed_it_gains_late() {
    for side in [1.0, -1.0] {
        for (away, turns) in [(0.01, false), (0.029, false), (0.031, true)] {
            let mut relay = beside(side);
            let turned = (1..=230).any(|k| {
                let v = if k < 165 { 0.0 } else { 0.2 * side };
                reverses(&mut relay, 0.5 + away * side, v)
            });
            assert_eq!(turned, turns, "{side} {away}");
        }
    }
}

#[test]
fn an_axis_that_gains_speed_for_ever_keeps_its_sign_for_a_fifth_of_a_second() {
    for side in [1.0, -1.0] {
        // Three looks of 30 or 31 ms: 0.028 per s, of which 0.02 are too many, or 0.019 at most.
        for (growth, turns) in [(0.3, true), (0.2, false)] {
            let mut relay = beside(side);
            let turned = (1..=400).find(|k| {
                let time = STEP * *k as f32;
                let y = 0.5 + side * (0.04 + 0.5 * growth * time * time);
                reverses(&mut relay, y, side * growth * time)
            });
            // With the first look after that time.
            let soon = turned.is_some_and(|k| (200..=232).contains(&k));
            assert!(soon || !turns, "{side} {growth}: {turned:?}");
            assert_eq!(turned.is_some(), turns, "{side} {growth}");
        }
        // In each of them: one that gains more in two and no speed in the third keeps its sign.
        for (gains, turns) in [
            ([0.02, -0.01, 0.02], false),
            ([0.02, 0.0, 0.02], false),
            ([0.0, 0.02, 0.02], false),
            ([0.02, 0.02, 0.0], false),
            ([0.02, 0.01, 0.02], true),
        ] {
            let mut relay = beside(side);
            let mut speed = 0.0;
            let turned = (1..=260).any(|k| {
                speed += match k {
                    150 => gains[0],
                    180 => gains[1],
                    210 => gains[2],
                    _ => 0.0,
                };
                reverses(&mut relay, 0.5 + 0.04 * side, side * speed)
            });
            assert_eq!(turned, turns, "{side} {gains:?}");
        }
    }
}

#[test]
fn what_ran_away_once_does_so_again_at_twice_the_speed_that_it_then_had() {
    for side in [1.0, -1.0] {
        for (speed, turns) in [(0.5, false), (0.56, true)] {
            let mut relay = beside(side);
            let y = 0.5 + 0.02 * side;
            let first = (1..=140).find(|k| {
                let v = if *k < 70 { 0.0 } else { 0.26 * side };
                reverses(&mut relay, y, v)
            });
            assert!(first.is_some());
            // The other sign has driven it for 70 ms.
            let again = (1..=130).any(|k| {
                let v = if k < 70 { 0.26 } else { speed };
                !reverses(&mut relay, y, side * v)
            });
            assert_eq!(again, turns, "{side} {speed}");
        }
    }
}
