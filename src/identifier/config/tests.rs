//! Each setting at both ends of its range.

use super::*;

type Servo = Config<3, 3, 1>;

/// Whether a change of the defaults is accepted, at 1 kHz and with delay lines of four samples.
fn accepted(change: impl FnOnce(&mut Servo)) -> bool {
    let mut config = Servo::new(Structure::INTEGRATING, 20.0, [0.4], 50.0);
    change(&mut config);
    config.check(1e-3, 4).is_ok()
}

/// A setting is good from `low` to `high`, and neither below nor above nor without a number.
fn within([low, high]: [f32; 2], set: impl Fn(&mut Servo, f32)) {
    for (value, good) in [
        (1.001 * low, true),
        (0.999 * high, true),
        (0.999 * low - 1e-30, false),
        (1.001 * high, false),
        (f32::NAN, false),
        (f32::INFINITY, false),
    ] {
        assert_eq!(accepted(|config| set(config, value)), good, "{value}");
    }
}

#[test]
fn every_setting_has_its_range() {
    within([0.1, 1000.0], |config, value| config.bandwidth = value);
    // The limits themselves, however they are rounded.
    for value in [0.1, 1000.0] {
        assert!(accepted(|config| config.bandwidth = value), "{value}");
    }
    within([1e-9, 1e9], |config, value| {
        (config.output_range, config.output_noise) = (value, 1e-3 * value);
    });
    within([1e-9, 1e9], |config, value| config.input_range = [value]);
    // 10^-7 and ten times a movement of 50.
    within([5e-6, 500.0], |config, value| config.output_noise = value);
    within([6e-3, 1048.576], |config, value| {
        config.memory = Some(value);
    });
    within([0.0, 16_777.216], |config, value| config.settling = value);
    within([0.0, 0.999_999], |config, value| {
        config.delay_parts = [value];
    });
    for (value, good) in [
        (0.0, true),
        (1e30, true),
        (-1e-30, false),
        (f32::NAN, false),
    ] {
        assert_eq!(accepted(|c| c.offset_significance = value), good);
        assert_eq!(accepted(|c| c.prior_std = Some([1.0, value, 1.0])), good);
    }
    for (value, good) in [(-1e30, true), (f32::NAN, false), (f32::INFINITY, false)] {
        assert_eq!(accepted(|c| c.initial[2] = value), good);
    }
    for (input, good) in [(0, true), (1, false)] {
        assert_eq!(accepted(|c| c.friction_input = Some(input)), good);
    }
}

#[test]
fn a_delay_fits_its_line_and_one_between_samples_takes_one_more() {
    for (delay, part, good) in [
        (4, 0.0, true),
        (5, 0.0, false),
        (3, 0.5, true),
        (4, 0.5, false),
    ] {
        let set = |config: &mut Servo| (config.delays, config.delay_parts) = ([delay], [part]);
        assert_eq!(accepted(set), good, "{delay} {part}");
        let set = |config: &mut Servo| config.set_delay(0, delay as f32 + part);
        assert_eq!(accepted(set), good, "{delay} {part}");
    }
    let mut config = Servo::new(Structure::INTEGRATING, 20.0, [0.4], 50.0);
    config.set_delay(0, 3.25);
    assert_eq!((config.delays, config.delay_parts), ([3], [0.25]));
    // An input that does not exist.
    config.set_delay(1, 1.5);
    assert_eq!((config.delays, config.delay_parts), ([3], [0.25]));
}

#[test]
fn a_memory_holds_as_many_samples_as_the_bound_of_the_covariance_needs() {
    assert_eq!(shortest_memory::<1>(), 3.0);
    assert_eq!(shortest_memory::<2>(), 3.0);
    assert_eq!(shortest_memory::<3>(), 6.0);
    assert_eq!(shortest_memory::<6>(), 30.0);
}

#[test]
fn what_is_wrong_is_named() {
    let mut config = Servo::new(Structure::INTEGRATING, 20.0, [0.4], 50.0);
    config.memory = Some(1e-3);
    let Err(ConfigError::OutOfRange { setting, value, .. }) = config.check(1e-3, 0) else {
        panic!("accepted");
    };
    assert_eq!((setting, value), ("memory".into(), 1e-3));
    for sample_time in [0.0, -1e-3, f32::NAN] {
        assert!(config.check(sample_time, 0).is_err());
    }
}
