//! What ends a relay and begins a search; an axis beyond the safe travel: what it is given time
//! for, and what becomes of it.

use super::*;
use crate::servo::commissioning::Commissioning;
use crate::servo::commissioning::rest::Still;
use crate::servo::commissioning::tests::design;

const STEP: f32 = 1e-3;
const HALF: f32 = 0.15;

/// A commissioning whose axis is beyond the safe travel from now on.
fn outside() -> Commissioning {
    let mut commissioning = Commissioning::new(design());
    commissioning.begin(300.0, None);
    commissioning
}

/// Goes on from `y` at `speed`, outward above 0, for so many samples at most: where it has come,
/// and after how many samples something else than a command inwards followed.
fn gone(
    commissioning: &mut Commissioning,
    [y, side]: [f32; 2],
    [speed, seen]: [f32; 2],
    samples: u32,
) -> (f32, Option<(u32, Progress)>) {
    let at = |k: u32| y + side * speed * STEP * k as f32;
    for k in 1..=samples {
        if let Some(progress) = commissioning.stay_outside(at(k), side * seen, HALF) {
            return (at(k), Some((k, progress)));
        }
    }
    (at(samples), None)
}

#[test]
fn an_axis_that_goes_on_outward_has_a_quarter_of_a_second() {
    for [y, side] in [[0.15, -1.0], [0.85, 1.0]] {
        // As fast at the end as on the mean: the valve is closed, to see whether it obeys.
        let mut commissioning = outside();
        let (_, found) = gone(&mut commissioning, [y, side], [0.05, 0.05], 400);
        let (samples, progress) = found.expect("it does not come back");
        assert!((250..=251).contains(&samples), "{side}: {samples}");
        assert_eq!(progress, Progress::Command(0.0));
        // What goes on as fast behind a closed valve does not obey it.
        let mut closing = commissioning
            .suspicion
            .closing
            .expect("the valve is closed");
        let shown = (0..400).find_map(|_| closing.update(y, side * 0.05, STEP));
        assert_eq!(shown, Some(Shown::Why(Reason::ValveStuck)), "{side}");
        // Braked to less than 0.7 of its mean speed it obeys, and has gone too far.
        let (_, found) = gone(&mut outside(), [y, side], [0.05, 0.03], 400);
        let (samples, progress) = found.expect("it is out");
        assert!((250..=251).contains(&samples), "{side}: {samples}");
        assert_eq!(progress, Progress::Failed(Reason::TravelEnd));
        // At the end of the travel and as slow as what stands, it is pushed on.
        let end = if side > 0.0 { 0.999 } else { 0.001 };
        for (from, speed) in [(end, 0.0), (y, 0.0), (y, 0.019)] {
            let (_, found) = gone(&mut outside(), [from, side], [speed, 0.0], 2000);
            assert_eq!(found, None, "{side} {speed}");
        }
    }
}

#[test]
fn of_an_axis_that_meets_an_end_behind_a_closed_valve_the_levels_show_why() {
    let mut commissioning = outside();
    let unresponsive = |commissioning: &Commissioning| {
        commissioning.unless_unresponsive(Standing::Unresponsive, Progress::Command(0.1))
    };
    assert_eq!(
        unresponsive(&commissioning),
        Progress::Failed(Reason::SensorStuck)
    );
    let mut closing = Some(ValveClosing::new(0.2, 0.1));
    while let Some(valve) = closing {
        let progress = commissioning.close(valve, 0.999, 0.2);
        assert_eq!(progress, Progress::Command(0.0));
        closing = commissioning.suspicion.closing;
    }
    // Nothing that it finds is a drive any more, and what moves neither way does not obey.
    assert!(commissioning.suspicion.defied);
    let stuck = Progress::Failed(Reason::ValveStuck);
    assert_eq!(unresponsive(&commissioning), stuck);
    commissioning.time = commissioning.design.time_limit;
    assert_eq!(commissioning.update(499.6, false), stuck);
    commissioning.begin(300.0, None);
    assert!(!commissioning.suspicion.defied);
}

/// Reads `place(k)` for so many samples at a command, and ends with the one in which the valve is
/// closed.
fn driven(commissioning: &mut Commissioning, command: f32, place: impl Fn(u32) -> f32) -> u32 {
    let closed = (0..1000).find(|k| {
        commissioning.tracking.update(place(*k));
        let progress = Progress::Command(command);
        let _ = commissioning.watch_standstill(place(*k), false, &progress);
        commissioning.unless_defiant(progress) == Progress::Command(0.0)
    });
    closed.expect("it goes back")
}

