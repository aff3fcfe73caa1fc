//! A start whose first sample is wrong, of a structure with an initial state.

use crate::Structure;
use crate::identifier::tests::bench::Drive;
use crate::identifier::{Config, Identifier};
use crate::math::matrix::dot;
use crate::trends::{FilteredTrends, Scheme};

type Servo = Identifier<FilteredTrends<3>, 3, 5>;

/// The servo after so many samples, y(0) off by `error`; known to have no offset.
fn servo(error: f32, samples: u32, memory: Option<f32>) -> Servo {
    measured(1e-6, error, samples, memory, true)
}

/// The same with a sensor of this resolution, and perhaps an offset.
fn measured(step: f32, error: f32, samples: u32, memory: Option<f32>, centred: bool) -> Servo {
    let mut config = Config::new(Structure::SERVO, 20.0, [0.4], 50.0);
    (config.output_noise, config.memory) = (1e-4, memory);
    // A constant that is withdrawn is another estimate.
    config.offset_significance = 0.0;
    config.known[3] = centred;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0);
    let mut found = Servo::try_new(&config, trends.expect("a filter")).expect("settings");
    let mut drive = Drive::new(step);
    for k in 0..samples {
        let [u, y] = drive.sample(k);
        let _ = found.update(u, if k == 0 { y + error } else { y });
    }
    found
}

/// By how much an error of 1 moves the bare estimate, normalised.
fn predicted(of: &Servo) -> [f32; 5] {
    let (read, p) = (of.read_out(), of.estimator().covariances());
    let a = read.structure.denominator(&of.recursion().theta());
    let score = read.start_error.score(&a);
    core::array::from_fn(|i| dot(&p[i], &score) * read.regressor.top_scale())
}

#[test]
fn an_error_of_the_first_sample_moves_the_estimate_as_predicted() {
    const ERROR: f32 = 1e-3;
    for (memory, share) in [(None, 0.2), (Some(2.0), 0.2), (Some(0.5), 0.25)] {
        for samples in [300, 500, 1000] {
            let both = [ERROR, -ERROR].map(|error| servo(error, samples, memory));
            let [above, below] = both.each_ref().map(|of| *of.estimator().theta());
            let direction = predicted(&both[0]);
            for i in 0..3 {
                let found = (above[i] - below[i]) / (2.0 * ERROR);
                let off = (direction[i] / found - 1.0).abs();
                assert!(
                    off < share,
                    "{memory:?} {samples} {i}: {found} {direction:?}"
                );
            }
        }
    }
}

#[test]
fn what_it_may_have_done_is_in_the_deviations_and_is_forgotten() {
    // The deviation of a_1 with what is known of the beginning over that without.
    let widened = |of: &Servo| {
        let read = of.read_out();
        let mut certain = *read.start_error;
        certain.variance = 0.0;
        let without = crate::readout::ReadOut {
            start_error: &certain,
            ..of.read_out()
        };
        read.estimate().std()[0] / without.estimate().std()[0]
    };
    let found = widened(&measured(0.02, 0.0, 300, None, false));
    assert!(found > 1.005, "{found}");
    let (lasting, forgotten) = (servo(0.0, 3000, None), servo(0.0, 9000, Some(0.5)));
    assert!(!lasting.state.start_error.lasts && !forgotten.state.start_error.lasts);
    assert_eq!(forgotten.state.start_error.score(&[1.0; 3]), [0.0; 5]);
    assert!(lasting.state.start_error.score(&[1.0; 3]) != [0.0; 5]);
    assert_eq!(widened(&forgotten), 1.0);
}

#[test]
fn where_the_trends_begin_anew_nothing_is_summed_any_more() {
    let ends: [fn(&mut Servo); 3] = [
        |servo| servo.restart_trends(),
        |servo| servo.skip(2),
        |servo| {
            let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 30.0);
            servo
                .retune(trends.expect("a filter"), 0.1)
                .expect("a filter");
        },
    ];
    for (i, end) in ends.into_iter().enumerate() {
        let mut of = servo(0.0, 200, None);
        let before = of.state.start_error.score(&[400.0, 20.0, 1.0]);
        end(&mut of);
        let mut drive = Drive::new(1e-6);
        for k in 0..1000 {
            let [u, y] = drive.sample(k);
            let _ = of.update(u, y);
        }
        let after = of.state.start_error.score(&[400.0, 20.0, 1.0]);
        // A retuned estimate counts less, and its error stays: so does the score with P.
        let share = after[0] / before[0];
        let kept = match i {
            0 => share == 1.0,
            // What is not known yet begins anew as well.
            1 => share == 0.0,
            _ => share > 0.0 && share < 1.0,
        };
        assert!(
            kept && !of.state.start_error.lasts,
            "{i}: {before:?} {after:?}"
        );
    }
}

#[test]
fn a_loop_that_tests_its_models_and_raw_trends_sum_nothing() {
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    config.supervised = true;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0);
    let servo = Servo::try_new(&config, trends.expect("a filter")).expect("settings");
    assert!(!servo.state.start_error.lasts);
    config.supervised = false;
    let trends = crate::trends::RawTrends::try_new(Scheme::Tustin, 1e-3).expect("trends");
    let raw: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).expect("settings");
    assert!(!raw.state.start_error.lasts);
}
