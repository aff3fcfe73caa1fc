//! Whatever is fed in: no panic, and every number that comes out is a number.

use crate::common::edges;
use proptest::prelude::*;
use trendid::estimation::{Estimator, NoiseLevel, StabilisedForgetting, Terms};
use trendid::identifier::DelayBank;
use trendid::inputs::DeadZone;
use trendid::trends::{
    AnyTrends, DelayLine, FilteredTrends, Hold, RawTrends, Scheme, TrendOperator,
};
use trendid::{Config, Identifier, Outcome, Structure, ValveServo, structure};

/// Any f32 at all, with the awkward ones often.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -2.0_f32..2.0,
        2 => -1e3_f32..1e3,
        2 => any::<f32>(),
        1 => prop::sample::select([edges(), vec![1e20, -1e6]].concat()),
    ]
}

/// A number such as a user who means it could give: positive, over some decades.
fn plausible(from: f32, to: f32) -> impl Strategy<Value = f32> {
    (from.ln()..to.ln()).prop_map(f32::exp)
}

/// What may be done to an identifier between two samples.
#[derive(Clone, Copy, Debug)]
enum Act {
    Sample(f32, f32),
    Adapt(bool),
    Trust,
    Reset,
    RestartTrends,
    WarmStart(f32, f32),
}

fn act() -> impl Strategy<Value = Act> {
    prop_oneof![
        40 => (number(), number()).prop_map(|(u, y)| Act::Sample(u, y)),
        1 => any::<bool>().prop_map(Act::Adapt),
        1 => Just(Act::Trust),
        1 => Just(Act::Reset),
        1 => Just(Act::RestartTrends),
        1 => (number(), number()).prop_map(|(value, std)| Act::WarmStart(value, std)),
    ]
}

/// Feeds everything; with `sound`, every number that comes out must be one.
fn survive<
    T: TrendOperator<M> + std::fmt::Debug,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
>(
    mut identifier: Identifier<T, M, N, I, D>,
    acts: &[Act],
    sound: bool,
) -> Result<(), TestCaseError> {
    for act in acts {
        match *act {
            Act::Sample(u, y) => {
                let outcome = identifier.update_inputs([u; I], y);
                if !(u.is_finite() && y.is_finite()) {
                    prop_assert!(matches!(outcome, Outcome::Refused(_)));
                }
                if let (true, Some(innovation)) = (sound, outcome.innovation()) {
                    prop_assert!(innovation.is_finite(), "{outcome:?}");
                }
            }
            Act::Adapt(on) => identifier.adapt(on),
            Act::Trust => identifier.set_nominal(),
            Act::Reset => identifier.reset(),
            Act::RestartTrends => identifier.restart_trends(),
            Act::WarmStart(value, std) => {
                let outcome = identifier.warm_start([value; N], [std; N]);
                if !(value.is_finite() && std >= 0.0 && std.is_finite()) {
                    prop_assert!(outcome.is_err());
                }
            }
        }
        let estimate = identifier.estimate();
        let (theta, std) = (estimate.theta(), estimate.std());
        let (reading, deviations) = (estimate.physical(), estimate.physical_std());
        let recursion = identifier.recursion();
        prop_assert!(recursion.std().iter().all(|v| *v >= 0.0));
        let _ = (identifier.noise_std(), identifier.prediction_error());
        if sound {
            prop_assert!(
                theta.iter().all(|v| v.is_finite()),
                "{theta:?} after {act:?}"
            );
            // Infinite where a spike of 10^6 ranges has taken all knowledge of the noise; never
            // NaN, never negative, and 0 for what was given as known alone.
            let diagonal = identifier.estimator().diagonal();
            let says = |(v, d): (&f32, &f32)| *v > 0.0 || (*v == 0.0 && *d == 0.0);
            prop_assert!(std.iter().zip(diagonal).all(says), "{std:?} after {act:?}");
            let unknown = diagonal.iter().all(|d| *d > 0.0);
            prop_assert!(
                !unknown || deviations.iter().flatten().all(|v| *v > 0.0),
                "{deviations:?} after {act:?}"
            );
            prop_assert!(identifier.prediction().is_finite());
            prop_assert!(diagonal.iter().all(|d| *d >= 0.0 && d.is_finite()));
        }
        let numbers = [reading.gain, reading.omega0, reading.damping];
        prop_assert!(numbers.iter().flatten().all(|v| v.is_finite()));
        prop_assert!(deviations.iter().flatten().all(|v| *v >= 0.0));
    }
    Ok(())
}