#[test]
fn what_a_swing_does_not_explain_stops_and_what_goes_back_from_there_obeys_another_sign() {
    for sign in [1.0, -1.0] {
        let mut commissioning = outside();
        commissioning.sign = sign;
        commissioning.standstill = Standstill::new(0.5, 1e-3, 0.1, true);
        let _ = commissioning.begin_search(HALF, 0.5);
        commissioning.tracking.place(0.5);
        // 20 ms, and then what noise and the speed leave of a swing.
        let back = |k: u32| 0.5 - 2e-4 * k as f32;
        let samples = driven(&mut commissioning, sign * 0.1, back);
        assert!((30..300).contains(&samples), "{samples}");
        let closing = commissioning.suspicion.closing.expect("closed");
        assert_eq!(closing, ValveClosing::in_doubt(closing.velocity(), HALF));
        // It stops, and is driven on the same way.
        let place = back(samples);
        let progress = commissioning.close(closing, place, 0.0);
        assert_eq!(progress, Progress::Command(0.0));
        assert_eq!(commissioning.suspicion.closing, None);
        let Stage::Sweeping(sweep) = commissioning.stage else {
            panic!("levels are drawn");
        };
        assert!(sweep.proves());
        let again = |k: u32| place - 2e-4 * k as f32;
        commissioning.tracking.place(place);
        let mut weak = commissioning.clone();
        let _ = driven(&mut commissioning, sign * 0.3, again);
        let closing = commissioning.suspicion.closing.expect("closed");
        assert_eq!(closing, ValveClosing::new(closing.velocity(), HALF));
        // Not by a command that may be no flow.
        let _ = driven(&mut weak, sign * 0.04, again);
        let closing = weak.suspicion.closing.expect("closed");
        assert_eq!(closing, ValveClosing::in_doubt(closing.velocity(), HALF));
    }
}

#[test]
fn what_comes_back_begins_its_time_anew() {
    for [y, side] in [[0.15, -1.0], [0.85, 1.0]] {
        // A two-hundredth of the travel is what 0.02 per s make of a quarter of a second.
        for (back, anew) in [(0.006, true), (0.004, false)] {
            let mut commissioning = outside();
            let (out, found) = gone(&mut commissioning, [y, side], [0.1, 0.1], 150);
            assert_eq!(found, None);
            let (turned, found) = gone(&mut commissioning, [out, side], [-back / 0.02, 0.0], 20);
            assert_eq!(found, None);
            assert!((side * (out - turned) - back).abs() < 1e-5);
            let (_, found) = gone(&mut commissioning, [turned, side], [0.1, 0.1], 400);
            let samples = found.expect("it goes on outward").0;
            let exact = if anew { 250 - 3 } else { 250 - 150 - 20 };
            assert!(samples.abs_diff(exact) <= 2, "{side} {back}: {samples}");
        }
    }
}

/// What a relay ends with on an axis at `y`, whose velocity stays `v`.
fn relayed(y: f32, v: f32) -> Progress {
    let mut commissioning = Commissioning::new(design());
    let mut relay = Relay::new(0.5, 5e-4, 0.1, 1.0, (y - 0.5).signum());
    for _ in 0..2000 {
        let progress = commissioning.relay(relay, y, v);
        let (Progress::Command(_), Stage::Relaying(next)) = (progress, &commissioning.stage) else {
            return progress;
        };
        relay = *next;
    }
    panic!("a relay has an end");
}

#[test]
fn an_axis_that_disobeys_is_blocked_where_it_stands_and_has_a_stuck_valve_otherwise() {
    // Less than 0.02 per s is no motion; at an end of the travel an open valve may hold the axis.
    for (y, v, reason) in [
        (0.51, 0.0, Reason::Blocked),
        (0.51, 0.019, Reason::Blocked),
        (0.51, -0.019, Reason::Blocked),
        (0.51, 0.021, Reason::ValveStuck),
        (0.51, -0.021, Reason::ValveStuck),
        (0.995, 0.0, Reason::ValveStuck),
        (0.005, 0.0, Reason::ValveStuck),
    ] {
        assert_eq!(relayed(y, v), Progress::Failed(reason), "{y} {v}");
    }
}

