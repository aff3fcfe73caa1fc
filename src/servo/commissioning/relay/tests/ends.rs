//! The relay near an end of the travel.

use super::*;

#[test]
fn near_an_end_the_place_is_as_far_inwards_as_an_excitation_goes() {
    for (start, side, place, driven) in [
        (0.0, 1.0, 0.1, 1.0),
        (0.05, 1.0, 0.1, 1.0),
        (0.05, -1.0, 0.1, 1.0),
        (0.2, 1.0, 0.2, -1.0),
        (0.8, -1.0, 0.8, 1.0),
        (0.97, -1.0, 0.9, -1.0),
        (1.0, -1.0, 0.9, -1.0),
    ] {
        let mut relay = Relay::new(start, 5e-4, 0.1, 1.0, side);
        assert_eq!(relay.place, place, "{start}");
        let found = relay.update(start + 2e-3 * side, 0.0, STEP, AMPLITUDE);
        let Relayed::Command { command, .. } = found else {
            panic!("{found:?}");
        };
        assert_eq!(command.signum(), driven, "{start}");
        assert!(!relay.is_away(start) && relay.is_away(start + 0.04 * side));
    }
}

#[test]
fn what_the_axis_has_swung_inwards_has_twice_the_room_to_the_end() {
    for (end, inward) in [(0.0, 1.0), (1.0, -1.0)] {
        let at = |share: f32| end + inward * share;
        for (swing, place, goes_in) in [(0.04, 0.1, false), (0.08, 0.16, false), (0.15, 0.3, true)]
        {
            let mut relay = Relay::new(at(0.12), 5e-4, 0.1, 1.0, inward);
            relay.place = at(0.1);
            relay.braked = at(0.12);
            // It still moves inwards, and then it turns.
            let _ = relay.update(at(0.12 + 0.9 * swing), 0.5 * inward, STEP, AMPLITUDE);
            assert_eq!(relay.place, at(0.1));
            let _ = relay.update(at(0.12 + swing), 0.0, STEP, AMPLITUDE);
            assert!(
                (relay.place - at(place)).abs() < 1e-5,
                "{swing}: {}",
                relay.place
            );
            assert_eq!(relay.side == -inward, goes_in, "{swing}");
            assert_eq!(relay.switches, 1);
        }
    }
}

#[test]
fn an_axis_that_has_come_off_an_end_keeps_its_sign_on_the_way_inwards() {
    for (start, turns) in [(0.0, false), (0.02, true)] {
        // It swings back at 0.4 per s, 70 ms behind the first movement.
        let mut relay = Relay::new(start, 5e-4, 0.1, 1.0, 1.0);
        let turned = (1..=140).any(|k| {
            let v = if k < 70 { 0.0 } else { -0.4 };
            reverses(&mut relay, 0.04, v)
        });
        assert_eq!(turned, turns, "{start}");
    }
}

#[test]
fn a_command_that_was_unknown_grows_until_it_moves_the_axis() {
    let mut relay = Relay::new(0.0, 5e-4, 0.0, 1.0, 1.0);
    for _ in 0..150 {
        let _ = relay.update(1e-3, 0.0, STEP, AMPLITUDE);
    }
    assert!(
        (relay.moving() - 0.18 / 1.5).abs() < 2e-3,
        "{}",
        relay.moving()
    );
}

/// Command and sign of an axis that stands still at a place, of the last of so many samples.
fn standing(relay: &mut Relay, y: f32, samples: usize) -> [f32; 2] {
    let mut found = [0.0; 2];
    for _ in 0..samples {
        match relay.update(y, 0.0, STEP, AMPLITUDE) {
            Relayed::Command { command, sign } => found = [command, sign],
            other => panic!("{other:?}"),
        }
    }
    found
}

#[test]
fn what_comes_off_a_stop_under_the_other_direction_has_the_other_sign() {
    for (stop, inward) in [(0.0, 1.0), (1.0, -1.0)] {
        for (samples, turns) in [(200, true), (20, false)] {
            // A drift inwards had passed for the answer to the first movement.
            let mut relay = Relay::new(stop, 5e-4, 0.05, 1.0, inward);
            let [command, _] = standing(&mut relay, stop, 200);
            assert!(inward * command > 0.2, "inwards by that sign: {command}");
            relay.take(Standing::Exhausted, stop);
            let [before, _] = standing(&mut relay, stop, samples);
            assert!(inward * before < 0.0, "{before}");
            let off = stop + 2e-3 * inward;
            relay.take(Standing::Moved, off);
            let [command, sign] = standing(&mut relay, off, 1);
            // Sooner it is the late answer to the direction before.
            let (goes_on, expected) = if turns {
                (before, -1.0)
            } else {
                (-before, 1.0)
            };
            assert_eq!((sign, command.signum()), (expected, goes_on.signum()));
        }
    }
    // In the middle of the travel it is friction that lets go.
    let mut relay = Relay::new(0.5, 5e-4, 0.05, 1.0, 1.0);
    let [before, _] = standing(&mut relay, 0.5, 200);
    relay.take(Standing::Exhausted, 0.5);
    let _ = standing(&mut relay, 0.5, 200);
    relay.take(Standing::Moved, 0.502);
    let [command, sign] = standing(&mut relay, 0.502, 1);
    assert_eq!((sign, command.signum()), (1.0, before.signum()));
}
