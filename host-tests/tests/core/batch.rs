//! The recursion of the core against the f64 oracle's batch, and its chain against the oracle's.

use crate::common::{core_scheme, design_units, filter, rounded, rows};
use trendid::estimation::{StabilisedForgetting, Terms};
use trendid::trends::{FilteredTrends, RawTrends, TrendOperator};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::oracles::forgetting::{Forgetting, Kind};
use trendid_host_tests::oracles::least_squares::{self, InputTerms, recursive_equivalent};
use trendid_host_tests::oracles::trends::{Hold, Scheme, filter_denominator, output_trend};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::noise::{Stream, generator};

use rand::RngExt;

const DT: f32 = 0.001;

/// Largest relative gap between the recursion in f32 and the batch in f64, in theta.
const LIMIT: f64 = 3e-5;

/// A plant with commands of binary noise and steps, noise on the position; all numbers fit into f32.
fn record(a: &[f64], inputs: &[Input], constant: f64, seed: u64) -> (Vec<Vec<f64>>, Vec<f64>) {
    noisy_record(a, inputs, constant, 1e-3, seed)
}

/// As [`record`] with white noise of full width `eta`.
fn noisy_record(
    a: &[f64],
    inputs: &[Input],
    constant: f64,
    eta: f64,
    seed: u64,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let n = 1500;
    let dt = f64::from(DT);
    let mut plant = LinearPlant::with_inputs(a, inputs, constant, dt).unwrap();
    if a[0] != 0.0 {
        plant.reset(constant / a[0]);
    }
    let commands: Vec<Vec<f64>> = (0..inputs.len() as u64)
        .map(|j| {
            let steps = Excitation::Steps {
                amplitude: 1.0,
                hold_s: 0.03 + 0.02 * j as f64,
            };
            rounded(&steps.sequence(n, dt, seed + j))
        })
        .collect();
    let mut random = generator(seed, Stream::White);
    let y: Vec<f64> = (0..n)
        .map(|k| {
            let y = plant.output() + eta * (random.random::<f64>() - 0.5);
            let u: Vec<f64> = commands.iter().map(|c| c[k]).collect();
            plant.step(&u);
            y
        })
        .collect();
    (commands, rounded(&y))
}

/// Newest coefficient of the trend of order m: how the noise of one sample enters the target.
fn newest(scheme: Scheme, m: usize, f: Option<&[f64]>) -> f64 {
    let dt = f64::from(DT);
    let raw = output_trend(scheme, m, m, dt)[0];
    raw / f.map_or(1.0, |f| filter_denominator(scheme, f, dt)[0])
}

/// Largest distance between core and batch, relative to the parameter (or to a thousandth of its design size).
fn gap<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize>(
    config: &Config<M, N, I>,
    trends: T,
    scheme: Scheme,
    u: &[Vec<f64>],
    y: &[f64],
) -> f64 {
    let dt = f64::from(DT);
    let f: Option<Vec<f64>> = trends
        .design()
        .filter
        .map(|f| f.iter().map(|c| f64::from(*c)).chain([1.0]).collect());
    let model = &config.structure;
    let powers = |terms: Terms| (0..M).filter(|i| terms.contains(*i)).collect();
    let structure = least_squares::Structure {
        m: M,
        a: powers(model.output()),
        inputs: (0..I)
            .map(|j| InputTerms {
                b: powers(model.inputs()[j]),
                delay: config.delays[j],
                hold: match config.holds[j] {
                    trendid::trends::Hold::Zero => Hold::Zero,
                    trendid::trends::Hold::First => Hold::First,
                },
            })
            .collect(),
        constant: model.constant(),
    };
    let first = structure.first_full();
    let mut config = config.clone();
    // The same rows as the batch.
    config.settling = (first as f32 + 0.5) * DT;
    let mut identifier: Identifier<T, M, N, I, 8> = Identifier::try_new(&config, trends).unwrap();
    for k in 0..y.len() {
        let _ = identifier.update_inputs(core::array::from_fn(|j| u[j][k] as f32), y[k] as f32);
    }
    let core = identifier.recursion().theta().map(f64::from);

    let fresh: Identifier<T, M, N, I, 8> = Identifier::try_new(&config, trends).unwrap();
    let prior: [f64; N] = core::array::from_fn(|j| f64::from(fresh.estimator().covariance(j, j)));

    let start = model.initial_state().then(|| {
        let slowest = f64::from(trends.design().slow_mode);
        assert!(slowest > 0.0 && slowest < 1.0);
        slowest
    });
    let views: Vec<&[f64]> = u.iter().map(Vec::as_slice).collect();
    let (phi, target) = rows(
        &structure,
        scheme,
        f.as_deref(),
        dt,
        &views,
        y,
        start,
        first,
    );
    let units = design_units(&config);
    let sd = units.map(|unit| 10.0 * unit);
    let noise = newest(scheme, M, f.as_deref()) * f64::from(config.output_noise);
    let batch: Vec<f64> = match config.memory {
        None => recursive_equivalent(&phi, &target, 1.0, &[0.0; N], &sd, noise)
            .unwrap()
            .theta
            .as_slice()
            .to_vec(),
        Some(memory) => {
            // The prior is ten design sizes, and its variance counts noise in the normalised equation.
            let scale = 10.0 / prior[0].sqrt() / noise;
            let lambda = 1.0 - DT / memory;
            let bound = StabilisedForgetting::new([0.0; N], lambda).bound();
            let kind = Kind::InTurn {
                variance: 32_768.0,
                follows: 0.1 * f64::from(bound),
            };
            let mut dense = Forgetting::<N>::new(kind, prior, 1.0 / f64::from(1.0 - lambda));
            for (k, psi) in target.iter().enumerate() {
                let phi = std::array::from_fn(|j| scale * units[j] * phi[(k, j)]);
                dense.update(&phi, scale * psi);
            }
            let theta = dense.theta();
            (0..N).map(|j| units[j] * theta[j]).collect()
        }
    };
    (0..N).fold(0.0, |worst: f64, j| {
        // The start is some 1e-4 mm beside strokes of 100 mm: judged by its design size, like any small parameter.
        let size = batch[j].abs().max(1e-3 * units[j]);
        worst.max((core[j] - batch[j]).abs() / size)
    })
}

