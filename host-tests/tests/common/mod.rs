//! What the tests of the core against the f64 oracles share: the rows of the oracle and the user's units of the core.

#![allow(dead_code, reason = "every test file uses its own part")]

use nalgebra::{DMatrix, DVector};
use trendid::{Column, Config, Identifier, TrendOperator};
use trendid_host_tests::oracle::Structure;
use trendid_host_tests::polynomial::delayed;
use trendid_host_tests::trends::{Hold, Scheme, applied, input_trend, output_trend};

/// The core's name of a scheme.
pub fn core_scheme(scheme: Scheme) -> trendid::Scheme {
    match scheme {
        Scheme::Goodwin => trendid::Scheme::Goodwin,
        Scheme::Tustin => trendid::Scheme::Tustin,
    }
}

/// The numbers that an f32 sample can hold.
pub fn rounded(x: &[f64]) -> Vec<f64> {
    x.iter().map(|v| f64::from(*v as f32)).collect()
}

/// Rows of the oracle from sample `first` on: [`Structure`]'s columns, then the start if `start` gives its decay.
///
/// The drive and its inputs rest at zero before the record; a constant has been 1 for ever where the plant does not
/// integrate, and begins with the record where it does.
#[allow(clippy::too_many_arguments, reason = "one per quantity of the model")]
pub fn rows(
    structure: &Structure,
    scheme: Scheme,
    f: Option<&[f64]>,
    dt: f64,
    u: &[&[f64]],
    y: &[f64],
    start: Option<f64>,
    first: usize,
) -> (DMatrix<f64>, DVector<f64>) {
    let m = structure.m;
    let trend = |operator: &[f64], x: &[f64]| applied(operator, scheme, f, dt, x);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for &i in &structure.a {
        let column = trend(&output_trend(scheme, m, i, dt), y);
        columns.push(column.into_iter().map(|v| -v).collect());
    }
    for (input, u) in structure.inputs.iter().zip(u) {
        for &i in &input.b {
            let operator = input_trend(scheme, input.hold, m, i, dt);
            columns.push(trend(&delayed(&operator, input.delay), u));
        }
    }
    if structure.constant {
        let before = if structure.a.first() == Some(&0) {
            20_000
        } else {
            0
        };
        let ones = vec![1.0; before + y.len()];
        let column = trend(&input_trend(scheme, Hold::Zero, m, 0, dt), &ones);
        columns.push(column[before..].to_vec());
    }
    if let Some(decay) = start {
        columns.push((0..y.len()).map(|k| decay.powi(k as i32)).collect());
    }
    let target = trend(&output_trend(scheme, m, m, dt), y);
    (
        DMatrix::from_fn(y.len() - first, columns.len(), |k, j| columns[j][k + first]),
        DVector::from_column_slice(&target[first..]),
    )
}

/// User's unit of each normalised parameter by design: a signal of the configured size at the configured bandwidth.
pub fn design_units<const M: usize, const N: usize, const I: usize>(
    config: &Config<M, N, I>,
) -> [f64; N] {
    let omega = f64::from(config.bandwidth);
    let range = f64::from(config.output_range);
    config.structure.columns().map(|column| match column {
        Column::Output { power } => omega.powi((M - power) as i32),
        Column::Input { input, power } => {
            omega.powi((M - power) as i32) * range / f64::from(config.input_range[input])
        }
        Column::Constant => omega.powi(M as i32) * range,
        Column::Start => range,
    })
}

/// Parameters of the recursion itself in the user's units, without what the read-out does to them.
pub fn recursion<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
>(
    identifier: &Identifier<T, M, N, I, D>,
    config: &Config<M, N, I>,
) -> [f64; N] {
    let units = design_units(config);
    core::array::from_fn(|j| f64::from(identifier.estimator().theta()[j]) * units[j])
}
