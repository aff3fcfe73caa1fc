//! The sweep against all its frequencies at once, in double precision.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

extern crate std;

use super::*;
use crate::servo::control::oracle::{self, Dice, Oracle};

const STEP: f32 = 0.03;

/// What the whole sweep says, in how many steps, and the integral gain.
fn swept(sweep: &mut FrequencySweep) -> (Swept, usize, f32) {
    let mut begun = 0.0;
    for k in 1.. {
        match sweep.update() {
            Swept::Begun(integral) => begun = integral,
            Swept::On => {}
            found => return (found, k, begun),
        }
    }
    (Swept::On, 0, begun)
}

/// Sensitivity of a controller on a drive at `w`, with half a sample by the hold and `late` more;
/// and 1 + L.
fn closed(exact: &Oracle, drive: &ScaledDrive, w: f64, late: f64) -> oracle::C {
    let open = oracle::times(
        exact.at(w),
        oracle::response(drive, w, f64::from(STEP) * (0.5 + late)),
    );
    [1.0 + open[0], open[1]]
}

fn size([re, im]: oracle::C) -> f64 {
    (re * re + im * im).sqrt()
}

/// Turns of 1 + L about zero from the lowest to the highest frequency, in halves, by its angle.
fn turns(values: &[oracle::C]) -> f64 {
    let mut angle = 0.0;
    for pair in values.windows(2) {
        let [[a, b], [c, d]] = [pair[0], pair[1]];
        angle += libm::atan2(a * d - b * c, a * c + b * d);
    }
    angle / core::f64::consts::PI
}

#[test]
fn a_sweep_holds_where_every_frequency_of_every_drive_does() {
    let mut dice = Dice(1);
    let ratio = ratio(STEP);
    let mut counts = [0; 2];
    for _ in 0..60 {
        let (mut drive, poles) = dice.pair();
        (drive.a1, drive.b0) = (1.0, 1.0);
        let mut sweep = FrequencySweep::new(drive, &Responses::new(&drive), poles, [STEP, ratio]);
        let exact = Oracle::new(&drive, &poles, 1.0);
        let frequencies =
            |count: usize| (0..count).map(|k| f64::from(LOWEST) * f64::from(ratio).powi(k as i32));
        let mut least = [f64::INFINITY; 2];
        let mut ends: [f64; 5] = [0.0; 5];
        for (k, end) in ends.iter_mut().enumerate() {
            let off = if k == 0 {
                drive
            } else {
                ScaledDrive {
                    a1: OFF[(k - 1) / 2],
                    a2: OFF_DAMPING * drive.a2,
                    b0: OFF[(k - 1) % 2],
                    ..drive
                }
            };
            let late = if k == 0 { 0.0 } else { 1.0 };
            let values: std::vec::Vec<_> = frequencies(FREQUENCIES)
                .map(|w| closed(&exact, &off, w, late))
                .collect();
            let fine: std::vec::Vec<_> = (0..5 * (FREQUENCIES - 1))
                .map(|k| f64::from(LOWEST) * f64::from(ratio).powf(k as f64 / 5.0))
                .map(|w| closed(&exact, &off, w, late))
                .collect();
            *end = turns(&fine);
            let own = usize::from(k > 0);
            least[own] = values.iter().map(|v| size(*v)).fold(least[own], f64::min);
        }
        // Between clear and clear not, rounding and the steps between frequencies decide.
        let [own, off] = [least[0] * 2.2, least[1] * 4.0];
        let alike = ends.iter().all(|end| (end - ends[0]).abs() < 1.0);
        let (found, count, integral) = swept(&mut sweep);
        if own > 1.01 && off > 1.01 && alike {
            assert_eq!(
                (found, count),
                (Swept::Holds, 2 * FREQUENCIES),
                "{drive:?} {poles:?}"
            );
            judged(&sweep, integral, &exact, &drive, frequencies(FREQUENCIES));
            counts[1] += 1;
        } else if own < 0.99 || off < 0.99 || !alike {
            assert_eq!(
                found,
                Swept::Fails,
                "{drive:?} {poles:?} {least:?} {ends:?}"
            );
            counts[0] += 1;
        }
    }
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

/// Variance, integral gain and largest sensitivity of a sweep that holds.
fn judged(
    sweep: &FrequencySweep,
    begun: f32,
    exact: &Oracle,
    drive: &ScaledDrive,
    frequencies: impl Iterator<Item = f64>,
) {
    let (mut variance, mut sensitivity) = (0.0, 0.0_f64);
    for w in frequencies {
        let inverse = 1.0 / size(closed(exact, drive, w, 0.0));
        sensitivity = sensitivity.max(inverse);
        let flow = size(exact.at(w)) * inverse;
        // One side of the spectrum of white noise of one, sampled: T/pi per rad.
        let width = w * (f64::from(sweep.ratio) - 1.0) * f64::from(STEP);
        variance += flow * flow * width / core::f64::consts::PI;
    }
    let near = |found: f32, exact: f64| (f64::from(found) / exact - 1.0).abs() < 0.01;
    assert!(
        near(sweep.variance(), variance),
        "{} {variance}",
        sweep.variance()
    );
    let found = sweep.margins().sensitivity;
    assert!(near(found, sensitivity), "{found} {sensitivity}");
    let lowest = f64::from(LOWEST);
    let integral = lowest * size(exact.at(lowest));
    assert!(near(begun, integral), "{begun} {integral}");
}

#[test]
fn frequencies_reach_from_the_lowest_to_that_of_the_sampling() {
    for step in [0.01, 0.03, 0.2_f32] {
        let highest = LOWEST * libm::powf(ratio(step), (FREQUENCIES - 1) as f32);
        assert!((highest * step / core::f32::consts::PI - 1.0).abs() < 1e-3);
    }
}

#[test]
fn what_is_no_number_does_not_hold() {
    let mut trace = BEGIN;
    let at = |re: f32, im: f32| Complex { re, im };
    assert!(!trace.sees(at(f32::NAN, 0.0), 4.0));
    assert!(trace.sees(at(0.51, 0.0), 4.0) && !trace.sees(at(0.5, 0.0), 4.0));
    // About zero, seen from the left: upwards counts one half turn, downwards takes it back.
    for (from, to, turns) in [
        (-1.0, 1.0, 1),
        (1.0, -1.0, -1),
        (1.0, 2.0, 0),
        (-1.0, -2.0, 0),
    ] {
        for (re, side) in [(-3.0, 1), (3.0, 0)] {
            let mut trace = Trace {
                last: at(re, from),
                turns: 0,
            };
            assert!(trace.sees(at(re, to), 4.0));
            assert_eq!(trace.turns, turns * side, "{from} {to} {re}");
        }
    }
}