/// The core without and with a memory of 0.4 s: the worst gaps.
fn both<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize>(
    name: &str,
    config: Config<M, N, I>,
    trends: T,
    scheme: Scheme,
    (u, y): &(Vec<Vec<f64>>, Vec<f64>),
    limit: f64,
) {
    let all = gap(&config, trends, scheme, u, y);
    let mut forgetting = config;
    forgetting.memory = Some(0.4);
    let recent = gap(&forgetting, trends, scheme, u, y);
    println!("{name}: no forgetting {all:.1e}, memory 0.4 s {recent:.1e}, limit {limit:.0e}");
    assert!(all < limit && recent < limit, "{name}: {all} {recent}");
}

#[test]
fn servo_with_and_without_constant_and_start() {
    let inputs = [Input::new(&[1e6])];
    let servo = record(&[0.0, 400.0, 20.0], &inputs, 0.0, 31);
    let pushed = record(&[0.0, 400.0, 20.0], &inputs, 1e5, 32);
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        let f = filter::<3>(scheme, 25.0);
        let slow = FilteredTrends::for_bandwidth(core_scheme(scheme), DT, 20.0).unwrap();
        let plain = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [1.0], 50.0);
        both(
            &format!("servo, {scheme:?}"),
            plain.clone(),
            f,
            scheme,
            &servo,
            LIMIT,
        );
        let name = format!("servo, slow pole, {scheme:?}");
        both(&name, plain, slow, scheme, &servo, LIMIT);
        let constant = Structure::<3, 4, 1>::INTEGRATING_WITH_CONSTANT;
        let config = Config::new(constant, 20.0, [1.0], 50.0);
        both(
            &format!("constant, {scheme:?}"),
            config,
            f,
            scheme,
            &pushed,
            LIMIT,
        );
        let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [1.0], 50.0);
        both(
            &format!("start, {scheme:?}"),
            config,
            slow,
            scheme,
            &servo,
            3e-3,
        );
    }
}

#[test]
fn full_models_of_order_one_to_four() {
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        let one = record(&[20.0], &[Input::new(&[100.0])], 0.0, 41);
        let config = Config::new(Structure::<1, 2, 1>::FULL, 20.0, [1.0], 5.0);
        both(
            &format!("order 1, {scheme:?}"),
            config,
            filter::<1>(scheme, 25.0),
            scheme,
            &one,
            LIMIT,
        );

        let two = record(&[400.0, 16.0], &[Input::new(&[2e3, 30.0])], 0.0, 42);
        let config = Config::new(Structure::<2, 4, 1>::FULL, 20.0, [1.0], 5.0);
        both(
            &format!("order 2, {scheme:?}"),
            config,
            filter::<2>(scheme, 25.0),
            scheme,
            &two,
            LIMIT,
        );

        // (s + 10)(s^2 + 16 s + 400)
        let a = [4000.0, 560.0, 26.0];
        let three = record(&a, &[Input::new(&[2e4, 700.0, 10.0])], 0.0, 43);
        let config = Config::new(Structure::<3, 6, 1>::FULL, 20.0, [1.0], 5.0);
        both(
            &format!("order 3, {scheme:?}"),
            config,
            filter::<3>(scheme, 25.0),
            scheme,
            &three,
            LIMIT,
        );

        // (s^2 + 6 s + 144)(s^2 + 16 s + 900)
        let a = [129_600.0, 7704.0, 1140.0, 22.0];
        let four = record(&a, &[Input::new(&[5e5, 1e4, 300.0, 5.0])], 0.0, 44);
        let config = Config::new(Structure::<4, 8, 1>::FULL, 20.0, [1.0], 5.0);
        both(
            &format!("order 4, {scheme:?}"),
            config,
            filter::<4>(scheme, 25.0),
            scheme,
            &four,
            LIMIT,
        );
    }
}

