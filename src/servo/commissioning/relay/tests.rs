//! The relay on drives that obey, that do not, and that obey the other sign.

mod ends;
mod late;
mod runs_out;

use super::*;
use crate::servo::commissioning::standstill::Standing;

const STEP: f32 = 1e-3;
const AMPLITUDE: f32 = 0.4;

/// A drive of 20 rad/s with a gain per s in travels, moved to `side` of 0.5 by a first command.
struct Drive {
    at: [f32; 3],
    gain: f32,
}

impl Drive {
    const fn new(gain: f32, side: f32) -> Self {
        Self {
            at: [0.5, 0.02 * side, 0.0],
            gain,
        }
    }

    fn step(&mut self, command: f32) {
        let [x, v, a] = self.at;
        let jerk = 400.0 * (self.gain * command - v) - 20.0 * a;
        self.at = [x + STEP * v, v + STEP * a, a + STEP * jerk];
    }
}

/// The relay of an axis that a command of 0.1 has moved to `side` of 0.5.
fn beside(side: f32) -> Relay {
    Relay::new(0.5, 5e-4, 0.1, 1.0, side)
}

/// What the relay ends with, after how many samples, and its largest command.
fn ended(relay: &mut Relay, drive: &mut Drive) -> (Relayed, u32, f32) {
    let mut largest = 0.0_f32;
    for k in 1.. {
        let [x, v, _] = drive.at;
        match relay.update(x, v, STEP, AMPLITUDE) {
            Relayed::Command { command, .. } => {
                assert!(command.abs() <= AMPLITUDE);
                largest = largest.max(command.abs());
                drive.step(command);
            }
            other => return (other, k, largest),
        }
    }
    (Relayed::Disobeys, 0, largest)
}

