//! Instruments against least squares, and what is refused.

use super::*;
use crate::error::Weakness;
use crate::problem::{Options, Structure};
use crate::signals::Signals;

const LAG: Structure = Structure {
    constant: true,
    ..Structure::of_order(1)
};

/// u and y of `y' = -2 y + 6 u` with a drift of the output, sampled every 10 ms.
fn drifting() -> [Vec<f64>; 2] {
    let decay = (-0.02_f64).exp();
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    let u: Vec<f64> = (0..6000)
        .map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.5 })
        .collect();
    let (mut x, mut drift, mut y) = (0.0, 0.0, Vec::new());
    for u in &u {
        drift = 0.98 * drift + 0.1 * random();
        y.push(x + drift + 0.3 * random());
        x = decay * x + 3.0 * (1.0 - decay) * u;
    }
    [u, y]
}

/// The model behind the printed fit, its filter and its delay come from the first half alone: it is
/// what the first half by itself gives.
#[test]
fn the_simulated_half_has_no_part_in_its_model() {
    let [u, y] = drifting();
    let n = y.len();
    let signals = Signals::held(0.01, &u, &y);
    let first = signals.part(0..n / 2);
    let of = |signals| Problem::new(signals, LAG, Options::default()).expect("a problem");
    let freedom = Freedom {
        pole: Choice::Auto,
        delay: Choice::Auto,
    };
    let whole = identify(&of(&signals), freedom, 0, &()).expect("a model");
    let half = identify(&of(&first), freedom, 0, &()).expect("a model");
    assert!(whole.held_out && whole.estimate != half.estimate);
    let simulated = of(&signals).free_run(&half.estimate, half.delay, n / 2..n);
    assert_eq!(whole.free_run, simulated);
}

/// Least squares is low, instruments are not.
#[test]
fn instruments_stand_where_least_squares_is_biased() {
    let [u, y] = drifting();
    let signals = Signals::held(0.01, &u, &y);
    let problem = Problem::new(&signals, LAG, Options::default()).expect("a problem");
    let freedom = Freedom {
        pole: Choice::Given(Some(20.0)),
        delay: Choice::Given(0),
    };
    let found = identify(&problem, freedom, 0, &()).expect("a model");
    assert_eq!(found.way, Way::Instruments);
    let off = (found.estimate.a[0] - 2.0) / found.estimate.sigma[0];
    assert!(off.abs() < 3.0, "{off}");
    let ls = found.least_squares.expect("least squares");
    assert!(ls.a[0] > 2.1 || ls.a[0] < 1.9, "{:?}", ls.a);
    let off = (found.estimate.a[0] - 2.0).abs();
    assert!(off < 0.5 * (ls.a[0] - 2.0).abs(), "{off}");
}

#[test]
fn a_filter_faster_than_the_sampling_is_refused() {
    let [u, y] = drifting();
    let signals = Signals::held(0.01, &u, &y);
    let problem = Problem::new(&signals, LAG, Options::default()).expect("a problem");
    let freedom = Freedom {
        pole: Choice::Given(Some(400.0)),
        delay: Choice::Given(0),
    };
    let refused = identify(&problem, freedom, 0, &()).expect_err("a refusal");
    assert!(matches!(refused, Error::Filter { pole: 400.0, .. }));
    assert!(refused.to_string().contains("314.1593 rad/s"), "{refused}");
}

#[test]
fn what_no_filter_can_simulate_is_refused() {
    let u: Vec<f64> = (0..400).map(|k| f64::from(k % 7)).collect();
    let y: Vec<f64> = (0..400).map(|k| (0.1 * f64::from(k)).exp()).collect();
    let signals = Signals::held(0.01, &u, &y);
    let structure = Structure::of_order(1);
    let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
    let refused = identify(&problem, Freedom::default(), 0, &());
    assert_eq!(refused, Err(problem.cannot_simulate()));
    // What is tried already is not advised.
    let advised = |integrator| Weakness::NoSimulation { integrator }.to_string();
    assert!(advised(false).contains("try --integrator"));
    assert!(!advised(true).contains("--integrator"));
}

