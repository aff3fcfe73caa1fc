//! The bound of the covariance, attacked: any configuration that is accepted, any signals.

use proptest::prelude::*;
use rand::RngExt;
use trendid::estimation::{Estimator, StabilisedForgetting};
use trendid::trends::{
    ExactTrends, FilteredTrends, IntegralTrends, RawTrends, Scheme, TrendOperator,
};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::signals::noise::{Stream, generator};

const DT: f32 = 1e-3;

/// What is fed in for a while.
#[derive(Clone, Copy, Debug)]
enum Signal {
    Rest,
    Constant,
    Binary,
    Ramp,
    Noise,
    Spikes,
    Blocked,
}

/// Any memory, bandwidth, noise and prior that a configuration accepts, and what is fed in.
#[derive(Clone, Copy, Debug)]
struct Setting {
    samples: f32,
    angle: f32,
    noise: f32,
    prior: Option<f32>,
    signals: [Signal; 4],
    /// Whether changes of the drive are followed, and the drive changes half way.
    follows: bool,
    seed: u64,
}

fn setting() -> impl Strategy<Value = Setting> {
    let logarithmic =
        |from: f32, to: f32| (from.ln()..to.ln()).prop_map(f32::exp as fn(f32) -> f32);
    let signal = || {
        prop::sample::select(vec![
            Signal::Rest,
            Signal::Constant,
            Signal::Binary,
            Signal::Ramp,
            Signal::Noise,
            Signal::Spikes,
            Signal::Blocked,
        ])
    };
    (
        logarithmic(3.0, 1e6),
        logarithmic(1.1e-4, 0.9),
        logarithmic(1e-6, 1.0),
        prop::option::of(logarithmic(1e-3, 1e3)),
        [signal(), signal(), signal(), signal()],
        any::<bool>(),
        any::<u64>(),
    )
        .prop_map(
            |(samples, angle, noise, prior, signals, follows, seed)| Setting {
                samples,
                angle,
                noise,
                prior,
                signals,
                follows,
                seed,
            },
        )
}

fn attack<T: TrendOperator<M>, const M: usize, const N: usize>(
    setting: &Setting,
    structure: Structure<M, N, 1>,
    trends: T,
) -> Result<(), TestCaseError> {
    let mut config = Config::new(structure, setting.angle / DT, [1.0], 1.0);
    config.memory = Some(setting.samples * DT);
    config.output_noise = setting.noise;
    config.prior_std = setting.prior.map(|std| [std; N]);
    config.follow_changes = setting.follows;
    let mut identifier: Identifier<T, M, N> = match Identifier::try_new(&config, trends) {
        Ok(identifier) => identifier,
        Err(_) => return Ok(()),
    };
    let prior: [f32; N] = std::array::from_fn(|j| identifier.estimator().covariance(j, j));
    let forgetting = 1.0 - 1.0 / setting.samples;
    let bound = StabilisedForgetting::new([0.0; N], forgetting).bound();
    let growth = forgetting.powi(-2 * N as i32);
    let mut random = generator(setting.seed, Stream::White);
    let (mut y, mut speed) = (0.0_f32, 0.0_f32);
    let (mut changes, mut opened) = (0, 0);
    for k in 0..4000 {
        let mut number = || 2.0 * random.random::<f32>() - 1.0;
        let sign = if (k / 37) % 2 == 0 { 1.0 } else { -1.0 };
        let (u, moves) = match setting.signals[k / 1000] {
            Signal::Rest => (0.0, true),
            Signal::Constant => (0.7, true),
            Signal::Binary => (sign, true),
            Signal::Ramp => {
                speed = 1.0;
                (0.0, true)
            }
            Signal::Noise => (number(), true),
            Signal::Spikes => (sign, true),
            Signal::Blocked => (0.3, false),
        };
        if moves {
            let gain = match setting.follows && k >= 2000 {
                true => 0.4,
                false => 1.0,
            };
            speed += setting.angle * (gain * u - speed);
            y += setting.angle * speed;
        }
        let spike = matches!(setting.signals[k / 1000], Signal::Spikes) && k % 83 == 0;
        let measured = y + 0.1 * setting.noise * number() + if spike { 1e3 } else { 0.0 };
        let _ = identifier.update(u, measured);
        if identifier.changes() > changes {
            (changes, opened) = (identifier.changes(), k);
        }
        // Of N samples behind a change each brings one parameter below the bound.
        if k % 50 == 49 && (opened == 0 || k > opened + N) {
            let limits = prior.map(|prior| bound.max(prior * growth));
            bounded(identifier.estimator(), &limits, k)?;
        }
    }
    Ok(())
}

/// Theta finite, D > 0 and every P_ii below its limit in sample k.
fn bounded<const N: usize>(
    estimator: &Estimator<N>,
    limits: &[f32; N],
    k: usize,
) -> Result<(), TestCaseError> {
    prop_assert!(
        estimator.theta().iter().all(|t| t.is_finite()),
        "theta {:?}",
        estimator.theta()
    );
    for (j, limit) in limits.iter().enumerate() {
        let p = estimator.covariance(j, j);
        prop_assert!(
            estimator.diagonal()[j] > 0.0,
            "D {:?}",
            estimator.diagonal()
        );
        prop_assert!(p <= 1.02 * limit, "P_{j}{j} {p} of {limit}, sample {k}");
    }
    Ok(())
}

/// Every operator with this structure.
fn operators<const M: usize, const N: usize>(
    setting: &Setting,
    structure: Structure<M, N, 1>,
) -> Result<(), TestCaseError> {
    let bandwidth = setting.angle / DT;
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        if let Ok(trends) = FilteredTrends::for_bandwidth(scheme, DT, bandwidth) {
            attack(setting, structure, trends)?;
        }
        if let Ok(trends) = RawTrends::try_new(scheme, DT) {
            attack(setting, structure, trends)?;
        }
    }
    if let Ok(trends) = ExactTrends::for_bandwidth(DT, bandwidth) {
        attack(setting, structure, trends)?;
    }
    if let Ok(trends) = IntegralTrends::<M, 8>::try_new(Scheme::Tustin, DT) {
        attack(setting, structure, trends)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    /// D > 0, P_ii below its bound and theta finite for whatever a configuration accepts; where
    /// changes are followed, from N samples behind each on.
    #[test]
    fn the_bound_holds_for_every_configuration(setting in setting()) {
        operators(&setting, Structure::<1, 2, 1>::FULL)?;
        operators(&setting, Structure::<2, 2, 1>::INTEGRATING)?;
        operators(&setting, Structure::<2, 4, 1>::FULL)?;
        operators(&setting, Structure::<3, 3, 1>::INTEGRATING)?;
        operators(&setting, Structure::<3, 5, 1>::SERVO)?;
        operators(&setting, Structure::<4, 8, 1>::FULL)?;
    }
}
