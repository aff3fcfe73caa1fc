//! The triangles, and an axis that moves in one of them.

extern crate std;

use super::*;

const STEP: f32 = 1e-3;

fn still() -> Still {
    Still {
        place: 0.5,
        detection: 1e-3,
        ..Still::default()
    }
}

/// The commands of all triangles on an axis that does not move; the codes change.
fn commands(scale: f32) -> std::vec::Vec<f32> {
    let mut probe = Probe::default();
    let mut found = std::vec::Vec::new();
    loop {
        match probe.update(0.5, false, &still(), STEP, scale) {
            Probed::Command(command) => found.push(command),
            other => {
                assert_eq!(other, Probed::Still);
                return found;
            }
        }
    }
}

#[test]
fn triangles_go_to_both_sides_and_their_peaks_grow() {
    for scale in [1.0, 0.6] {
        let commands = commands(scale);
        let mut peaks = std::vec::Vec::new();
        for pair in commands.windows(3) {
            let [a, b, c] = [pair[0].abs(), pair[1].abs(), pair[2].abs()];
            if b > a && b >= c {
                peaks.push(pair[1]);
            }
        }
        let expected = [0.45, -0.45, 0.65, -0.65].map(|peak| scale * peak);
        assert_eq!(peaks.len(), 4, "{peaks:?}");
        for (peak, expected) in peaks.iter().zip(expected) {
            assert!((peak - expected).abs() < 8e-3, "{peaks:?}");
        }
        // Slow where nothing was tried before: 1.5 per s; quicker, 6 per s, where it was.
        let steps = commands
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs() / STEP);
        for step in steps {
            assert!(step < 6.01, "{step}");
        }
        let time = commands.len() as f32 * STEP;
        let expected = 4.0 * scale * (0.45 / 1.5 + 0.45 / 6.0 + 0.2 / 1.5);
        assert!((time - expected).abs() < 0.02, "{time} {expected}");
    }
}

#[test]
fn an_axis_that_moves_has_a_sign_and_the_command_that_did_it() {
    for (side, below) in [(1.0_f32, false), (-1.0, false), (1.0, true), (-1.0, true)] {
        let mut probe = Probe::default();
        // It moves 20 ms behind a command of 0.15 on the upper or the lower side.
        let (mut y, mut wanted, mut found) = (0.5, None, None);
        let mut time = 0.0;
        for _ in 0..2000 {
            if wanted.is_some_and(|at| time >= at) {
                y = 0.5 + side * 0.01;
            }
            match probe.update(y, false, &still(), STEP, 1.0) {
                Probed::Command(command) => {
                    let along = if below { -command } else { command };
                    if wanted.is_none() && along > 0.15 {
                        wanted = Some(time + LATENESS);
                    }
                }
                other => {
                    found = Some(other);
                    break;
                }
            }
            time += STEP;
        }
        let Some(Probed::Moved { sign, command }) = found else {
            panic!("{found:?}");
        };
        assert_eq!(sign, if below { -side } else { side });
        assert!((command - 0.15).abs() < 0.01, "{command}");
    }
}

#[test]
fn a_drift_is_no_movement_and_the_mean_of_three_decides() {
    let drifts = Still {
        drift: 0.01,
        since: 0.02,
        ..still()
    };
    let mut probe = Probe::default();
    for k in 0..600 {
        let y = 0.5 + 0.01 * (0.02 + STEP * k as f32);
        assert!(
            matches!(
                probe.update(y, false, &drifts, STEP, 1.0),
                Probed::Command(_)
            ),
            "{k}"
        );
    }
    // One sample away is none, where three are.
    let mut probe = Probe::default();
    for _ in 0..100 {
        let _ = probe.update(0.5, false, &still(), STEP, 1.0);
    }
    let mut other = probe;
    assert!(matches!(
        other.update(0.5028, false, &still(), STEP, 1.0),
        Probed::Command(_)
    ));
    assert!(matches!(
        other.update(0.5028, false, &still(), STEP, 1.0),
        Probed::Moved { .. }
    ));
    assert!(matches!(
        probe.update(0.4968, false, &still(), STEP, 1.0),
        Probed::Moved { .. }
    ));
}

#[test]
fn no_code_for_as_long_as_the_first_triangle_takes_is_a_sensor_that_is_stuck() {
    for scale in [1.0, 0.5] {
        let mut probe = Probe::default();
        let count =
            (0..5000).find(|_| probe.update(0.5, true, &still(), STEP, scale) == Probed::SameCode);
        let time = STEP * count.unwrap_or(0) as f32;
        assert!((time - scale * 1.2).abs() < 5e-3, "{time}");
    }
    // A code that changes now and then is not.
    let mut probe = Probe::default();
    for k in 0..2000 {
        let found = probe.update(0.5, k % 300 != 0, &still(), STEP, 1.0);
        assert_ne!(found, Probed::SameCode, "{k}");
    }
}

#[test]
fn one_direction_has_moved_nothing_behind_its_triangle() {
    for scale in [1.0, 0.5] {
        let mut probe = Probe::default();
        let turned = (1..2000).find(|_| {
            let _ = probe.update(0.5, false, &still(), STEP, scale);
            probe.has_turned(scale)
        });
        let time = STEP * turned.unwrap_or(0) as f32;
        assert!((time - 0.6 * scale).abs() < 3e-3, "{time}");
    }
}

#[test]
fn an_axis_that_moves_at_once_is_moved_by_the_command_of_now() {
    // What came 20 ms before was none.
    let mut probe = Probe::default();
    for _ in 0..10 {
        let _ = probe.update(0.5, false, &still(), STEP, 1.0);
    }
    let Probed::Moved { sign, command } = probe.update(0.49, false, &still(), STEP, 1.0) else {
        panic!("it has moved");
    };
    assert!(
        sign == -1.0 && (command - 0.015).abs() < 1e-6,
        "{sign} {command}"
    );
}

#[test]
fn a_drift_that_grows_to_twice_its_mean_is_no_answer_to_the_command() {
    for drift in [0.04, -0.04_f32] {
        let still = Still {
            drift,
            since: 0.025,
            ..still()
        };
        for (times, moves) in [(1.0, false), (1.9, false), (3.0, true), (-1.0, true)] {
            let mut probe = Probe::default();
            let mut moved = None;
            for k in 0..100 {
                let time = still.since + STEP * k as f32;
                let y = still.place + times * drift * time;
                if let Probed::Moved { sign, .. } = probe.update(y, false, &still, STEP, 1.0) {
                    moved = Some(sign);
                    break;
                }
            }
            let expected = moves.then_some(drift.signum() * f32::signum(times));
            assert_eq!(moved, expected, "{drift} {times}");
        }
    }
}
