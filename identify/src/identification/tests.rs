//! Instruments against least squares, and what is refused.

use super::*;
use crate::error::Weakness;
use crate::problem::{Options, Structure};
use crate::signals::Signals;

const LAG: Structure = Structure {
    order: 1,
    integrator: false,
    zeros: 0,
    constant: true,
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
    let structure = Structure {
        order: 1,
        integrator: false,
        zeros: 0,
        constant: false,
    };
    let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
    let refused = identify(&problem, Freedom::default(), 0, &());
    assert_eq!(refused, Err(problem.cannot_carry(Weakness::NoSimulation)));
}
