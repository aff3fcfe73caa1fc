//! Poles, stability and the physical reading of the core against polynomials with known roots.

use crate::common::edges;
use crate::roots::{Root, distance, expand, transfer};
use proptest::prelude::*;
use trendid::model::{Physical, Pole};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure, TransferFunction};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

fn check<const M: usize>(roots: &[Root], limit: f64) {
    let (a, plane) = expand(roots);
    assert_eq!(a.len(), M);
    let model = transfer::<M>(&a);
    let poles = model.poles().expect("finite coefficients");
    let apart = distance(&poles, &plane);
    println!("{roots:?}: {apart:.1e} of the largest root");
    assert!(apart < limit, "{roots:?}: {poles:?}");
    let stable = plane.iter().all(|(re, _)| *re < 0.0);
    assert_eq!(model.is_stable(), stable, "{roots:?}");
    let size = |p: &Pole| p.re.hypot(p.im);
    assert!(
        poles
            .windows(2)
            .all(|p| size(&p[0]) <= size(&p[1]) * (1.0 + 1e-5))
    );
}

#[test]
fn poles_of_known_polynomials() {
    use Root::{Pair, Real};
    check::<1>(&[Real(-20.0)], 1e-6);
    check::<1>(&[Real(3.0)], 1e-6);
    check::<2>(&[Real(-1.0), Real(-1000.0)], 1e-6);
    check::<2>(&[Real(5.0), Real(-7.0)], 1e-6);
    check::<2>(&[Pair(-10.0, 17.3)], 1e-6);
    check::<2>(&[Pair(0.4, 430.0)], 1e-6);
    check::<3>(&[Real(-2.0), Real(-30.0), Real(-400.0)], 1e-5);
    check::<3>(&[Real(-128.0), Pair(-5.0, 36.0)], 1e-5);
    check::<3>(&[Real(0.5), Pair(-5.0, 36.0)], 1e-5);
    check::<3>(&[Real(-9.0), Pair(1.0, 20.0)], 1e-5);
    check::<4>(&[Real(-1.0), Real(-9.0), Real(-80.0), Real(-300.0)], 1e-5);
    check::<4>(&[Pair(-3.0, 12.0), Pair(-8.0, 28.0)], 1e-5);
    check::<4>(&[Pair(0.3, 12.0), Pair(-8.0, 28.0)], 1e-5);
    check::<4>(&[Pair(-3.0, 12.0), Real(-0.1), Real(-200.0)], 1e-5);
}

/// A k-fold root moves by the k-th root of the rounding of the coefficients: 2^-24 to the power
/// 1/k, times some units.
#[test]
fn multiple_roots() {
    use Root::{Pair, Real};
    let eps = 2_f64.powi(-24);
    check::<2>(&[Real(-20.0); 2], 3.0 * eps.powf(0.5));
    check::<3>(
        &[Real(-20.0), Real(-20.0), Real(-300.0)],
        3.0 * eps.powf(0.5),
    );
    check::<3>(&[Real(-20.0); 3], 5.0 * eps.powf(1.0 / 3.0));
    check::<4>(&[Pair(-10.0, 17.0), Pair(-10.0, 17.0)], 5.0 * eps.powf(0.5));
    check::<4>(&[Real(-20.0); 4], 5.0 * eps.powf(0.25));
    check::<4>(
        &[Real(-20.0), Real(-20.0), Pair(-5.0, 40.0)],
        5.0 * eps.powf(0.5),
    );
}

#[test]
fn integrators_come_first_and_do_not_count_as_unstable() {
    let servo = transfer::<3>(&[0.0, 400.0, 20.0]);
    let poles = servo.poles().unwrap();
    assert_eq!(poles[0], Pole { re: 0.0, im: 0.0 });
    assert!(
        distance(
            &poles[1..],
            &[(-10.0, 300_f64.sqrt()), (-10.0, -(300_f64.sqrt()))]
        ) < 1e-6
    );
    assert!(servo.is_stable());
    let double = transfer::<3>(&[0.0, 0.0, 12.0]);
    assert_eq!(double.poles().unwrap()[2].re, -12.0);
    assert!(double.is_stable());
    let only = transfer::<2>(&[0.0, 0.0]);
    assert_eq!(only.poles().unwrap(), [Pole { re: 0.0, im: 0.0 }; 2]);
    assert_eq!(only.gain(0), Some(1.0));
    assert!(only.is_stable());
    assert_eq!(
        [
            servo.integrators(),
            double.integrators(),
            only.integrators()
        ],
        [1, 2, 2]
    );
    assert_eq!(servo.gain(7), None);
}