#[test]
fn subsets_of_terms() {
    // b1 without b0, and a2 alone beside two integrators.
    let two = record(&[400.0, 16.0], &[Input::new(&[0.0, 300.0])], 0.0, 45);
    let structure = const { Structure::<2, 3, 1>::new(Terms::up_to(2), [Terms::of(&[1])], false) };
    let config = Config::new(structure, 20.0, [1.0], 5.0);
    both(
        "b1 only",
        config,
        filter::<2>(Scheme::Tustin, 25.0),
        Scheme::Tustin,
        &two,
        LIMIT,
    );
    let double = record(&[0.0, 0.0, 12.0], &[Input::new(&[1e4])], 0.0, 46);
    let structure = const { Structure::<3, 2, 1>::new(Terms::of(&[2]), [Terms::of(&[0])], false) };
    let config = Config::new(structure, 20.0, [1.0], 50.0);
    both(
        "two integrators",
        config,
        filter::<3>(Scheme::Tustin, 25.0),
        Scheme::Tustin,
        &double,
        LIMIT,
    );
}

#[test]
fn two_genuine_inputs_with_their_own_numerators_and_delays() {
    let inputs = [
        Input::delayed(&[2e3, 40.0], 3),
        Input::delayed(&[-1.2e3], 1),
    ];
    let data = record(&[400.0, 16.0], &inputs, 300.0, 51);
    let structure = const {
        Structure::<2, 6, 2>::new(Terms::up_to(2), [Terms::up_to(2), Terms::of(&[0])], true)
    };
    let mut config = Config::new(structure, 20.0, [1.0, 1.0], 5.0);
    config.delays = [3, 1];
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        both(
            &format!("MISO, {scheme:?}"),
            config.clone(),
            filter::<2>(scheme, 25.0),
            scheme,
            &data,
            LIMIT,
        );
    }
    // And it finds them: a0, a1, b of the first, b of the second, the constant.
    let truth = [400.0, 16.0, 2e3, 40.0, -1.2e3, 300.0];
    let find = |(u, y): &(Vec<Vec<f64>>, Vec<f64>)| {
        let f = filter::<2>(Scheme::Tustin, 25.0);
        let mut identifier: Identifier<_, 2, 6, 2, 3> = Identifier::try_new(&config, f).unwrap();
        for k in 0..y.len() {
            let _ = identifier.update_inputs([u[0][k] as f32, u[1][k] as f32], y[k] as f32);
        }
        identifier
    };
    let clean = find(&noisy_record(&[400.0, 16.0], &inputs, 300.0, 0.0, 51));
    let theta = clean.theta();
    println!("MISO without noise: {theta:?}, truth {truth:?}");
    let model = clean.estimate().transfer_function();
    assert_eq!(model.a, [theta[0], theta[1]]);
    assert_eq!(model.b, [[theta[2], theta[3]], [theta[4], 0.0]]);
    assert_eq!(model.constant, theta[5]);
    for (found, truth) in theta.iter().zip(truth) {
        assert!((found / truth - 1.0).abs() < 1e-3, "{found} {truth}");
    }
    // Noise that outweighs the discretisation (6e-5) many times.
    let noisy = find(&noisy_record(&[400.0, 16.0], &inputs, 300.0, 0.2, 51));
    let noisy = noisy.estimate();
    println!("  with noise {:?}, sigma {:?}", noisy.theta(), noisy.std());
    for ((found, sigma), truth) in noisy.theta().iter().zip(noisy.std()).zip(truth) {
        assert!((found - truth).abs() < 3.0 * sigma && sigma < 0.1 * truth.abs());
    }
}

#[test]
fn first_order_hold_and_raw_trends() {
    let data = record(&[400.0, 16.0], &[Input::new(&[2e3, 30.0])], 0.0, 61);
    let mut config = Config::new(Structure::<2, 4, 1>::FULL, 20.0, [1.0], 5.0);
    config.holds = [trendid::trends::Hold::First];
    both(
        "first-order hold",
        config.clone(),
        filter::<2>(Scheme::Tustin, 25.0),
        Scheme::Tustin,
        &data,
        LIMIT,
    );
    let f = filter::<2>(Scheme::Goodwin, 25.0);
    both(
        "first-order hold, Goodwin",
        config.clone(),
        f,
        Scheme::Goodwin,
        &data,
        LIMIT,
    );
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        let raw = RawTrends::try_new(core_scheme(scheme), DT).unwrap();
        config.holds = [trendid::trends::Hold::Zero];
        both(
            &format!("raw, {scheme:?}"),
            config.clone(),
            raw,
            scheme,
            &data,
            LIMIT,
        );
    }
}