/// Whether the relay takes the other sign, of an axis that is at `y` and has the velocity `v`.
fn reverses(relay: &mut Relay, y: f32, v: f32) -> bool {
    match relay.update(y, v, STEP, AMPLITUDE) {
        Relayed::Command { sign, .. } => sign < 0.0,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_drive_that_obeys_is_braked_and_turned() {
    for side in [1.0, -1.0] {
        for wires in [1.0, -1.0] {
            let mut relay = Relay::new(0.5, 5e-4, 0.1, wires, side);
            let mut drive = Drive::new(wires * 2.0, side);
            let (found, samples, largest) = ended(&mut relay, &mut drive);
            let Relayed::Obeys { half, sign } = found else {
                panic!("{found:?}");
            };
            assert_eq!(sign, wires);
            // Two switches behind the first movement; half a period of this drive under a relay.
            assert!((0.04..0.4).contains(&half), "{half}");
            assert!((half..0.8).contains(&(STEP * samples as f32)), "{samples}");
            // Half as much again as moved it first, and more where it stays on one side.
            assert!((0.15..AMPLITUDE).contains(&largest), "{largest}");
            assert_eq!(relay.largest(), largest);
        }
    }
}

#[test]
fn a_drive_that_obeys_the_other_sign_runs_away_and_is_caught() {
    for gain in [0.6, 2.0, 6.0] {
        for side in [1.0, -1.0] {
            let mut relay = beside(side);
            let mut drive = Drive::new(-gain, side);
            let (found, _, _) = ended(&mut relay, &mut drive);
            let Relayed::Obeys { sign, .. } = found else {
                panic!("{gain} {side}: {found:?}");
            };
            assert_eq!(sign, -1.0, "{gain}");
            assert!((drive.at[0] - 0.5).abs() < 0.35, "{gain}: {:?}", drive.at);
        }
    }
}

#[test]
fn the_command_grows_where_the_axis_stays_on_one_side() {
    let relay = |command: f32| Relay::new(0.5, 5e-4, command, 1.0, 1.0);
    let command = |relay: &mut Relay, y: f32| match relay.update(y, 0.0, STEP, AMPLITUDE) {
        Relayed::Command { command, .. } => command,
        other => panic!("{other:?}"),
    };
    // At least 0.08, and half as much again as moved it.
    assert!((command(&mut relay(0.01), 0.501) + 0.08).abs() < 1e-6);
    let mut held = relay(0.1);
    for k in 1..=300 {
        let time = STEP * k as f32;
        let grown = 0.15 + (time - 0.05).max(0.0);
        let found = command(&mut held, 0.501);
        assert!((found + grown.min(AMPLITUDE)).abs() < 2e-3, "{k}: {found}");
    }
    // A direction in which nothing moves makes way for the other one, from the first command on.
    held.take(Standing::Exhausted, 0.5);
    assert!((command(&mut held, 0.501) - 0.15).abs() < 2e-3);
    held.take(Standing::HeldByFriction, 0.5);
    assert!(command(&mut held, 0.501) > 0.0);
    held.take(Standing::Moved, 0.5);
    assert!(command(&mut held, 0.501) < 0.0);
    // It switches where the axis, 40 ms ahead, is half a movement on the other side.
    for (y, v, switches) in [
        (0.4996, 0.0, false),
        (0.4994, 0.0, true),
        (0.501, -0.03, false),
        (0.501, -0.04, true),
    ] {
        let mut relay = relay(0.1);
        let _ = relay.update(0.501, 0.0, STEP, AMPLITUDE);
        let found = match relay.update(y, v, STEP, AMPLITUDE) {
            Relayed::Command { command, .. } => command > 0.0,
            other => panic!("{other:?}"),
        };
        assert_eq!(found, switches, "{y} {v}");
    }
    for (y, away) in [(0.52, false), (0.531, true), (0.469, true), (0.48, false)] {
        assert_eq!(held.is_away(y), away, "{y}");
    }
}

#[test]
fn what_neither_turns_nor_runs_away_disobeys_in_the_end() {
    let mut relay = beside(1.0);
    let end =
        (1..10_000).find(|_| matches!(relay.update(0.51, 0.0, STEP, AMPLITUDE), Relayed::Disobeys));
    // Twice the longest time.
    assert!(
        end.is_some_and(|end| (1600..=1602).contains(&end)),
        "{end:?}"
    );
    // An axis that runs away whatever the sign.
    let mut relay = beside(1.0);
    let (mut flips, mut last, mut found) = (0, 1.0, None);
    let (mut y, mut v) = (0.5, 0.0);
    for k in 0..10_000 {
        match relay.update(y, v, STEP, AMPLITUDE) {
            Relayed::Command { sign, .. } => {
                flips += u32::from(sign != last);
                last = sign;
            }
            other => {
                found = Some((k, other));
                break;
            }
        }
        (y, v) = (y + STEP * v, v + 0.02);
    }
    assert_eq!(found.map(|(_, found)| found), Some(Relayed::Disobeys));
    assert_eq!(flips, FLIPS_MAX);
}

#[test]
fn an_axis_that_ran_away_is_turned_with_half_of_what_stopped_it() {
    for side in [1.0, -1.0] {
        for (flips, command, exact) in [(0, 0.4, 0.4), (1, 0.4, 0.2), (1, 1e-6, COMMAND_MIN)] {
            let mut relay = beside(side);
            (relay.flips, relay.command) = (flips, command);
            let _ = relay.update(0.5 - 0.1 * side, 0.0, STEP, AMPLITUDE);
            assert_eq!((relay.side, relay.command), (-side, exact));
        }
    }
}

#[test]
fn an_axis_that_has_turned_once_obeys_at_the_end_of_the_time() {
    for side in [1.0, -1.0] {
        let mut relay = beside(side);
        let ended = (1..2000).find_map(|k| {
            let place = if k < 120 { 0.01 } else { -0.01 };
            match relay.update(0.5 + place * side, 0.0, STEP, AMPLITUDE) {
                Relayed::Command { .. } => None,
                other => Some((k, other)),
            }
        });
        let Some((end, Relayed::Obeys { half, sign })) = ended else {
            panic!("{ended:?}");
        };
        assert!((800..=802).contains(&end), "{end}");
        assert!((half - 0.12).abs() < 1e-5 && sign == 1.0, "{half} {sign}");
    }
}
