//! The recursion of the core against the f64 oracle's batch, and its chain against the oracle's.

use trendid::estimation::Terms;
use trendid::trends::{AnyTrends, FilteredTrends, RawTrends};
use trendid::{Config, Identifier, Structure, structure};
use trendid_host_tests::oracles::trends::Scheme;
use trendid_host_tests::plants::linear::Input;

use crate::common::{self, core_scheme};
use crate::dense::{DT, LIMIT, both, noisy_record, record};

/// One type for every operator: the core is compiled once for each structure.
fn filter<const M: usize>(scheme: Scheme, pole: f32) -> AnyTrends<M> {
    AnyTrends::Filtered(common::filter(scheme, pole))
}

#[test]
fn servo_with_and_without_constant_and_start() {
    let inputs = [Input::new(&[1e6])];
    let servo = record(&[0.0, 400.0, 20.0], &inputs, 0.0, 31);
    let pushed = record(&[0.0, 400.0, 20.0], &inputs, 1e5, 32);
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        let f = filter::<3>(scheme, 25.0);
        let slow = FilteredTrends::for_bandwidth(core_scheme(scheme), DT, 20.0).unwrap();
        let slow = AnyTrends::Filtered(slow);
        let plain = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [1.0], 50.0);
        both(
            &format!("servo, {scheme:?}"),
            plain.clone(),
            f.clone(),
            scheme,
            &servo,
            LIMIT,
        );
        let name = format!("servo, slow pole, {scheme:?}");
        both(&name, plain, slow.clone(), scheme, &servo, LIMIT);
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
    let structure: Structure<2, 3, 1> = structure!(Terms::up_to(2), [Terms::of(&[1])], false);
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
    let structure: Structure<3, 2, 1> = structure!(Terms::of(&[2]), [Terms::of(&[0])], false);
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
    let structure: Structure<2, 6, 2> =
        structure!(Terms::up_to(2), [Terms::up_to(2), Terms::of(&[0])], true);
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
        let mut identifier: Identifier<_, 2, 6, 2, 8> = Identifier::try_new(&config, f).unwrap();
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
        let raw = AnyTrends::Raw(RawTrends::try_new(core_scheme(scheme), DT).unwrap());
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