/// A drive with friction behind an integrator, `v' = -v + 6 (u - 0.4 sgn v)`, which from a sample
/// on is held where it is, however fast it was: `u`, the sign, `y`, where it stands.
fn held_from(rest: usize, samples: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>, Vec<bool>) {
    let (dt, decay) = (0.01, (-0.01_f64).exp());
    let (mut v, mut at) = (0.0_f64, 0.0);
    let (mut u, mut sign, mut y) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..samples {
        let stands = k >= rest;
        let command = [1.0, -0.8, 0.7, -1.2][(k / 130) % 4];
        u.push(if stands { 0.0 } else { command });
        sign.push(if stands { 0.0 } else { v.signum() });
        y.push(at);
        let end = 6.0 * (u[k] - 0.4 * sign[k]);
        if !stands {
            at += end * dt + (v - end) * (1.0 - decay);
            v = end + (v - end) * decay;
        }
    }
    let still = (0..samples).map(|k| k >= rest).collect();
    (u, sign, y, still)
}

/// What holds a drive, and what stopped it, is no part of its equation: the model is that of the
/// motion, to the digits of the sums.
#[test]
fn a_standstill_has_no_part_in_the_model() {
    let (u, sign, y, still) = held_from(3000, 4000);
    let mut signals = Signals::held(0.01, &u, &y);
    let friction = crate::signals::Input {
        name: "sgn(v)",
        samples: &sign,
        delayed: false,
        ..signals.inputs[0]
    };
    signals.inputs.push(friction);
    signals.standstill = Some(&still);
    let structure = Structure {
        integrator: true,
        ..Structure::of_order(2)
    };
    let freedom = Freedom {
        pole: Choice::Given(Some(1.0)),
        delay: Choice::Given(0),
    };
    let theta = |signals: &Signals| {
        let problem = Problem::new(signals, structure, Options::default()).expect("a problem");
        let found = identify(&problem, freedom, 0, &()).expect("a model");
        found.estimate.theta
    };
    let (whole, motion) = (theta(&signals), theta(&signals.part(0..3000)));
    for (whole, motion) in whole.iter().zip(&motion) {
        assert!((whole / motion - 1.0).abs() < 1e-6, "{whole} {motion}");
    }
}

/// u and y of two lags behind each other, of 2 and of 12 rad/s, sampled every 10 ms.
fn two_lags() -> [Vec<f64>; 2] {
    let (slow, fast) = ((-0.02_f64).exp(), (-0.12_f64).exp());
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    let (mut first, mut second, mut level) = (0.0, 0.0, 0.0);
    let (mut u, mut y) = (Vec::new(), Vec::new());
    for k in 0..12_000 {
        if k % 37 == 0 {
            level = random();
        }
        u.push(level);
        y.push(second + 0.05 * random());
        second = fast * second + (1.0 - fast) * first;
        first = slow * first + 3.0 * (1.0 - slow) * level;
    }
    [u, y]
}

/// One lag in place of two is another one behind every filter.
#[test]
fn a_structure_that_does_not_hold_all_depends_on_the_filter() {
    let [u, y] = two_lags();
    let signals = Signals::held(0.01, &u, &y);
    let shifts = |order: usize| {
        let structure = Structure { order, ..LAG };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        let found = identify(&problem, Freedom::default(), 0, &()).expect("a model");
        let shifts = found.filter_shifts.expect("an automatic filter");
        shifts.map(f64::abs).into_iter().fold(0.0, f64::max)
    };
    let (poor, right) = (shifts(1), shifts(2));
    assert!(poor > 3.0 && right < 1.0, "{poor} {right}");
}

