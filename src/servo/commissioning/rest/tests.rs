//! An axis at rest, one that drifts, one that moves, and a sensor that is stuck.

use super::*;

const TIME_STEP: f32 = 1e-3;
const RESOLUTION: f32 = 1e-5;

/// Uniform noise of this standard deviation, from -1.73 to 1.73 of it.
pub(in crate::servo::commissioning) fn noise(state: &mut u32, sigma: f32) -> f32 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    sigma * libm::sqrtf(3.0) * ((*state >> 8) as f32 / 8_388_608.0 - 1.0)
}

/// What a rest finds, and after how many samples.
fn found(y: impl Fn(u32) -> f32, time: f32) -> (Still, u32) {
    let mut rest = Rest::default();
    for k in 0.. {
        if let Some(still) = rest.update(y(k), time, RESOLUTION) {
            return (still, k + 1);
        }
    }
    (Still::default(), 0)
}

#[test]
fn noise_and_place_are_those_of_the_axis_at_rest() {
    let (mut squares, mut places) = (0.0, 0.0_f32);
    for seed in 1..200 {
        let positions: [f32; 50] = {
            let mut state = seed;
            core::array::from_fn(|_| 0.4 + noise(&mut state, 1e-4))
        };
        let (still, samples) = found(|k| positions[k as usize], TIME_STEP);
        assert_eq!(samples, 50);
        squares += still.sigma * still.sigma / 199.0;
        let mean = positions.iter().sum::<f32>() / 50.0;
        assert!((still.place - mean).abs() < 1e-6);
        places = places.max((still.place - 0.4).abs());
        assert_eq!(still.drift, 0.0, "seed {seed}");
        assert!((still.since - 0.0245).abs() < 1e-6);
        assert!((still.detection - (8.0 * still.sigma).max(2e-4)).abs() < 1e-9);
        // Noise of ten codes changes them: no run is long, and eight times that is stuck.
        assert!((1..=3).contains(&still.run), "{still:?}");
        for (same, stuck) in [(8 * still.run, false), (8 * still.run + 1, true)] {
            assert_eq!(still.is_stuck(same, 1e-2), stuck);
        }
        assert!(
            !still.is_stuck(8 * still.run + 1, 1e-5),
            "too short to tell"
        );
    }
    // The second differences of white noise are six of its variance.
    assert!((libm::sqrtf(squares) / 1e-4 - 1.0).abs() < 0.03);
    assert!(places < 8e-5, "{places}");
}

#[test]
fn an_axis_that_drifts_has_a_velocity_and_no_run() {
    for drift in [0.02, -0.02_f32] {
        let mut states = [1_u32; 1];
        let positions: [f32; 50] = core::array::from_fn(|k| {
            0.4 + drift * TIME_STEP * k as f32 + noise(&mut states[0], 2e-5)
        });
        let (still, samples) = found(|k| positions[k as usize], TIME_STEP);
        assert_eq!((samples, still.run), (50, 0));
        assert!((still.drift / drift - 1.0).abs() < 0.05, "{still:?}");
        // A straight line has no second difference.
        assert!(still.sigma < 4e-5);
        // Where it is at the end of the rest.
        let end = still.place + still.drift * still.since;
        assert!((end - (0.4 + drift * 0.049)).abs() < 2e-5, "{still:?}");
    }
}

#[test]
fn a_movement_ends_the_rest_early() {
    for side in [1.0, -1.0] {
        // 4e-3 travels are reached behind the 40th thousandth of 0.1 per s.
        let (still, samples) = found(|k| 0.5 + side * 1e-4 * k as f32, TIME_STEP);
        assert!((41..=42).contains(&samples), "{samples}");
        assert!((still.drift / (side * 0.1) - 1.0).abs() < 1e-2);
        // At once, with what little is known.
        let (still, samples) = found(|k| 0.5 + side * 0.1 * k as f32, TIME_STEP);
        assert_eq!(samples, 2);
        assert!((still.drift / (side * 100.0) - 1.0).abs() < 1e-3);
        assert!(still.sigma > 0.0 && still.place.is_finite() && still.drift.is_finite());
    }
    // As long as 40 samples and 50 ms take, whatever the sample time.
    for (time, samples) in [(1e-3, 50), (5e-3, 40), (2.5e-4, 200)] {
        assert_eq!(found(|_| 0.5, time).1, samples);
    }
}

#[test]
fn a_code_that_no_noise_changes_is_a_twelfth_of_it_uncertain() {
    let (still, _) = found(|_| 0.5, TIME_STEP);
    assert!((still.sigma / (RESOLUTION / libm::sqrtf(12.0)) - 1.0).abs() < 1e-3);
    assert_eq!((still.run, still.drift, still.detection), (0, 0.0, 2e-4));
    assert!(!still.is_stuck(1_000_000, 1e-3), "a coarse code may stay");
}

#[test]
fn the_longest_run_of_equal_positions_is_that_of_the_rest() {
    // Codes about the middle, each of them in runs of one to four.
    for (codes, longest) in [
        ([0, 3, 0, -3, 3, -3, 0, 3, -3, 3], 1),
        ([0, 3, 3, 3, -3, -3, 0, 0, 3, -3], 3),
        ([3, 3, 3, -3, 0, -3, -3, 0, 3, 3], 5),
    ] {
        let y = |k: u32| 0.4 + RESOLUTION * codes[k as usize % 10] as f32;
        let (still, samples) = found(y, TIME_STEP);
        assert_eq!((samples, still.run), (50, longest), "{codes:?}");
    }
}