#[test]
fn a_model_without_any_coefficient_has_no_gain_and_is_not_stable() {
    let empty = TransferFunction::<3, 1> {
        b: [[0.0; 3]],
        ..transfer(&[0.0; 3])
    };
    assert_eq!(empty.gain(0), None);
    assert!(!empty.is_stable());
    let reading = Physical::of(&empty, 0);
    assert_eq!((reading.gain, reading.stable), (None, false));
}

#[test]
fn physical_reading_of_each_kind_of_plant() {
    let near = |got: Option<f32>, want: f64| {
        let got = f64::from(got.expect("exists"));
        assert!((got / want - 1.0).abs() < 1e-4, "{got} {want}");
    };
    // One lag.
    let lag = Physical::of(&transfer::<1>(&[4.0]), 0);
    near(lag.gain, 0.25);
    near(lag.time_constants[0], 0.25);
    assert_eq!((lag.omega0, lag.damping), (None, None));
    // Two lags, read as an overdamped pair as well: 1/20 and 1/2 s, omega0 = sqrt(40).
    let two = Physical::of(&transfer::<2>(&[40.0, 22.0]), 0);
    near(two.time_constants[0], 0.5);
    near(two.time_constants[1], 0.05);
    near(two.omega0, 40_f64.sqrt());
    near(two.damping, 11.0 / 40_f64.sqrt());
    // A lag and a pair behind an integrator: the pair gives omega0, the lag its time constant.
    let (a, _) = expand(&[Root::Real(0.0), Root::Real(-8.0), Root::Pair(-6.0, 35.0)]);
    let four = Physical::of(&transfer::<4>(&a), 0);
    near(four.omega0, 6_f64.hypot(35.0));
    near(four.damping, 6.0 / 6_f64.hypot(35.0));
    near(four.time_constants[0], 0.125);
    assert_eq!(four.time_constants[1], None);
    near(four.gain, 1.0 / (8.0 * (36.0 + 1225.0)));
    // An unstable drive is read and called unstable; a falling pair of real poles has no omega0.
    let unstable = Physical::of(&transfer::<3>(&[0.0, 400.0, -2.0]), 0);
    assert!(!unstable.stable);
    near(unstable.damping, -0.05);
    let saddle = Physical::of(&transfer::<3>(&[0.0, -400.0, 20.0]), 0);
    assert_eq!((saddle.omega0, saddle.damping), (None, None));
    assert!(!saddle.stable);
}

fn root() -> impl Strategy<Value = Root> {
    prop_oneof![
        (-100.0..100.0).prop_map(Root::Real),
        ((-50.0..50.0), (1.0..100.0)).prop_map(|(re, im)| Root::Pair(re, im)),
    ]
}

/// Numbers an estimator could leave behind when all goes wrong.
fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![any::<f32>(), -1e3_f32..1e3, prop::sample::select(edges()),]
}

/// Hurwitz conditions, poles and the true roots say the same; near the axis they may differ by
/// rounding.
fn agreement<const M: usize>(roots: &[Root]) -> Result<(), TestCaseError> {
    let (a, plane) = expand(roots);
    let size = plane
        .iter()
        .fold(0.0_f64, |s, (re, im)| s.max(re.hypot(*im)));
    let model = transfer::<M>(&a);
    let Some(poles) = model.poles() else {
        return Err(TestCaseError::fail(format!("no poles for {roots:?}")));
    };
    // Coefficients move by 2^-24; four equal roots in the worst case by its fourth root.
    if plane.iter().any(|(re, _)| re.abs() < 0.03 * size) {
        return Ok(());
    }
    let stable = plane.iter().all(|(re, _)| *re < 0.0);
    prop_assert_eq!(model.is_stable(), stable, "{:?}", roots);
    prop_assert_eq!(
        poles.iter().all(|p| p.re < 0.0),
        stable,
        "{:?} {:?}",
        roots,
        poles
    );
    prop_assert!(distance(&poles, &plane) < 0.05);
    Ok(())
}

