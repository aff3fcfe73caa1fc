//! The identifier as a whole, on what single parts do not show.

use super::*;
use crate::trends::{FilteredTrends, Hold, Scheme};

mod anew;
mod beginning;
pub(super) mod bench;
mod start_error;

use bench::{Drive, Servo3, config, identifier};

#[test]
fn settings_for_another_structure_are_the_same_but_for_its_parameters() {
    let mut small = config();
    small.output_noise = 0.07;
    small.holds = [Hold::First];
    small.delays = [3];
    small.delay_parts = [0.25];
    small.initial_input = [0.1];
    small.memory = Some(2.5);
    small.follow_changes = true;
    small.friction_input = Some(0);
    small.settling = 0.3;
    small.offset_significance = 1.5;
    small.initial = [1.0; 3];
    small.prior_std = Some([2.0; 3]);
    small.known = [true; 3];
    let large = small.with_structure(Structure::<3, 5, 1>::SERVO);
    let back = large.with_structure(Structure::<3, 3, 1>::INTEGRATING);
    let mut expected = small;
    (expected.initial, expected.prior_std, expected.known) = ([0.0; 3], None, [false; 3]);
    assert_eq!(back, expected);
}

#[test]
fn the_noise_is_found_in_the_unit_of_the_position() {
    let mut identifier = identifier(&config());
    assert_eq!(identifier.noise_std(), None);
    let mut drive = Drive::new(1e-4);
    for k in 0..20_000 {
        let [u, y] = drive.sample(k);
        // Uniform noise of 0.1.
        let noise = 0.1 * libm::sqrtf(3.0) * drive.draw();
        let _ = identifier.update(u, y + noise);
    }
    let found = identifier.noise_std().expect("noise");
    assert!((found / 0.1 - 1.0).abs() < 0.05, "{found}");
}

#[test]
fn where_a_position_is_resolved_worse_than_its_noise_a_row_counts_for_less() {
    // Positions in halves, which f32 has up to 2^23: the same motion near zero and far away.
    let near = 0.0;
    let far = 4_194_304.0_f32;
    for memory in [None, Some(100.0)] {
        let found = |origin: f32| {
            let mut config = config();
            config.memory = memory;
            let mut identifier = identifier(&config);
            let mut drive = Drive::new(0.5);
            for k in 0..4000 {
                let [u, y] = drive.sample(k);
                let _ = identifier.update(u, origin + 4.0 * y);
            }
            (
                identifier.estimator().covariance(2, 2),
                identifier.estimate().theta()[2],
            )
        };
        // Beyond the noise of 0.05 times 2^24 a row counts by their ratio.
        let share = far / (0.05 * 16_777_216.0);
        let ((there, b0), (here, expected)) = (found(far), found(near));
        let ratio = there / here;
        assert!(
            (ratio / (share * share) - 1.0).abs() < 0.1,
            "{memory:?}: {ratio}"
        );
        assert!(
            (b0 / expected - 1.0).abs() < 0.05,
            "{memory:?}: {b0} {expected}"
        );
    }
}

#[test]
fn a_gap_is_bridged_for_five_over_the_bandwidth_and_no_longer() {
    let mut trained = identifier(&config());
    let mut drive = Drive::new(1e-4);
    let mut last = 0.0;
    for k in 0..3000 {
        let [u, y] = drive.sample(k);
        let _ = trained.update(u, y);
        last = y;
    }
    // 5/20 s of 1 ms.
    let longest = trained.plan.times.longest_gap;
    assert!((249..=250).contains(&longest));
    for (gap, bridged) in [(longest - 1, true), (longest, true), (longest + 1, false)] {
        let mut other = trained.clone();
        other.skip(gap);
        let outcome = other.update(drive.u, last);
        let warms = matches!(outcome, Outcome::WarmingUp { .. });
        assert_eq!(!warms, bridged, "{gap}: {outcome:?}");
    }
}

#[test]
fn what_an_input_was_before_the_start_is_within_its_reach() {
    let trends =
        || FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let accepted = |initial: f32| {
        let mut config = config();
        config.initial_input = [initial];
        Servo3::try_new(&config, trends()).is_ok()
    };
    let reach = config::REACH * 0.4;
    for side in [1.0, -1.0] {
        assert!(accepted(side * 0.999 * reach) && !accepted(side * 1.001 * reach));
    }
}

