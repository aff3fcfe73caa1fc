//! What the tests of the core against the f64 oracles share: the rows of the oracle and the user's
//! units of the core.

#![allow(dead_code, reason = "every test file uses its own part")]

use nalgebra::{DMatrix, DVector};
use trendid::Config;
use trendid::estimation::Parameter;
use trendid::trends::FilteredTrends;
use trendid_host_tests::oracles::least_squares::{InputTerms, Structure};
use trendid_host_tests::oracles::trends::{Hold, Scheme, applied, input_trend, output_trend};
use trendid_host_tests::plants::polynomial::delayed;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

/// The core's name of a scheme.
pub(crate) fn core_scheme(scheme: Scheme) -> trendid::trends::Scheme {
    match scheme {
        Scheme::Goodwin => trendid::trends::Scheme::Goodwin,
        Scheme::Tustin => trendid::trends::Scheme::Tustin,
    }
}

/// The numbers that an f32 sample can hold.
pub(crate) fn rounded(x: &[f64]) -> Vec<f64> {
    x.iter().map(|v| f64::from(*v as f32)).collect()
}

/// Rest before the record, in samples: long against the filters used here.
const BEFORE: usize = 5000;

/// Rows of the oracle from sample `first` on: [`Structure`]'s columns, then the start if `start`
/// gives its decay.
///
/// A plant that does not integrate has rested at `y[0]` and the constant has been 1 for ever; one
/// that integrates begins to be pushed with the record. Inputs are zero before the record.
#[allow(clippy::too_many_arguments, reason = "one per quantity of the model")]
pub(crate) fn rows(
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
    let before = if structure.a.first() == Some(&0) {
        BEFORE
    } else {
        0
    };
    let origin = if before > 0 { 0.0 } else { y[0] };
    let after_rest = |rest: f64, x: &[f64]| -> Vec<f64> {
        let past = core::iter::repeat_n(rest, before);
        past.chain(x.iter().copied()).collect()
    };
    let trend = |operator: &[f64], x: &[f64]| -> Vec<f64> {
        applied(operator, scheme, f, dt, x)[before..].to_vec()
    };
    let moved: Vec<f64> = y.iter().map(|y| y - origin).collect();
    let output = after_rest(moved[0], &moved);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for &i in &structure.a {
        let column = trend(&output_trend(scheme, m, i, dt), &output);
        columns.push(column.into_iter().map(|v| -v).collect());
    }
    for (input, u) in structure.inputs.iter().zip(u) {
        let command = after_rest(0.0, u);
        for &i in &input.b {
            let operator = input_trend(scheme, input.hold, m, i, dt);
            columns.push(trend(&delayed(&operator, input.delay), &command));
        }
    }
    if structure.constant {
        let ones = vec![1.0; before + y.len()];
        columns.push(trend(&input_trend(scheme, Hold::Zero, m, 0, dt), &ones));
    }
    if let Some(decay) = start {
        columns.push((0..y.len()).map(|k| decay.powi(k as i32)).collect());
    }
    let target = trend(&output_trend(scheme, m, m, dt), &output);
    (
        DMatrix::from_fn(y.len() - first, columns.len(), |k, j| columns[j][k + first]),
        DVector::from_column_slice(&target[first..]),
    )
}

/// A_f of the default filter at 20 rad/s, from its constant up: poles at 2.2 rad/s and of
/// damping 0.7 at 22 rad/s.
pub(crate) const SERVO_FILTER: [f64; 4] = [1064.8, 551.76, 33.0, 1.0];

/// Rows of the oracle for a record of the servo with the default filter: a1, a2, b0, the constant,
/// the start.
pub(crate) fn servo_rows(record: &Record) -> (DMatrix<f64>, DVector<f64>) {
    let structure = Structure {
        m: 3,
        a: vec![1, 2],
        inputs: vec![InputTerms {
            b: vec![0],
            delay: 0,
            hold: Hold::Zero,
        }],
        constant: true,
    };
    // The slow pole over one sample time, by trapezoids.
    let half = 0.5 * 2.2 * record.dt;
    let decay = (1.0 - half) / (1.0 + half);
    rows(
        &structure,
        Scheme::Tustin,
        Some(&SERVO_FILTER),
        record.dt,
        &[&rounded(&record.u)],
        &rounded(&record.y),
        Some(decay),
        0,
    )
}

/// The reference servo for so many seconds under a multisine: a drive that integrates stays where
/// f32 has digits.
pub(crate) fn long_experiment(condition: Condition, duration_s: f64) -> Experiment {
    let mut experiment = Experiment::reference(condition, duration_s);
    experiment.excitation = Excitation::Multisine {
        amplitude: 0.5,
        first_hz: 0.3,
        lines: 12,
    };
    experiment
}

/// User's unit of each normalised parameter by design: a signal of the configured size at the
/// configured bandwidth.
pub(crate) fn design_units<const M: usize, const N: usize, const I: usize>(
    config: &Config<M, N, I>,
) -> [f64; N] {
    let omega = f64::from(config.bandwidth);
    let range = f64::from(config.output_range);
    config.structure.parameters().map(|column| match column {
        Parameter::Output { power } => omega.powi((M - power) as i32),
        Parameter::Input { input, power } => {
            omega.powi((M - power) as i32) * range / f64::from(config.input_range[input])
        }
        Parameter::Constant => omega.powi(M as i32) * range,
        Parameter::InitialState => range,
    })
}

/// Numbers at the edges of f32.
pub(crate) fn edges() -> Vec<f32> {
    vec![
        0.0,
        -0.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        1e-45,
    ]
}

/// Trends at 1 kHz through a filter with all poles at `-pole` rad/s.
pub(crate) fn filter<const M: usize>(scheme: Scheme, pole: f32) -> FilteredTrends<M> {
    FilteredTrends::try_new(core_scheme(scheme), 0.001, [pole; M]).unwrap()
}