#[test]
fn half_a_period_has_twelve_points_unless_that_is_less_than_one_in_10_ms() {
    let pi = core::f32::consts::PI;
    // What is known of the frequency takes the place of the half period that the relay found.
    for (known, half, exact, spacing) in [
        (None, 0.06, 0.06, 0.06 / 12.0),
        (None, 0.24, 0.24, 0.01),
        (Some(pi / 0.06), 0.24, 0.06, 0.06 / 12.0),
    ] {
        let mut design = design();
        design.frequency = known;
        let mut commissioning = Commissioning::new(design);
        let progress = commissioning.begin_search(half, 0.5);
        assert_eq!(progress, Progress::Command(0.0));
        let [stride, frequency, _] = commissioning.first_guess.expect("a first guess");
        assert!((stride * STEP / spacing - 1.0).abs() < 1e-5, "{stride}");
        assert!((frequency * exact / pi - 1.0).abs() < 1e-5, "{frequency}");
    }
}

#[test]
fn a_first_movement_is_braked_from_its_side_and_its_way_is_known_to_open() {
    for side in [1.0, -1.0] {
        let mut commissioning = Commissioning::new(design());
        commissioning.still = Still {
            place: 0.5,
            detection: 1e-3,
            ..Still::default()
        };
        commissioning.stage = Stage::Probing(Probe::default());
        let mut progress = Progress::Command(0.0);
        for k in 1..=101 {
            let Stage::Probing(probe) = commissioning.stage else {
                panic!("it has not moved");
            };
            let y = if k > 100 { 0.5 + 0.01 * side } else { 0.5 };
            progress = commissioning.probe(probe, y, false);
        }
        // Half as much again as the command 20 ms before, the other way whatever the sign.
        let moved = 1.5 * 0.08;
        let Progress::Command(command) = progress else {
            panic!("{progress:?}");
        };
        assert!((command + 1.5 * moved).abs() < 1e-4, "{command}");
        let Stage::Relaying(relay) = commissioning.stage else {
            panic!("{:?}", commissioning.stage);
        };
        assert!(!relay.is_away(0.5) && (commissioning.moving_command - moved).abs() < 1e-4);
        let [own, other] = [side > 0.0, side < 0.0].map(|up| commissioning.standstill.push(up));
        assert!((own - 1.5 * moved).abs() < 1e-4 && (other - own - 0.16).abs() < 1e-5);
    }
}

#[test]
fn triangles_are_as_large_as_twice_the_largest_command_allows() {
    for (amplitude, peak) in [(0.1, 0.09), (0.3, 0.27), (0.5, 0.45), (0.9, 0.45)] {
        let mut design = design();
        design.amplitude = amplitude;
        let mut commissioning = Commissioning::new(design);
        commissioning.still.detection = 1e-3;
        commissioning.stage = Stage::Probing(Probe::default());
        let (mut largest, mut before) = (0.0_f32, 0.0);
        while let Stage::Probing(probe) = commissioning.stage {
            let Progress::Command(command) = commissioning.probe(probe, 0.0, false) else {
                panic!("it does not move");
            };
            largest = largest.max(command);
            // The first triangle on one side.
            if command < before && command < 0.0 {
                break;
            }
            before = command;
        }
        assert!((largest - peak).abs() < 2e-3, "{amplitude}: {largest}");
    }
}

#[test]
fn an_axis_that_nothing_moves_is_blocked_where_its_code_changes_and_a_stuck_sensor_otherwise() {
    for (changes, reason) in [(true, Reason::Blocked), (false, Reason::SensorStuck)] {
        let mut commissioning = Commissioning::new(design());
        let mut standstill = Standstill::new(0.5, 1e-3, 0.3, true);
        let _ = standstill.update(0.5, !changes, 0.0, STEP, None);
        while standstill.update(0.5, true, 0.4, STEP, None) != Standing::Exhausted {}
        commissioning.standstill = standstill;
        let progress = Progress::Command(0.1);
        let found = commissioning.unless_unresponsive(Standing::Unresponsive, progress);
        assert_eq!(found, Progress::Failed(reason));
        for standing in [
            Standing::Moved,
            Standing::HeldByFriction,
            Standing::Exhausted,
        ] {
            let found = commissioning.unless_unresponsive(standing, progress);
            assert_eq!(found, progress, "{standing:?}");
        }
    }
}
