//! Properties of the core that hold for any record.

use proptest::prelude::*;
use trendid::estimation::{Estimator, StabilisedForgetting, Terms};
use trendid::identifier::Refusal;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Identifier, Outcome, Structure, structure};

type Servo = Identifier<FilteredTrends<3>, 3, 3>;

fn servo(memory: Option<f32>, units: (f32, f32)) -> Servo {
    let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 3]).unwrap();
    let mut config = Config::new(
        Structure::<3, 3, 1>::INTEGRATING,
        20.0,
        [units.0],
        50.0 * units.1,
    );
    config.memory = memory;
    Identifier::try_new(&config, trends).unwrap()
}

/// A command of random holds and levels, and a position that a drive makes of it, in steps of 50
/// us.
///
/// A coarser drive contradicts the model where it turns: whether that passes for standstill depends
/// on how much noise was seen before.
pub(crate) fn record() -> impl Strategy<Value = Vec<(f32, f32)>> {
    (
        prop::collection::vec((-1.0_f32..1.0, 20_usize..60), 10..20),
        prop::collection::vec(-0.01_f32..0.01, 1200),
    )
        .prop_map(|(levels, noise)| {
            let (mut x, mut v, mut a) = (0.0_f64, 0.0_f64, 0.0_f64);
            let mut record = Vec::new();
            for (level, hold) in levels {
                for _ in 0..hold {
                    let n = f64::from(noise[record.len() % noise.len()]);
                    record.push((level, (x + n) as f32));
                    for _ in 0..20 {
                        let (dt, jerk) = (5e-5, 1e6 * f64::from(level) - 20.0 * a - 400.0 * v);
                        x += dt * (v + 0.5 * dt * a);
                        v += dt * (a + 0.5 * dt * jerk);
                        a += dt * jerk;
                    }
                }
            }
            record
        })
}

fn run(identifier: &mut Servo, record: &[(f32, f32)]) {
    for (u, y) in record {
        let _ = identifier.update(*u, *y);
    }
}

fn close(a: &[f32], b: &[f32], relative: f32) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| (a - b).abs() <= relative * (a.abs() + b.abs()))
}