/// Whatever the coefficients: what is given is a number.
fn sound<const M: usize>(numbers: &[f32], integrators: usize) -> Result<(), TestCaseError> {
    let model = TransferFunction::<M, 1> {
        a: core::array::from_fn(|i| if i < integrators { 0.0 } else { numbers[i] }),
        b: [core::array::from_fn(|i| numbers[4 + i])],
        constant: numbers[8],
    };
    if let Some(poles) = model.poles() {
        prop_assert!(poles.iter().all(|p| p.re.is_finite() && p.im.is_finite()));
    }
    let reading = Physical::of(&model, 0);
    let numbers = [reading.gain, reading.omega0, reading.damping];
    for value in numbers.iter().chain(&reading.time_constants).flatten() {
        prop_assert!(value.is_finite(), "{:?} of {:?}", reading, model);
    }
    if model.a.iter().any(|a| !a.is_finite()) {
        prop_assert!(!model.is_stable() && model.poles().is_none());
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn stability_poles_and_roots_agree(roots in prop::collection::vec(root(), 1..5)) {
        match expand(&roots).0.len() {
            1 => agreement::<1>(&roots)?,
            2 => agreement::<2>(&roots)?,
            3 => agreement::<3>(&roots)?,
            4 => agreement::<4>(&roots)?,
            _ => {}
        }
    }

    #[test]
    fn nothing_read_is_nan(
        numbers in prop::collection::vec(any_number(), 9),
        integrators in 0_usize..6,
    ) {
        sound::<1>(&numbers, integrators)?;
        sound::<2>(&numbers, integrators)?;
        sound::<3>(&numbers, integrators)?;
        sound::<4>(&numbers, integrators)?;
    }
}

/// Standard deviations of C, omega0, xi against derivatives by differences in f64 through the same
/// covariance.
#[test]
fn physical_std_is_the_delta_method() {
    for (seed, eta) in [(81, 20.0), (82, 500.0)] {
        let record = Experiment::reference(Condition::white(eta), 1.0).record(seed);
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
        let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
        let mut identifier: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
        assert!(
            identifier
                .estimate()
                .physical_std()
                .is_none_or(|s| s.iter().all(|v| v.is_finite()))
        );
        for s in record.samples() {
            let _ = identifier.update(s.u as f32, s.y as f32);
        }
        let estimate = identifier.estimate();
        let theta = estimate.theta().map(f64::from);
        let covariance = estimate.covariance();
        let read = |t: [f64; 5]| [t[2] / t[0], t[0].sqrt(), t[1] / (2.0 * t[0].sqrt())];
        let slopes: Vec<[f64; 3]> = (0..5)
            .map(|j| {
                let (mut up, mut down) = (theta, theta);
                let h = 1e-5 * theta[j].abs();
                up[j] += h;
                down[j] -= h;
                let (up, down) = (read(up), read(down));
                core::array::from_fn(|q| {
                    if h > 0.0 {
                        (up[q] - down[q]) / (2.0 * h)
                    } else {
                        0.0
                    }
                })
            })
            .collect();
        let got = estimate.physical_std().expect("a servo");
        for q in 0..3 {
            let mut variance = 0.0;
            for i in 0..5 {
                for j in 0..5 {
                    variance += slopes[i][q] * f64::from(covariance[i][j]) * slopes[j][q];
                }
            }
            let want = variance.sqrt();
            println!("quantity {q}: {} {want:.6}", got[q]);
            assert!(want > 0.0 && (f64::from(got[q]) / want - 1.0).abs() < 1e-3);
        }
        for i in 0..5 {
            assert!(covariance[i][i] > 0.0);
            assert!((estimate.std()[i].powi(2) / covariance[i][i] - 1.0).abs() < 1e-5);
        }
    }
}
