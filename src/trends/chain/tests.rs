//! The chain in steady signals, and its stability.

use super::*;
use crate::trends::filtered::FilteredTrends;
use crate::trends::operator::TrendOperator;

/// In one word the state would stop 3e-5 of its end away from it, in every row of a steady
/// motion alike.
#[test]
fn a_steady_input_is_reached_to_the_last_digits() {
    fn distance<const M: usize>(bandwidth: f32) -> f32 {
        let trends = FilteredTrends::<M>::for_bandwidth(Scheme::Tustin, 0.001, bandwidth).unwrap();
        let mut memory = Chain::input_at_rest(trends.design(), Hold::Zero, 0.0);
        let mut trend = 0.0;
        for _ in 0..60_000 {
            trend = trends.input(&mut memory, 0.371, Hold::Zero)[0];
        }
        (trend * trends.filter()[0] / 0.371 - 1.0).abs()
    }
    for bandwidth in [5.0, 20.0, 100.0] {
        let found = [
            distance::<1>(bandwidth),
            distance::<2>(bandwidth),
            distance::<3>(bandwidth),
        ];
        assert!(found.iter().all(|distance| *distance < 1e-6), "{found:?}");
    }
}

/// What the trend of order 2 keeps of a steady speed on average, in the part that damping has in
/// the row of a drive.
#[test]
fn a_steady_speed_leaves_nothing_in_the_trend_above() {
    for bandwidth in [5.0, 20.0, 100.0] {
        let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 0.001, bandwidth).unwrap();
        let mut memory = Chain::output_at_rest(trends.design(), Form::Increment, 0.0);
        let settled = (100_000.0 / bandwidth) as u32;
        let mut sum = 0.0_f32;
        for k in 0..4 * settled {
            let found = trends.output(&mut memory, k as f32, Form::Increment);
            if k >= settled {
                sum += found.lower[2] / (bandwidth * found.lower[1]);
            }
        }
        let mean = sum / (3 * settled) as f32;
        assert!(mean.abs() < 1e-7, "{bandwidth}: {mean:e}");
    }
}

/// Poles on both sides of the circle of radius 1/Delta about -1/Delta, alone and beside slow
/// ones.
#[test]
fn forward_rectangles_hold_poles_within_their_circle() {
    let stable = |scheme, filter: [f32; 2]| Integrators::new(scheme, 0.01, filter).is_stable();
    // Real: -p and -1.
    for (pole, expected) in [(1e-3, true), (199.0, true), (201.0, false), (1e9, false)] {
        let filter = [pole, pole + 1.0];
        assert_eq!(stable(Scheme::Goodwin, filter), expected, "{pole}");
        assert!(stable(Scheme::Tustin, filter), "{pole}");
    }
    // A pair of size w and damping z is in it where w Delta < 2 z.
    for (size, expected) in [(1.0, true), (39.0, true), (41.0, false), (1e15, false)] {
        let filter = [size * size, 2.0 * 0.2 * size];
        assert_eq!(stable(Scheme::Goodwin, filter), expected, "{size}");
        assert!(stable(Scheme::Tustin, filter), "{size}");
    }
    let single = |pole| Integrators::new(Scheme::Goodwin, 0.01, [pole]).is_stable();
    assert!(single(199.0) && !single(201.0));
    // The default of order 4: its fastest pole and its pair stand at 1.1 omega.
    let default =
        |bandwidth| FilteredTrends::<4>::for_bandwidth(Scheme::Goodwin, 0.01, bandwidth).is_ok();
    assert!(default(1e-3) && default(126.0) && !default(128.0));
}