/// Samples in which the slow pole forgets where y began: a hundred of its time constants.
const FORGOTTEN: usize = 4000;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Measuring in other units gives the same model in other units. The scales are powers of two,
    /// so to the last bit.
    #[test]
    fn scaling_the_units_scales_theta(record in record()) {
        let mut plain = servo(Some(0.5), (1.0, 1.0));
        run(&mut plain, &record);
        let scaled: Vec<_> = record.iter().map(|(u, y)| (4.0 * u, 0.125 * y)).collect();
        let mut other = servo(Some(0.5), (4.0, 0.125));
        run(&mut other, &scaled);
        let (a, b) = (plain.theta(), other.theta());
        prop_assert_eq!(a[0], b[0]);
        prop_assert_eq!(a[1], b[1]);
        prop_assert_eq!(a[2] * 0.125 / 4.0, b[2]);
    }

    /// What happened before the drive moved does not matter: longer rest in front of the record
    /// changes no bit of the recursion, once it has shown where y began. What is read subtracts a
    /// bias of the noise, whose mean is of all samples and so of the rest too, and what the noise
    /// of the first one does, of which a rest tells until the filter has forgotten it.
    #[test]
    fn a_shift_in_time_changes_nothing(record in record(), rest in 1_usize..500) {
        let first = record[0].1;
        let behind = |samples: usize| {
            let mut identifier = servo(None, (1.0, 1.0));
            run(&mut identifier, &vec![(0.0, first); samples]);
            run(&mut identifier, &record);
            identifier
        };
        let (plain, late) = (behind(10), behind(10 + rest));
        prop_assert_eq!(plain.estimator().theta(), late.estimator().theta());
        let (plain, late) = (behind(FORGOTTEN), behind(FORGOTTEN + rest));
        prop_assert_eq!(plain.estimator().theta(), late.estimator().theta());
        let std = plain.estimate().std();
        for ((a, b), std) in plain.theta().into_iter().zip(late.theta()).zip(std) {
            prop_assert!((a - b).abs() <= 0.01 * std, "{} {}, sigma {}", a, b, std);
        }
    }

    /// A shift of the position by a whole number changes nothing behind an integrator but rounding.
    #[test]
    fn a_shift_of_the_origin_changes_nothing(record in record()) {
        let mut plain = servo(None, (1.0, 1.0));
        let mut shifted = plain.clone();
        run(&mut plain, &record);
        let moved: Vec<_> = record.iter().map(|(u, y)| (*u, y + 64.0)).collect();
        run(&mut shifted, &moved);
        prop_assert!(close(&plain.theta(), &shifted.theta(), 1e-3),
            "{:?} {:?}", plain.theta(), shifted.theta());
    }

    /// The factors D stay positive, with forgetting, at rest and behind any numbers.
    #[test]
    fn the_covariance_stays_positive(
        rows in prop::collection::vec((prop::array::uniform4(-1e3_f32..1e3), -1e3_f32..1e3), 1..400),
        forgetting in 0.95_f32..1.0,
    ) {
        let mut estimator = Estimator::<4>::new([0.0; 4], [1e3; 4], forgetting);
        let mut stabilised = StabilisedForgetting::new([0.0; 4], forgetting);
        for (phi, psi) in &rows {
            let _ = estimator.update(phi, *psi);
            stabilised.apply(&mut estimator);
            prop_assert!(estimator.diagonal().iter().all(|d| *d > 0.0 && d.is_finite()));
            prop_assert!(estimator.theta().iter().all(|t| t.is_finite()));
        }
    }

    /// Whatever a refused sample held, the state after it is the same.
    #[test]
    fn the_value_of_a_refused_sample_enters_no_buffer(
        record in record(),
        bad in prop::sample::select(vec![f32::INFINITY, f32::NEG_INFINITY, 1e30]),
        at_output in any::<bool>(),
    ) {
        let mut identifier = servo(Some(0.5), (1.0, 1.0));
        run(&mut identifier, &record);
        let mut other = identifier.clone();
        let mut skipped = identifier.clone();
        let (expected, last) = if at_output { (Refusal::Output, 0.1) } else { (Refusal::Input(0), f32::NAN) };
        for (identifier, bad) in [(&mut identifier, bad), (&mut other, f32::NAN)] {
            let outcome = if at_output { identifier.update(last, bad) } else { identifier.update(bad, 0.1) };
            prop_assert_eq!(outcome, Outcome::Refused(expected));
        }
        // The debug text holds every field with the shortest digits that identify the bits.
        prop_assert_eq!(format!("{other:?}"), format!("{identifier:?}"));
        prop_assert_eq!(identifier.replaced(), skipped.replaced() + 1);
        // Its time passes as that of a sample that never came.
        skipped.skip(1);
        if !at_output {
            prop_assert_eq!(format!("{skipped:?}"), format!("{identifier:?}"));
        }
    }

    /// A known parameter (prior 0) changes no other number: the same bits as the smaller model.
    #[test]
    fn a_known_parameter_is_as_if_absent(record in record()) {
        let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 3]).unwrap();
        let large: Structure<3, 5, 1> = structure!(Terms::between(1, 3), [Terms::up_to(3)], false);
        let mut config = Config::new(large, 20.0, [1.0], 50.0);
        let small = servo(None, (1.0, 1.0));
        config.prior_std = Some([1e5, 1e3, 1e8, 0.0, 0.0]);
        let mut padded: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
        let mut plain = small;
        plain.warm_start([0.0; 3], [1e5, 1e3, 1e8]).unwrap();
        run(&mut plain, &record);
        for (u, y) in &record {
            let _ = padded.update(*u, *y);
        }
        let theta = padded.theta();
        prop_assert_eq!(plain.theta(), [theta[0], theta[1], theta[2]]);
    }
}

#[test]
fn reset_and_warm_start() {
    let fresh = servo(Some(0.5), (1.0, 1.0));
    let mut identifier = fresh.clone();
    for k in 0..500 {
        let _ = identifier.update(if k % 80 < 40 { 1.0 } else { -1.0 }, 0.01 * k as f32);
    }
    identifier.reset();
    assert_eq!(identifier.theta(), fresh.theta());
    assert_eq!(identifier.prediction_error(), fresh.prediction_error());
    identifier
        .warm_start([400.0, 20.0, 1e6], [40.0, 2.0, 1e5])
        .unwrap();
    assert!(close(&identifier.theta(), &[400.0, 20.0, 1e6], 1e-6));
    assert!(close(&identifier.estimate().std(), &[40.0, 2.0, 1e5], 1e-5));
    let kept = identifier.clone();
    let refused = identifier.warm_start([400.0, f32::NAN, 1e6], [1.0; 3]);
    assert!(matches!(
        refused,
        Err(ConfigError::NotFinite { setting, .. }) if setting == ("initial", 1).into()
    ));
    assert_eq!(kept.theta(), identifier.theta());
}
