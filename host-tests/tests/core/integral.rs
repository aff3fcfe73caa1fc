//! Trends over a span: exact against the definition, and on the reference servo.

use trendid::trends::{Form, Hold, IntegralTrends, Memory, Scheme, Span, TrendOperator};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

const L: usize = 7;
const DT: f64 = 0.25;

/// Sums of the last L values.
fn moving(x: &[f64]) -> Vec<f64> {
    (0..x.len())
        .map(|k| (0..L.min(k + 1)).map(|i| x[k - i]).sum())
        .collect()
}

/// One sample later.
fn shifted(x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0];
    y.extend_from_slice(&x[..x.len() - 1]);
    y
}

/// `1 + sign q^-1`.
fn combined(x: &[f64], sign: f64) -> Vec<f64> {
    x.iter()
        .zip(shifted(x))
        .map(|(a, b)| a + sign * b)
        .collect()
}

/// The trend of order i over spans, by the definition: differences, means, lags as a difference
/// equation, then M moving sums.
fn defined<const M: usize>(x: &[f64], i: usize, means: usize, lags: usize) -> Vec<f64> {
    let mut t = x.to_vec();
    for _ in 0..i {
        t = combined(&t, -1.0);
    }
    for _ in 0..means {
        t = combined(&t, 1.0).iter().map(|v| 0.5 * v).collect();
    }
    for _ in 0..lags {
        t = shifted(&t);
    }
    for _ in 0..M {
        t = moving(&t);
    }
    t.iter().map(|v| v * DT.powi((M - i) as i32)).collect()
}

/// `((1-q^-L)/(1-q^-1))^m` applied to the raw trends in f64 is what the operator gives, up to the
/// factor of the raw ones.
fn against_the_definition<const M: usize>(scheme: Scheme) {
    let signal: Vec<f64> = (0..120)
        .map(|k| f64::from((k * 37 + k * k * 11) % 101) / 16.0 - 3.0)
        .collect();
    let operator = IntegralTrends::<M, L>::try_new(scheme, DT as f32).unwrap();
    let mut y_memory = Span::<M, L>::output_at_rest(operator.design(), Form::Position, 0.0);
    let mut u_memory = Span::<M, L>::input_at_rest(operator.design(), Hold::Zero, 0.0);
    let expected_y: Vec<_> = (0..=M)
        .map(|i| match scheme {
            Scheme::Tustin => defined::<M>(&signal, i, M - i, 0),
            Scheme::Goodwin => defined::<M>(&signal, i, 0, M - i),
        })
        .collect();
    let expected_u: Vec<_> = (0..M)
        .map(|i| match scheme {
            Scheme::Tustin => defined::<M>(&signal, i, M - 1 - i, 1),
            Scheme::Goodwin => defined::<M>(&signal, i, 0, M - i),
        })
        .collect();
    for k in 0..signal.len() {
        let y = operator.output(&mut y_memory, signal[k] as f32, Form::Position);
        let u = operator.input(&mut u_memory, signal[k] as f32, Hold::Zero);
        for i in 0..M {
            for (got, expected) in [(y.lower[i], expected_y[i][k]), (u[i], expected_u[i][k])] {
                let size = 1e-4 * (1.0 + expected.abs());
                assert!(
                    (f64::from(got) - expected).abs() < size,
                    "{scheme:?} m {M} i {i} k {k}: {got} {expected}"
                );
            }
        }
        assert!((f64::from(y.top) - expected_y[M][k]).abs() < 1e-4);
    }
}

#[test]
fn spans_of_differences_and_sums() {
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        against_the_definition::<1>(scheme);
        against_the_definition::<2>(scheme);
        against_the_definition::<3>(scheme);
    }
}

#[test]
fn the_reference_servo_over_spans_of_70_ms() {
    let mut squares = [0.0; 3];
    let seeds = 5200..5300_u64;
    for seed in seeds.clone() {
        let mut condition = Condition::white(100.0);
        condition.w_um = 0.0;
        let record = Experiment::reference(condition, 1.0).record(seed);
        let trends = IntegralTrends::<3, 70>::try_new(Scheme::Tustin, 0.001).unwrap();
        let config = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [0.4], 50.0);
        let mut identifier: Identifier<_, 3, 3> = Identifier::try_new(&config, trends).unwrap();
        for sample in record.samples() {
            let _ = identifier.update(sample.u as f32, sample.y as f32);
        }
        let theta = identifier.theta().map(f64::from);
        let found = Servo::from_coefficients(theta[0], theta[1], theta[2]).unwrap();
        for (sum, e) in squares.iter_mut().zip(found.error_pct(&REFERENCE)) {
            *sum += e * e / 100.0;
        }
    }
    let rms = squares.map(f64::sqrt);
    println!("eta 100 um, 1 s, L = 70, seeds {seeds:?}: rms error of C/omega0/xi {rms:.3?} %");
    assert!(rms.iter().all(|e| *e < 0.2), "{rms:?}");
}
