//! The output evaluation (9)-(10) and the indices IQ and IV (11) of the core against the oracle.

use crate::common::{core_scheme, rounded};
use trendid::model::OutputEvaluation;
use trendid::trends::{RawTrends, Scheme as CoreScheme};
use trendid::{Config, Identifier, Structure, TransferFunction};
use trendid_host_tests::oracles::least_squares::{self, InputTerms, evaluated_output};
use trendid_host_tests::oracles::trends::{Hold, Scheme};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

const DT: f32 = 0.001;

/// Worst distance of the core's predictions from the oracle's, and relative ones of IQ and IV.
fn distances(
    scheme: Scheme,
    hold: Hold,
    model: TransferFunction<3, 1>,
    u: &[f64],
    y: &[f64],
) -> [f64; 3] {
    let trends = RawTrends::try_new(core_scheme(scheme), DT).unwrap();
    let core_hold = match hold {
        Hold::Zero => trendid::trends::Hold::Zero,
        Hold::First => trendid::trends::Hold::First,
    };
    let mut evaluation = OutputEvaluation::<3, 1>::with_holds(trends, [core_hold]);
    let predicted: Vec<f64> = u
        .iter()
        .zip(y)
        .filter_map(|(u, y)| {
            let error = evaluation.update(&model, [*u as f32], *y as f32)?;
            Some(y - f64::from(error))
        })
        .collect();
    let structure = least_squares::Structure {
        m: 3,
        a: vec![0, 1, 2],
        inputs: vec![InputTerms {
            b: vec![0, 1, 2],
            delay: 0,
            hold,
        }],
        constant: true,
    };
    let parameters = model.a.iter().chain(&model.b[0]).chain([&model.constant]);
    let theta: Vec<f64> = parameters.map(|v| f64::from(*v)).collect();
    let (y_hat, iq, iv) = evaluated_output(&structure, scheme, &theta, f64::from(DT), &[u], y);
    assert_eq!(predicted.len(), y_hat.len());
    let worst = predicted
        .iter()
        .zip(&y_hat)
        .fold(0.0_f64, |w, (p, o)| w.max((p - o).abs()));
    let quality = evaluation.prediction_error();
    assert_eq!(quality.samples() as usize, y_hat.len());
    [
        worst,
        f64::from(quality.ise()) / iq - 1.0,
        f64::from(quality.iae()) / iv - 1.0,
    ]
}

#[test]
fn predictions_and_indices_are_those_of_the_oracle() {
    let record = Experiment::reference(Condition::white(100.0), 1.0).record(71);
    let (u, y) = (rounded(&record.u), rounded(&record.y));
    let span = y.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let servo = TransferFunction {
        a: [0.0, 400.0, 20.0],
        b: [[1e6, 0.0, 0.0]],
        constant: 0.0,
    };
    let other = TransferFunction {
        a: [900.0, 350.0, 25.0],
        b: [[9e5, 2e4, 300.0]],
        constant: 5e3,
    };
    for model in [servo, other] {
        for (scheme, hold) in [
            (Scheme::Tustin, Hold::Zero),
            (Scheme::Tustin, Hold::First),
            (Scheme::Goodwin, Hold::Zero),
        ] {
            let [worst, iq, iv] = distances(scheme, hold, model, &u, &y);
            println!(
                "{scheme:?}, {hold:?}, a0 {}: prediction {worst:.1e} of {span:.0} mm, IQ {iq:+.1e}, IV {iv:+.1e}",
                model.a[0]
            );
            // The samples are the same: what is left is the rounding of errors of some 0.1 mm.
            assert!(worst < 2e-6);
            assert!(iq.abs() < 1e-5 && iv.abs() < 1e-5);
        }
    }
}

#[test]
fn raw_innovation_is_the_evaluation_error() {
    // Two roads to one number: the identifier's equation error over beta, and (10) with the model
    // of the moment before.
    let record = Experiment::reference(Condition::white(20.0), 1.0).record(72);
    for scheme in [CoreScheme::Tustin, CoreScheme::Goodwin] {
        let trends = RawTrends::try_new(scheme, DT).unwrap();
        let config = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [0.4], 50.0);
        let mut identifier: Identifier<_, 3, 3> =
            Identifier::try_new(&config, trends.clone()).unwrap();
        let mut evaluation = OutputEvaluation::<3, 1>::new(trends);
        let origin = record.y[0] as f32;
        let (mut worst, mut largest) = (0.0_f32, 0.0_f32);
        for s in record.samples() {
            let model = identifier.estimate().transfer_function();
            let (u, y) = (s.u as f32, s.y as f32);
            let innovation = identifier.update(u, y).innovation();
            let error = evaluation.update(&model, [u], y - origin);
            assert_eq!(innovation.is_some(), error.is_some());
            if let (Some(innovation), Some(error)) = (innovation, error) {
                worst = worst.max((innovation - error).abs());
                largest = largest.max(error.abs());
                let prediction = identifier.prediction();
                assert!((prediction + innovation - y).abs() < 4e-5);
            }
        }
        println!("{scheme:?}: innovations up to {largest:.3} mm, worst difference {worst:.1e} mm");
        assert!(largest > 0.01 && worst < 2e-7);
        let (a, b) = (identifier.prediction_error(), evaluation.prediction_error());
        assert_eq!(a.samples(), b.samples());
        assert!((a.ise() / b.ise() - 1.0).abs() < 1e-3 && (a.iae() / b.iae() - 1.0).abs() < 1e-3);
    }
}

#[test]
fn evaluation_keeps_its_indices_through_bad_samples() {
    let trends = RawTrends::try_new(CoreScheme::Tustin, DT).unwrap();
    let model = TransferFunction {
        a: [0.0, 400.0, 20.0],
        b: [[1e6, 0.0, 0.0]],
        constant: 0.0,
    };
    let mut evaluation = OutputEvaluation::<3, 1>::new(trends);
    for k in 0..10 {
        let _ = evaluation.update(&model, [0.5], 0.1 * k as f32);
    }
    let kept = evaluation.clone();
    for (u, y) in [
        (f32::NAN, 0.0),
        (0.0, f32::INFINITY),
        (f32::NEG_INFINITY, f32::NAN),
    ] {
        assert_eq!(evaluation.update(&model, [u], y), None);
    }
    assert_eq!(kept, evaluation);
    // A model that no y can satisfy: alpha = 0 gives no prediction.
    let zero = TransferFunction {
        a: [-2.0 / DT],
        ..TransferFunction::<1, 1> {
            a: [0.0],
            b: [[1.0]],
            constant: 0.0,
        }
    };
    let mut first =
        OutputEvaluation::<1, 1>::new(RawTrends::try_new(CoreScheme::Tustin, DT).unwrap());
    let _ = first.update(&zero, [0.0], 0.0);
    assert_eq!(first.update(&zero, [0.0], 1.0), None);
    evaluation.restart();
    assert_eq!(evaluation.prediction_error().samples(), 0);
}
