//! The planes of the trends and the s plane: one to one, and each estimate in the right one.

use proptest::prelude::*;
use rand::RngExt;
use trendid::estimation::Terms;
use trendid::trends::{ExactTrends, FilteredTrends, Hold, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure, structure};
use trendid_host_tests::plants::linear::LinearPlant;
use trendid_host_tests::plants::polynomial::product;
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::noise::{Stream, generator};

/// An oscillator of 420 rad/s sampled nine times a period, in s and rad/s.
const DT: f32 = 1.66e-3;
const ROUGH: f32 = 300.0;
/// a0, a1 and b0.
const OSCILLATOR: Structure<2, 3, 1> = structure!(Terms::up_to(2), [Terms::up_to(1)], false);

/// An initial estimate given to an identifier with exact trends is its estimate before the first
/// sample.
#[test]
fn an_initial_estimate_stands() {
    let exact = ExactTrends::<2>::for_bandwidth(DT, ROUGH).unwrap();
    let mut config: Config<2, 3, 1> = Config::new(OSCILLATOR, ROUGH, [1.0], 1.0);
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
        let image = trends.design().to_trend_plane(&a, nu, false).expect("poles within the sampling");
        let back = trends.design().to_s_plane(&image.a, nu, false).expect("the way back");
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

/// One drive in a motion without noise: errors of every a_i and b_0 in `(omega Delta)^2`, as the
/// trends have them and after the way back.
fn bends<const M: usize, const N: usize>(
    structure: Structure<M, N, 1>,
    a: [f64; M],
    angle: f64,
    hold: Hold,
    random: &mut Random,
) -> [Vec<f64>; 2] {
    // A drive of 1 rad/s and the gain 1.
    let bandwidth = random.random_range(0.6_f64..1.7) as f32;
    let trends = FilteredTrends::<M>::for_bandwidth(Scheme::Tustin, angle as f32, bandwidth);
    let trends = trends.expect("a filter");
    let design = trends.design().clone();
    let mut config = Config::new(structure, bandwidth, [1.0], 1.0);
    config.holds = [hold];
    let mut identifier: Identifier<_, M, N> =
        Identifier::try_new(&config, trends).expect("settings");
    let mut plant = LinearPlant::new(&a, &[1.0], angle).expect("a plant");
    let mean = random.random_range(1.5..5.0);
    let (mut u, mut left, mut before) = (1.0, 0.0, 0.0);
    for _ in 0..(200.0 / angle) as usize {
        if left <= 0.0 {
            u = if random.random() { 1.0 } else { -1.0 };
            left = mean * random.random_range(0.3..1.7);
        }
        left -= angle;
        let y = plant.output() as f32;
        match hold {
            Hold::First => {
                let _ = identifier.update(before as f32, y);
                plant.step_ramp(&[before], &[u]);
            }
            _ => {
                let _ = identifier.update(u as f32, y);
                plant.step(&[u]);
            }
        }
        before = u;
    }
    let found = identifier.estimate().transfer_function();
    let bent = design.to_trend_plane(&found.a, structure.integrators(), false);
    let of = |denominator: [f32; M], numerator: f32| {
        let error = |found: f32, exact: f64| (f64::from(found) / exact - 1.0) / (angle * angle);
        let mut errors: Vec<f64> = (0..M)
            .filter(|i| a[*i] != 0.0)
            .map(|i| error(denominator[i], a[i]))
            .collect();
        errors.push(error(numerator, 1.0));
        errors
    };
    let after = of(found.a, found.b[0][0]);
    let before = match bent {
        Some(bent) => of(bent.a, bent.numerator * found.b[0][0]),
        None => after.clone(),
    };
    [before, after]
}

/// Least and largest.
fn range(values: &[f64]) -> [f64; 2] {
    values
        .iter()
        .fold([f64::INFINITY, -f64::INFINITY], |[low, high], v| {
            [low.min(*v), high.max(*v)]
        })
}

/// Drives drawn at random: of what trapezoids bend no more is left than stands in
/// `src/trends/trapezoids.rs`, and less than half of it.
#[test]
fn what_trapezoids_bend_is_straightened() {
    for (name, hold, most) in [("held", Hold::Zero, 0.08), ("straight", Hold::First, 0.14)] {
        let mut all = [Vec::new(), Vec::new()];
        for family in ["oscillator", "drive"] {
            let mut random = generator(301_000, Stream::White);
            let mut found = [Vec::new(), Vec::new()];
            for _ in 0..100 {
                let angle = 10_f64.powf(random.random_range(-1.3..-0.5));
                let xi = random.random_range(0.1..1.5);
                let [before, after] = match family {
                    "oscillator" => bends(OSCILLATOR, [1.0, 2.0 * xi], angle, hold, &mut random),
                    _ => {
                        let a = [0.0, 1.0, 2.0 * xi];
                        bends(
                            Structure::<3, 3, 1>::INTEGRATING,
                            a,
                            angle,
                            hold,
                            &mut random,
                        )
                    }
                };
                found[0].extend(before);
                found[1].extend(after);
            }
            let [before, after] = [range(&found[0]), range(&found[1])];
            println!("{name}, {family}: {before:.3?} of (omega Delta)^2, then {after:.3?}");
            for (all, found) in all.iter_mut().zip(found) {
                all.extend(found);
            }
        }
        let [before, after] = all.map(|values| {
            let square: f64 = values.iter().map(|v| v * v).sum();
            (range(&values), (square / values.len() as f64).sqrt())
        });
        println!("{name}: rms {:.3}, then {:.3}", before.1, after.1);
        assert!(after.0.iter().all(|v| v.abs() < most), "{name}: {after:?}");
        assert!(after.1 < 0.5 * before.1, "{name}: {before:?} {after:?}");
    }
}
