//! The plane of the exact trends and the s plane: one to one, and each initial estimate in the
//! right one.

use proptest::prelude::*;
use trendid::estimation::Terms;
use trendid::trends::{ExactTrends, TrendOperator};
use trendid::{Config, Identifier, structure};
use trendid_host_tests::plants::polynomial::product;

/// An oscillator of 420 rad/s sampled nine times a period, in s and rad/s.
const DT: f32 = 1.66e-3;
const ROUGH: f32 = 300.0;

/// An initial estimate given to an identifier with exact trends is its estimate before the first
/// sample.
#[test]
fn an_initial_estimate_stands() {
    let exact = ExactTrends::<2>::for_bandwidth(DT, ROUGH).unwrap();
    let structure = structure!(Terms::up_to(2), [Terms::up_to(1)], false);
    let mut config: Config<2, 3, 1> = Config::new(structure, ROUGH, [1.0], 1.0);
    config.initial = [176_400.0, 42.0, 1.5e5];
    let mut identifier: Identifier<_, 2, 3> = Identifier::try_new(&config, exact).unwrap();
    let near = |theta: [f32; 3], told: [f32; 3]| {
        for (t, i) in theta.iter().zip(told) {
            assert!((t / i - 1.0).abs() < 1e-4, "{theta:?}");
        }
    };
    near(identifier.theta(), config.initial);
    identifier
        .warm_start([1.6e5, 80.0, 1.0e5], [1e3, 1.0, 1e3])
        .unwrap();
    near(identifier.theta(), [1.6e5, 80.0, 1.0e5]);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// To gamma and back, with poles anywhere below 1.8/Delta, repeated, complex, at zero, slow or
    /// unstable.
    #[test]
    fn the_planes_are_one_to_one(
        pairs in proptest::array::uniform2((0.001_f64..1.0, -1.0_f64..1.0, any::<bool>())),
        integrator in any::<bool>(),
    ) {
        let dt = 2e-3_f32;
        let fastest = 1.8 / f64::from(dt);
        // Pairs of poles at a distance and an angle, double ones at angle 0; or one lag and an
        // integrator.
        let pair = |(size, angle, repeated): (f64, f64, bool)| {
            let rate = fastest * size;
            let cosine = if repeated { 1.0 } else { angle };
            vec![rate * rate, 2.0 * rate * cosine, 1.0]
        };
        let lag = |(size, ..): (f64, f64, bool)| vec![0.0, fastest * size, 1.0];
        let second = if integrator { lag(pairs[1]) } else { pair(pairs[1]) };
        let a = product(&pair(pairs[0]), &second);
        let a: [f32; 4] = core::array::from_fn(|i| a[i] as f32);
        let nu = usize::from(integrator);
        let trends = ExactTrends::<4>::for_bandwidth(dt, 100.0).unwrap();
        let image = trends.design().to_gamma_plane(&a, nu).expect("poles within the sampling");
        let back = trends.design().to_s_plane(&image.a, nu).expect("the way back");
        // The rates of the poles may differ a thousandfold: each coefficient is held to the size
        // that they make it.
        let rate = fastest * pairs[0].0.max(pairs[1].0);
        for i in nu..4 {
            let size = f64::from(a[i]).abs().max(1e-2 * rate.powi(4 - i as i32));
            prop_assert!(f64::from((a[i] - back.a[i]).abs()) < 1e-4 * size, "{:?} {:?}", a, back);
        }
        prop_assert!((image.numerator * back.numerator - 1.0).abs() < 1e-3, "{:?} {:?}", image, back);
        if integrator {
            prop_assert_eq!(back.a[0], 0.0);
        }
    }
}
