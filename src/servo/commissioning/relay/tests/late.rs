//! What shows nothing of the sign: an answer to an earlier command, and noise.

use super::*;
use crate::servo::commissioning::rest::tests::noise;

/// A drive whose velocity follows the command some samples later, and at once then.
struct Late {
    y: f32,
    gain: f32,
    commands: [f32; 16],
    delay: usize,
}

impl Late {
    /// Moves down slowly; the last commands of a probe led up.
    const fn drifting(gain: f32, delay: usize) -> Self {
        Self {
            y: 0.498,
            gain,
            commands: [0.05; 16],
            delay,
        }
    }

    /// The place and the velocity, of which the command is the next.
    fn step(&mut self, command: f32) -> [f32; 2] {
        self.commands.rotate_right(1);
        self.commands[0] = command;
        let v = self.gain * self.commands[self.delay];
        self.y += STEP * v;
        [self.y, v]
    }
}

#[test]
fn a_drive_that_comes_late_is_not_taken_for_one_of_the_other_sign() {
    // Under a relay the wrong sign behind a delay is as the right one behind half a period more.
    for delay in [4, 8, 12] {
        for (gain, told) in [(2.0, -1.0), (-2.0, 1.0)] {
            let mut relay = Relay::new(0.5, 5e-4, 0.1, told, -1.0);
            let mut drive = Late::drifting(gain, delay);
            let mut seen = [drive.y, 0.0];
            let shown =
                (0..150).find_map(|_| match relay.update(seen[0], seen[1], STEP, AMPLITUDE) {
                    Relayed::Command { command, .. } => {
                        seen = drive.step(command);
                        None
                    }
                    Relayed::Obeys { sign, .. } => Some(sign),
                    Relayed::Disobeys => panic!("{delay}"),
                });
            assert_ne!(shown, Some(told), "{delay} {gain}");
        }
    }
}

#[test]
fn a_switch_sooner_than_a_motion_its_command_shows_no_time_scale() {
    for (apart, shows) in [(19, false), (22, true)] {
        let mut relay = beside(1.0);
        let ends = (1..400).find(|k| {
            // Beyond the place on one side, then on the other.
            let y = if k / apart % 2 == 0 { 0.502 } else { 0.498 };
            matches!(relay.update(y, 0.0, STEP, AMPLITUDE), Relayed::Obeys { .. })
        });
        assert_eq!(ends.is_some(), shows, "{apart}: {ends:?}");
    }
}

#[test]
fn noise_switches_nothing() {
    for (rate, time) in [(120.0, 5e-4), (120.0, 1e-3), (120.0, 2e-3)] {
        let mut tracking = AlphaBetaGamma::new(rate, time);
        tracking.place(0.5);
        let still = Still {
            sigma: 1e-4,
            detection: 8e-4,
            ..Still::default()
        };
        let hysteresis = Relay::hysteresis(&still, &tracking);
        assert!(hysteresis > 0.5 * still.detection, "{time}: {hysteresis}");
        let (mut state, mut switches) = (1_u32, 0);
        let (runs, samples) = (50, (0.3 / time) as u32);
        for _ in 0..runs {
            let mut relay = Relay::new(0.5, hysteresis, 0.1, 1.0, 1.0);
            for _ in 0..samples {
                let y = 0.5 + noise(&mut state, still.sigma);
                tracking.update(y);
                let before = relay.side;
                let _ = relay.update(y, tracking.motion().velocity, time, AMPLITUDE);
                switches += u32::from(relay.side != before);
            }
        }
        // Of white noise one place in 740 is beyond, and a filter of samples lets a part more
        // through. Without the velocity it is one in five at 2 ms.
        assert!(
            200 * switches < runs * samples,
            "{time}: {switches} in {runs} runs"
        );
    }
    // Where there is none, half a movement.
    let still = Still {
        detection: 8e-4,
        ..Still::default()
    };
    let tracking = AlphaBetaGamma::new(120.0, 1e-3);
    assert_eq!(Relay::hysteresis(&still, &tracking), 4e-4);
}

#[test]
fn a_swing_that_was_turned_on_its_way_in_does_not_turn_the_sign_on_its_way_out() {
    for (shown, turns) in [(true, false), (false, true)] {
        let mut relay = beside(1.0);
        relay.shown = shown;
        let turned = (1..=140).any(|k| {
            let v = if k < 70 { 0.0 } else { 0.4 };
            reverses(&mut relay, 0.52, v)
        });
        assert_eq!(turned, turns);
    }
    // It is turned so far from the place that it has to come inwards again: see `leave_room`.
    let mut relay = Relay::new(0.88, 5e-4, 0.1, 1.0, -1.0);
    (relay.place, relay.braked) = (0.9, 0.88);
    let _ = relay.update(0.75, -0.5, STEP, AMPLITUDE);
    assert!(!relay.shown);
    let _ = relay.update(0.73, 0.0, STEP, AMPLITUDE);
    assert!(relay.shown && relay.switches == 1);
}
