//! The numbers of a design in other units, and in other times.

extern crate std;

use std::format;
use std::vec::Vec;

use super::*;
use crate::servo::config::Config;
use crate::servo::motion::Travel;

/// An axis whose settings are stated, with the unit of length so many times as small.
fn stated(length: f32, sample_time: f32) -> Config {
    let travel = Travel {
        min: -100.0 * length,
        max: 300.0 * length,
    };
    let mut config = Config::new(sample_time, 20.0, travel);
    config.noise = Some(0.02 * length);
    config.controller.rest_window = Some(0.1 * length);
    config.supervision.error_deadband = Some(0.3 * length);
    config.supervision.min_speed = Some(5.0 * length);
    config.supervision.min_travel = Some(2.0 * length);
    config.supervision.max_gain = Some(9000.0 * length);
    config
}

fn design(config: &Config) -> Design {
    let length = config.travel.length() / 400.0;
    let mut design = match config.resolve() {
        Ok(design) => design,
        Err(error) => panic!("{error}"),
    };
    design.controller = design.controller.with_resolution(0.005 * length);
    design.monitoring = design.monitoring.with_resolution(0.005 * length);
    design
}

/// The numbers of a design with the names of their fields.
fn numbers(design: &Design) -> Vec<(std::string::String, f32)> {
    let text = format!("{design:?}");
    let mut found = Vec::new();
    let mut name = "";
    for word in text.split([' ', ',', '{', '}', '(', ')', '[', ']']) {
        if let Some(field) = word.strip_suffix(':') {
            name = field;
        } else if let Ok(number) = word.parse::<f32>() {
            found.push((name.into(), number));
        }
    }
    found
}

#[test]
fn every_length_of_a_design_scales_with_the_unit_and_nothing_else_does() {
    for minimal in [false, true] {
        let of = |length: f32| {
            let mut config = stated(length, 1e-3);
            if minimal {
                config = Config::new(1e-3, 20.0, config.travel);
            }
            numbers(&design(&config))
        };
        let (one, eight) = (of(1.0), of(8.0));
        assert!(one.len() > 60, "{}", one.len());
        let mut scaled = 0;
        for ((name, a), (_, b)) in one.iter().zip(&eight) {
            let same = a == b || (a - b).abs() <= 1e-5 * a.abs();
            let length = (8.0 * a - b).abs() <= 1e-5 * b.abs();
            assert!(same || length, "{name}: {a} {b}");
            scaled += u32::from(length && !same);
        }
        assert!(scaled >= 20, "{scaled}");
    }
}

#[test]
fn the_lag_of_a_quicker_axis_is_shorter() {
    let lag = |bandwidth: f32| {
        let travel = stated(1.0, 1e-3).travel;
        design(&Config::new(1e-3, bandwidth, travel))
            .supervision
            .lag
    };
    assert!((lag(20.0) / lag(40.0) - 2.0).abs() < 1e-4);
}

#[test]
fn shares_of_a_sample_and_numbers_of_samples_follow_the_sample_time() {
    let (slow, quick) = (design(&stated(1.0, 1e-3)), design(&stated(1.0, 2.5e-4)));
    let (a, b) = (&slow.monitoring, &quick.monitoring);
    for (slow, quick) in [
        (a.residual_share, b.residual_share),
        (a.gap_share, b.gap_share),
        (
            slow.supervision.peak_error_leak,
            quick.supervision.peak_error_leak,
        ),
        (
            slow.supervision.change.fast_share,
            quick.supervision.change.fast_share,
        ),
        (
            slow.supervision.change.slow_share,
            quick.supervision.change.slow_share,
        ),
        (slow.monitor.share, quick.monitor.share),
        (slow.limiter.step, quick.limiter.step),
        (slow.controller.fade, quick.controller.fade),
        (
            slow.controller.transition_step,
            quick.controller.transition_step,
        ),
    ] {
        assert!((slow / quick - 4.0).abs() < 1e-3, "{slow} {quick}");
    }
    for (slow, quick) in [
        (a.jump, b.jump),
        (a.least_run, b.least_run),
        (a.cycle_pause, b.cycle_pause),
        (a.cycle_settling, b.cycle_settling),
        (
            slow.supervision.validation.window,
            quick.supervision.validation.window,
        ),
        (
            slow.supervision.validation.observe,
            quick.supervision.validation.observe,
        ),
        (slow.supervision.excite, quick.supervision.excite),
        (slow.supervision.still, quick.supervision.still),
        (slow.sensor_errors, quick.sensor_errors),
        (slow.identification.settled, quick.identification.settled),
    ] {
        assert!((4 * slow).abs_diff(quick) <= 3, "{slow} {quick}");
    }
    assert_eq!(4 * a.delay_samples, b.delay_samples);
    // The filter of the measured motion is as quick as its sampling allows: its lag falls with it.
    assert!(b.tracking_lag <= a.tracking_lag);
}