#[test]
fn deviations_contain_what_other_filters_move_a_compromise_by() {
    let [u, y] = two_lags();
    let signals = Signals::held(0.01, &u, &y);
    let structure = Structure { order: 1, ..LAG };
    let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
    let here = identify(&problem, Freedom::default(), 0, &()).expect("a model");
    let pole = here.pole.expect("an automatic filter");
    let mut sum = vec![0.0; here.estimate.theta.len()];
    for factor in [0.5, 2.0] {
        let freedom = Freedom {
            pole: Choice::Given(Some(factor * pole)),
            ..Freedom::default()
        };
        let there = identify(&problem, freedom, 0, &()).expect("a model");
        for (sum, (there, here)) in sum
            .iter_mut()
            .zip(there.estimate.theta.iter().zip(&here.estimate.theta))
        {
            *sum += (there - here).powi(2);
        }
    }
    let moved = |j: usize| f64::sqrt(sum[j]) / here.estimate.sigma[j];
    assert!((0..sum.len()).all(|j| moved(j) <= 1.0));
    // The blocks alone spread the first one far less.
    assert!(moved(0) > 0.8, "{}", moved(0));
    let gain = here
        .estimate
        .reading_sigma
        .expect("deviations of a reading")[0];
    assert!(gain.is_finite() && gain > 0.0);
}

/// u and y of `y' = -10 (y - u(t - 2.5 h))`, with noise of a thousandth, beginning at `offset`.
fn late(offset: f64) -> [Vec<f64>; 2] {
    let half = (-0.05_f64).exp();
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    let (mut u, mut y, mut x) = (Vec::<f64>::new(), Vec::new(), 0.0);
    for k in 0..4000_usize {
        let before = u.last().copied().unwrap_or(1.0);
        u.push(if k % 37 == 0 {
            random().signum()
        } else {
            before
        });
        y.push(offset + x + 2e-3 * random());
        for late in [3, 2] {
            let acts = k.checked_sub(late).map_or(0.0, |k| u[k]);
            x = half * x + (1.0 - half) * acts;
        }
    }
    [u, y]
}

#[test]
fn with_a_memory_the_delay_is_that_of_the_record() {
    let [u, y] = late(0.0);
    let signals = Signals::held(0.01, &u, &y);
    let options = Options {
        memory: Some(15.0),
        ..Options::default()
    };
    let problem = Problem::new(&signals, Structure::of_order(1), options).expect("a problem");
    let of = |delay| {
        let pole = Choice::Auto;
        identify(&problem, Freedom { pole, delay }, 0, &()).expect("a model")
    };
    let found = of(Choice::Auto);
    assert_eq!((found.way, found.delay_missed()), (Way::Recursion, None));
    assert!((found.delay - 2.5).abs() < 0.02, "{}", found.delay);
    // Half a sample is a twentieth of its time constant.
    let off = (found.estimate.a[0] - 10.0).abs();
    assert!(off < 0.05, "{:?}", found.estimate);
    // A delay that is given stays, and what the record shows is said.
    let given = of(Choice::Given(0));
    let [missed, sigma] = given.delay_missed().expect("another delay");
    assert_eq!(given.delay, 0.0);
    assert!(
        (missed - 2.5).abs() < 0.5 && missed > 10.0 * sigma,
        "{missed} +- {sigma}"
    );
}

#[test]
fn a_constant_is_told_from_the_rest_behind_a_large_offset() {
    for offset in [0.0, 1e4] {
        let [u, y] = late(offset);
        let signals = Signals::held(0.01, &u, &y);
        let problem = Problem::new(&signals, LAG, Options::default()).expect("a problem");
        let freedom = Freedom {
            delay: Choice::Auto,
            ..Freedom::default()
        };
        let found = identify(&problem, freedom, 0, &())
            .expect("a model")
            .estimate;
        let off = (found.theta[0] - 10.0).abs();
        assert!(off < 4.0 * found.sigma[0] && off < 0.1, "{found:?}");
    }
}