/// Numbers of a configuration that mean something, for any structure.
#[derive(Clone, Debug)]
struct Design {
    bandwidth: f32,
    input_range: f32,
    output_range: f32,
    memory: Option<f32>,
    first_order: bool,
    delay: usize,
    scheme: Scheme,
    sample_time: f32,
}

prop_compose! {
    fn design()(
        bandwidth in plausible(1.0, 100.0),
        input_range in plausible(1e-3, 1e3),
        output_range in plausible(1e-4, 1e4),
        memory in prop::option::of(plausible(0.2, 10.0)),
        first_order in any::<bool>(),
        delay in 0_usize..4,
        scheme in prop::sample::select(vec![Scheme::Goodwin, Scheme::Tustin]),
        sample_time in prop::sample::select(vec![2.5e-4_f32, 0.001, 0.002]),
    ) -> Design {
        Design {
            bandwidth, input_range, output_range, memory, first_order, delay, scheme, sample_time,
        }
    }
}

fn filtered<const M: usize, const N: usize, const I: usize>(
    design: &Design,
    structure: Structure<M, N, I>,
    acts: &[Act],
) -> Result<(), TestCaseError> {
    let mut config = Config::new(
        structure,
        design.bandwidth,
        [design.input_range; I],
        design.output_range,
    );
    config.memory = design.memory;
    config.delays = [design.delay; I];
    if design.first_order {
        config.holds = [Hold::First; I];
    }
    let trends = FilteredTrends::for_bandwidth(design.scheme, design.sample_time, design.bandwidth);
    let trends = trends.map_err(|e| TestCaseError::fail(e.to_string()))?;
    let raw = RawTrends::try_new(design.scheme, design.sample_time)
        .map_err(|e| TestCaseError::fail(e.to_string()))?;
    // One type for both operators, with the delay line of `dense`: the core is compiled once for
    // each structure.
    for trends in [AnyTrends::Filtered(trends), AnyTrends::Raw(raw)] {
        let identifier: Identifier<_, M, N, I, 8> =
            Identifier::try_new(&config, trends).map_err(|e| TestCaseError::fail(e.to_string()))?;
        survive(identifier, acts, true)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    /// Sensible settings, any samples.
    #[test]
    fn any_samples(design in design(), acts in prop::collection::vec(act(), 1..150)) {
        // A start that claims to know nothing (10^18) makes any quotient of tiny numbers an
        // estimate: that is left to the test of any settings, which asks for survival only.
        let acts: Vec<Act> = acts
            .into_iter()
            .filter(|act| !matches!(act, Act::WarmStart(_, std) if *std > 1e3))
            .collect();
        filtered(&design, Structure::<1, 2, 1>::FULL, &acts)?;
        filtered(&design, Structure::<2, 3, 1>::INTEGRATING_WITH_CONSTANT, &acts)?;
        filtered(&design, Structure::<3, 5, 1>::SERVO, &acts)?;
        const BOTH: [Terms; 2] = [Terms::of(&[0, 1]), Terms::of(&[0])];
        let two_inputs: Structure<3, 7, 2> = structure!(Terms::up_to(3), BOTH, true);
        filtered(&design, two_inputs, &acts)?;
        filtered(&design, Structure::<4, 8, 1>::FULL, &acts)?;
    }

    /// Any settings at all: an error that names the value, or an identifier that survives anything.
    #[test]
    fn any_settings(
        numbers in prop::array::uniform11(number()),
        delays in prop::array::uniform2(0_usize..6),
        some in any::<(bool, bool, bool)>(),
        acts in prop::collection::vec(act(), 1..60),
    ) {
        let structure: Structure<2, 4, 2> = structure!(Terms::up_to(2), [Terms::of(&[0]), Terms::of(&[1])], false);
        let mut config = Config::new(
            structure, numbers[0], [numbers[1], numbers[2]], numbers[3]);
        config.output_noise = numbers[4];
        config.delays = delays;
        config.initial_input = [numbers[5], numbers[6]];
        config.memory = some.0.then_some(numbers[7]);
        config.initial = [numbers[8]; 4];
        config.prior_std = some.1.then_some([numbers[9]; 4]);
        config.settling = if some.2 { numbers[10] } else { 0.0 };
        let trends = FilteredTrends::<2>::try_new(Scheme::Tustin, 0.001, [25.0; 2]).unwrap();
        if let Ok(identifier) = Identifier::<_, 2, 4, 2, 3>::try_new(&config, trends) {
            survive(identifier, &acts, false)?;
        }
        for scheme in [Scheme::Tustin, Scheme::Goodwin] {
            let _ = FilteredTrends::<3>::try_new(scheme, numbers[0], [numbers[1], numbers[2], numbers[3]]);
            let _ = FilteredTrends::<4>::from_polynomial(
                scheme, numbers[0], [numbers[1], numbers[2], numbers[3], numbers[4]]);
            let _ = FilteredTrends::<3>::for_bandwidth(scheme, numbers[0], numbers[1]);
            let _ = RawTrends::<3>::try_new(scheme, numbers[0]);
        }
    }

    /// The smaller parts, any numbers.
    #[test]
    fn any_parts(
        numbers in prop::collection::vec(number(), 40),
        delay in 0_usize..20,
        index in 0_usize..9,
    ) {
        let mut line = DelayLine::<3>::new();
        let mut level = NoiseLevel::new(0.99);
        let valve = DeadZone::new(numbers[0], numbers[1], 3);
        let mut servo = ValveServo::new(0.001, 20.0, 1.0, 50.0, 0.7, valve).unwrap();
        let mut estimator = Estimator::<2>::new([0.0; 2], [1.0; 2], 0.99);
        for pair in numbers.windows(3) {
            let _ = line.update(pair[0], delay);
            level.update(pair[0]);
            let _ = servo.update(pair[1], pair[2]);
            let (valve, std) = (servo.dead_zone(), servo.estimate().std());
            prop_assert!(valve.delta().is_finite() && valve.delta() >= 0.0);
            prop_assert!(valve.std() >= 0.0 && std.iter().all(|std| *std >= 0.0));
            let _ = estimator.update(&[pair[0], pair[1]], pair[2]);
            let _ = (level.variance(), estimator.covariance(index, 0), estimator.noise_variance());
        }
    }
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn hours_without_a_movement() {
    // Two hours of exact silence with a short memory: nothing winds up, nothing becomes subnormal
    // or NaN, and what was learnt is held.
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    config.memory = Some(0.2);
    let mut identifier: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
    let prior: [f32; 5] = std::array::from_fn(|j| identifier.estimator().covariance(j, j));
    let mut settled = None;
    for k in 0..7_200_000 {
        let u = if k < 1000 { 0.4 } else { 0.0 };
        let y = if k < 1000 { 0.1 * k as f32 } else { 100.0 };
        let outcome = identifier.update(u, y);
        // The trends of the motion have died away.
        if k == 60_000 {
            settled = Some(identifier.estimator().clone());
        }
        assert!(k < 60_000 || matches!(outcome, Outcome::Held { .. }));
    }
    let estimate = identifier.estimate();
    let (theta, std) = (estimate.theta(), estimate.std());
    assert!(theta.iter().chain(&std).all(|v| v.is_finite()));
    assert!(std[0] > 0.0 && std[2] > 0.0);
    let (estimator, settled) = (identifier.estimator(), settled.unwrap());
    assert_eq!(estimator.theta(), settled.theta());
    // N r Delta / memory where the data have shown a parameter, otherwise the prior: see the head
    // of forgetting.rs.
    let bound = StabilisedForgetting::new([0.0; 5], 1.0 - 0.001 / 0.2).bound();
    // A round has 10 samples.
    let share = 10.0 * 0.001 / 0.2;
    for (j, prior) in prior.iter().enumerate() {
        let p = estimator.covariance(j, j);
        assert!(estimator.diagonal()[j] > 0.0 && p <= 1.01 * bound.max(prior * (1.0 + share)));
        assert_eq!(p, settled.covariance(j, j));
    }
}

#[test]
fn a_bank_survives_too() {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    let mut bank = DelayBank::<Identifier<_, 3, 5, 1, 3>, 4>::try_new(&config, trends, 0).unwrap();
    for value in [0.0, 1.0, f32::NAN, f32::MAX, -1e6, f32::INFINITY, 3.0] {
        let _ = bank.update_inputs([value], value);
        let _ = (bank.best(), bank.margin(), bank.errors());
    }
}