#[test]
fn what_noise_and_codes_do_adds_up() {
    let mut config = stated(1.0, 1e-3);
    let design = |config: &Config| match config.resolve() {
        Ok(design) => design.monitoring.with_resolution(0.5),
        Err(error) => panic!("{error}"),
    };
    let noisy = design(&config);
    config.noise = Some(0.04);
    let twice = design(&config);
    // Eight deviations and two codes; sixteen and ten; of a half wave also twice the window.
    assert!((noisy.grain - (0.16 + 1.0)).abs() < 1e-6);
    assert!((twice.grain - (0.32 + 1.0)).abs() < 1e-6);
    assert!((noisy.many_codes - (0.32 + 5.0)).abs() < 1e-6);
    assert!((noisy.cycle - (0.16 + 0.2 + 1.0)).abs() < 1e-6);
    assert_eq!(
        (noisy.noise, noisy.resolution, noisy.error),
        (0.02, 0.5, 0.3)
    );
    // The full command is one within a fiftieth of the range.
    config.range = 0.5;
    assert!((design(&config).full - 0.49).abs() < 1e-6);
    // What a drive of this bandwidth can give: a quarter of L w^2. The lag of three poles.
    assert!((noisy.acceleration - 0.25 * 400.0 * 400.0).abs() < 1.0);
    config.delay = 3.4e-3;
    assert_eq!(design(&config).delay_samples, 3);
    config.delay = 3.6e-3;
    assert_eq!(design(&config).delay_samples, 4);
    // A variance of a candidate is the square of its deviation, a frequency that of its factor.
    config.supervision.max_relative_std_adapting = 0.3;
    config.supervision.frequency_factor = 5.0;
    let Ok(resolved) = config.resolve() else {
        panic!("a setting is refused");
    };
    let screening = resolved.supervision.screening;
    assert!((screening.max_variance_adapting - 0.09).abs() < 1e-6);
    assert_eq!(
        (screening.factor_squared, screening.frequency_squared),
        (25.0, 400.0)
    );
    assert_eq!((screening.max_gain, screening.min_gain), (9000.0, 5.0));
    config.min_excitation = 0.05;
    let Ok(resolved) = config.resolve() else {
        panic!("a setting is refused");
    };
    assert!((resolved.monitor.min_power - 0.0025).abs() < 1e-7);
}

#[test]
fn an_acceleration_that_is_not_of_this_unit_is_refused() {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    // 1e8 of it: 500 rad/s on 400.
    for (bandwidth, refused) in [(20.0, false), (499.0, false), (501.0, true), (800.0, true)] {
        let resolved = Config::new(1e-4, bandwidth, travel).resolve();
        let found = matches!(
            resolved,
            Err(crate::servo::Error::Unit { acceleration, limit: 1e8 }) if acceleration > 1e8
        );
        assert_eq!(found, refused, "{bandwidth}");
    }
}

#[test]
fn a_stiff_axis_of_any_length_is_one_in_millimetres() {
    // Up to the largest natural frequency that a commissioning looks for, 300 rad/s.
    for (frequency, lengths) in [(300.0, [100.0, 1600.0]), (130.0, [800.0, 8000.0])] {
        for max in lengths {
            let config = Config::minimal(5e-4, Travel { min: 0.0, max });
            let model = crate::servo::Model::linear(frequency * frequency, 30.0, 1e7);
            let found = crate::servo::commissioning::Found {
                model,
                delay: 2e-3,
                sign: 1.0,
                noise: 0.005,
                dead_volume: 0.06,
                imbalance: 0.0,
            };
            let resolved = crate::servo::building::tuned(&config, &found).resolve();
            assert!(resolved.is_ok(), "{frequency} {max}: {resolved:?}");
        }
    }
}

#[test]
fn what_a_grain_makes_of_a_simulation_is_its_velocity_over_the_window() {
    let config = stated(1.0, 1e-3);
    let design = match config.resolve() {
        Ok(design) => design.supervision,
        Err(error) => panic!("{error}"),
    };
    let (rate, noise) = (design.validation.observer.rate, 0.02);
    let window = design.validation.window as f32 * config.sample_time;
    // A ramp of rate times grain, one code and two deviations: its root mean square.
    for resolution in [0.0, 0.5] {
        let grain = resolution + 2.0 * noise;
        let exact = grain * rate * window / 3.0_f32.sqrt();
        let drift = design.clone().with_resolution(resolution).drift;
        assert!((drift / exact - 1.0).abs() < 0.01, "{drift}, not {exact}");
    }
}

#[test]
fn a_transition_within_a_sample_leaves_nothing_of_a_change_and_no_more() {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    for (transition, fade) in [(0.01, 0.1), (1e-3, 1.0), (4e-4, 1.0), (1e-30, 1.0)] {
        let mut config = Config::new(1e-3, 25.0, travel);
        config.controller.transition = transition;
        let design = config.resolve().expect("settings");
        assert!((design.controller.fade - fade).abs() < 1e-6, "{transition}");
    }
}

#[test]
fn an_axis_of_which_no_dead_volume_is_stated_is_as_stiff_at_its_ends_as_the_settings_say() {
    let mut config = stated(1.0, 1e-3);
    let volumes = |config: &Config| {
        let controller = design(config).controller;
        [
            controller.tuning.dead_volume,
            controller.estimator.dead_volume,
        ]
    };
    assert_eq!(volumes(&config), [0.06; 2]);
    config.controller.dead_volume = Some(0.2);
    assert_eq!(volumes(&config), [0.2; 2]);
}