#[test]
fn an_axis_that_was_blocked_begins_from_a_state_that_is_not_known() {
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    config.memory = Some(5.0);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let mut identifier =
        Identifier::<FilteredTrends<3>, 3, 5, 1, 0>::try_new(&config, trends).expect("settings");
    let last = |identifier: &Identifier<FilteredTrends<3>, 3, 5, 1, 0>| {
        identifier.estimator().diagonal()[4]
    };
    let prior = last(&identifier);
    let mut drive = Drive::new(1e-4);
    let mut noise = Drive::new(1e-4);
    for k in 0..8000 {
        let [u, y] = drive.sample(k);
        let _ = identifier.update(u, y + 0.02 * noise.draw());
    }
    assert!(last(&identifier) < 0.5 * prior);
    let [y, ..] = drive.at;
    for _ in 0..300 {
        let _ = identifier.update(0.3, y + 0.02 * noise.draw());
    }
    // It stood against the model for longer than 1/bandwidth, and is let go.
    let mut most = 0.0_f32;
    for k in 0..20 {
        let _ = identifier.update(0.3, y + 0.5 * k as f32 + 0.02 * noise.draw());
        most = most.max(last(&identifier));
    }
    assert!((most / prior - 1.0).abs() < 0.05, "{most} of {prior}");
}

#[test]
fn an_identifier_begins_with_the_prior_that_it_is_given() {
    let mut config = config();
    config.initial = [390.0, 18.0, 9e5];
    config.prior_std = Some([40.0, 3.0, 0.0]);
    let given = identifier(&config).recursion();
    for j in 0..3 {
        assert!((given.theta()[j] / config.initial[j] - 1.0).abs() < 1e-5);
    }
    let std = given.std();
    assert!((std[0] / 40.0 - 1.0).abs() < 1e-4 && (std[1] / 3.0 - 1.0).abs() < 1e-4);
    assert_eq!(std[2], 0.0);
    // Without one: ten times the design size, 20 rad/s and 50 per 0.4; what is known is exact.
    config.prior_std = None;
    config.known = [false, true, false];
    let std = identifier(&config).recursion().std();
    for (j, size) in [(0, 400.0), (2, 8000.0 * 50.0 / 0.4)] {
        assert!((std[j] / (10.0 * size) - 1.0).abs() < 1e-3, "{std:?}");
    }
    assert_eq!(std[1], 0.0);
    // A mean that no number of the recursion reaches is refused, with what there is room for.
    config.initial = [1e30, 18.0, 9e5];
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let Err(ConfigError::OutOfRange { value, limits, .. }) = Servo3::try_new(&config, trends)
    else {
        panic!("accepted");
    };
    let reach = config::REACH * 400.0;
    assert_eq!(value, 1e30);
    assert!((limits[0] / -reach - 1.0).abs() < 1e-4 && (limits[1] / reach - 1.0).abs() < 1e-4);
}

#[test]
fn a_constant_is_small_where_the_drive_integrates() {
    let std_of = |terms: crate::estimation::Terms, constant: f32| {
        let inputs = [crate::estimation::Terms::of(&[0])];
        let structure = Structure::<2, 3, 1>::try_new(terms, inputs, true).expect("a structure");
        let trends = FilteredTrends::<2>::for_bandwidth(Scheme::Tustin, 1e-3, 20.0);
        let config = Config::new(structure, 20.0, [0.4], 50.0);
        let identifier = Identifier::<FilteredTrends<2>, 2, 3, 1, 0>::try_new(
            &config,
            trends.expect("a filter"),
        );
        let std = identifier.expect("settings").recursion().std();
        // 20 rad/s, squared, times 50: the size of the input's effect.
        let found = std[2] / (400.0 * 50.0);
        assert!((found / constant - 1.0).abs() < 1e-2, "{std:?} {found}");
    };
    std_of(crate::estimation::Terms::of(&[1]), 0.3);
    std_of(crate::estimation::Terms::of(&[0]), 10.0);
}

#[test]
fn calls_between_samples_do_what_they_say() {
    let mut config = config();
    config.memory = Some(5.0);
    let mut trained = identifier(&config);
    let mut drive = Drive::new(1e-4);
    let mut y = 0.0;
    for k in 0..2000 {
        let [u, position] = drive.sample(k);
        y = 1000.0 + position;
        let _ = trained.update(u, y);
    }
    assert!((trained.state.position() - y).abs() < 1e-3);
    // The estimate becomes the nominal one.
    let mut other = trained.clone();
    other.set_nominal();
    assert_eq!(other.state.forgetting.nominal(), other.estimator().theta());
    // The signals are forgotten, the estimate is kept.
    let mut other = trained.clone();
    other.restart_trends();
    assert_eq!(other.estimator().theta(), trained.estimator().theta());
    assert!(matches!(other.update(0.0, y), Outcome::WarmingUp { .. }));
    assert!(!matches!(trained.update(0.0, y), Outcome::WarmingUp { .. }));
}
