//! The chain of filtered trends in the core against the chain in f64.

use crate::common::{filter, rounded};
use trendid::trends::{Chain, FilteredTrends, Form, Memory, TrendOperator};
use trendid_host_tests::oracles::trends::{
    Hold, Scheme, applied, chain_held, chain_output, input_trend, output_trend,
};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

const DT: f32 = 0.001;

/// Largest difference of two series relative to the largest value of the second.
fn distance(core: &[f32], oracle: &[f64]) -> f64 {
    let scale = oracle.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
    assert!(scale > 0.0 && core.len() == oracle.len());
    core.iter()
        .zip(oracle)
        .fold(0.0_f64, |g, (c, o)| g.max((f64::from(*c) - o).abs()))
        / scale
}

/// Worst distance of every trend of y from the f64 chain and from "trend, then filter".
fn output_chain<const M: usize>(scheme: Scheme, trends: &FilteredTrends<M>, y: &[f64]) -> f64 {
    let (f, dt) = (coefficients(trends), f64::from(DT));
    let mut memory = Chain::output_at_rest(trends.design(), Form::Position, 0.0);
    let mut moved = Chain::output_at_rest(trends.design(), Form::Increment, 0.0);
    let mut all = vec![Vec::new(); M + 1];
    let mut increments = vec![Vec::new(); M + 1];
    for y in y {
        let t = trends.output(&mut memory, *y as f32, Form::Position);
        let d = trends.output(&mut moved, *y as f32, Form::Increment);
        for i in 0..M {
            all[i].push(t.lower[i]);
            increments[i].push(d.lower[i]);
        }
        all[M].push(t.top);
        increments[M].push(d.top);
    }
    assert!(increments[0].iter().all(|v| *v == 0.0));
    let chain = chain_output(scheme, &f, dt, y);
    let mut worst = 0.0_f64;
    for i in 0..=M {
        worst = worst.max(distance(&all[i], &chain[i]));
        if i > 0 {
            worst = worst.max(distance(&increments[i], &chain[i]));
        }
        let operator = output_trend(scheme, M, i, dt);
        let filtered = applied(&operator, scheme, Some(&f), dt, y);
        worst = worst.max(distance(&all[i], &filtered));
    }
    worst
}

/// The same of every trend of u.
fn input_chain<const M: usize>(
    scheme: Scheme,
    trends: &FilteredTrends<M>,
    hold: Hold,
    u: &[f64],
) -> f64 {
    let (f, dt) = (coefficients(trends), f64::from(DT));
    let (core_hold, chain) = match hold {
        Hold::Zero => (trendid::trends::Hold::Zero, chain_held(scheme, &f, dt, u)),
        Hold::First => (
            trendid::trends::Hold::First,
            chain_output(scheme, &f, dt, u),
        ),
    };
    let mut memory = Chain::input_at_rest(trends.design(), core_hold, 0.0);
    let mut all = vec![Vec::new(); M];
    for u in u {
        let t = trends.input(&mut memory, *u as f32, core_hold);
        for i in 0..M {
            all[i].push(t[i]);
        }
    }
    let mut worst = 0.0_f64;
    for i in 0..M {
        worst = worst.max(distance(&all[i], &chain[i]));
        let operator = input_trend(scheme, hold, M, i, dt);
        let filtered = applied(&operator, scheme, Some(&f), dt, u);
        worst = worst.max(distance(&all[i], &filtered));
    }
    worst
}

/// f_0 .. f_{m-1}, 1.
fn coefficients<const M: usize>(trends: &FilteredTrends<M>) -> Vec<f64> {
    let f = trends.filter();
    f.iter().map(|c| f64::from(*c)).chain([1.0]).collect()
}

/// Every trend of one order: the core's chain against the f64 chain and against "trend, then
/// filter".
fn chains<const M: usize>(u: &[f64], y: &[f64]) {
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        let trends = filter::<M>(scheme, 25.0);
        let worst = output_chain(scheme, &trends, y)
            .max(input_chain(scheme, &trends, Hold::Zero, u))
            .max(input_chain(scheme, &trends, Hold::First, u));
        println!("order {M}, {scheme:?}: worst distance {worst:.1e} of the largest value");
        assert!(worst < 2e-5, "order {M}, {scheme:?}: {worst}");
    }
}

#[test]
fn the_chain_is_the_f64_chain_and_trend_then_filter() {
    let record = Experiment::reference(Condition::white(100.0), 1.0).record(1001);
    let (u, mut y) = (rounded(&record.u), rounded(&record.y));
    y[0] = 0.0;
    chains::<1>(&u, &y);
    chains::<2>(&u, &y);
    chains::<3>(&u, &y);
    chains::<4>(&u, &y);
}
