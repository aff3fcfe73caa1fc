//! Values that cross the line: settings, states, the largest notices.

use trendid::servo::{Config, Travel};
use trendid_link::telemetry::settings::{self, SETTINGS};
use trendid_link::telemetry::*;
use trendid_link::{Frame, code};

use super::ends::sample;

/// Of an axis of 400 mm.
fn config() -> Config {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    Config::new(1e-3, 20.0, travel)
}

#[test]
fn every_setting_is_read_as_it_was_set_and_refuses_what_is_out_of_bounds() {
    let config = config();
    let set = |setting, value| settings::requested(&config, &Request::Set { setting, value });
    for (place, setting) in SETTINGS.iter().enumerate() {
        let number = place as u8;
        let [low, high] = setting.limits;
        let present = settings::get(&config, number).unwrap();
        // Somewhere else within the limits and near a usual value.
        let usual = present.unwrap_or(match setting.name {
            "controller.bandwidth" => 40.0,
            _ => 0.02,
        });
        let value = (1.01 * usual).clamp(low, high);
        let value = if Some(value) == present {
            0.99 * value
        } else {
            value
        };
        let changed = set(number, Some(value))
            .unwrap_or_else(|refusal| panic!("{}: {refusal}", setting.name));
        assert_eq!(
            settings::get(&changed, number),
            Ok(Some(value)),
            "{}",
            setting.name
        );
        assert_ne!(changed, config, "{}", setting.name);
        for wrong in [low - 1.0, 2.0 * high + 1.0, f32::NAN, f32::INFINITY] {
            let refusal = set(number, Some(wrong)).unwrap_err();
            let named =
                matches!(&refusal, Refusal::Value { name, .. } if name.as_str() == setting.name);
            assert!(named, "{}: {refusal:?}", setting.name);
        }
        assert_eq!(set(number, None).is_ok(), setting.follows);
        assert!(setting.name.len() <= 40, "a refusal has room for the name");
    }
    let beyond = SETTINGS.len() as u8;
    assert_eq!(settings::get(&config, beyond), Err(Refusal::Unsupported));
    assert_eq!(set(beyond, Some(1.0)), Err(Refusal::Unsupported));
}

/// Each within its limits, and none that the loop would not take beside the others.
#[test]
fn settings_that_contradict_the_others_are_refused() {
    let config = config();
    let mut contradict = 0;
    for (place, setting) in SETTINGS.iter().enumerate() {
        for value in setting.limits {
            let request = Request::Set {
                setting: place as u8,
                value: Some(value),
            };
            match settings::requested(&config, &request) {
                Ok(changed) => assert!(changed.resolve().is_ok(), "{} = {value}", setting.name),
                Err(_) => contradict += 1,
            }
        }
    }
    assert!(contradict > 0);
}

#[test]
fn limits_of_motion_are_taken_and_refused_as_the_loop_takes_them() {
    let config = config();
    let limits = |velocity| Request::Limits {
        velocity,
        acceleration: 2e3,
        jerk: 1e5,
    };
    let changed = settings::requested(&config, &limits(150.0)).unwrap();
    let motion = changed.motion.unwrap();
    assert_eq!(
        [motion.velocity, motion.acceleration, motion.jerk],
        [150.0, 2e3, 1e5]
    );
    for wrong in [0.0, -1.0, f32::NAN] {
        assert!(settings::requested(&config, &limits(wrong)).is_err());
    }
    let other = settings::requested(&config, &Request::Stop);
    assert_eq!(other, Err(Refusal::Unsupported));
}

#[test]
fn states_and_reasons_survive_the_line() {
    for reason in 0..=u8::MAX {
        match reason_of(reason) {
            Some(found) => {
                assert_eq!(found as u8, reason);
                for state in [6, 7] {
                    let state_back = state_of(state, reason).unwrap();
                    assert_eq!(
                        (state_back.code(), state_back.reason()),
                        (state, Some(found))
                    );
                }
            }
            None => assert!(reason >= 17),
        }
    }
    assert!((0..6).all(|state| state_of(state, code::NO_REASON).unwrap().code() == state));
    assert_eq!(state_of(code::NO_LOOP, code::NO_REASON), None);
}

/// Every notice of the largest numbers fits into a frame.
#[test]
fn the_largest_notices_fit() {
    for content in largest() {
        let frame = Frame::encode(&Notice {
            seq: u16::MAX,
            content: content.clone(),
        });
        assert!(!frame.bytes().is_empty(), "{content:?}");
    }
}

/// A notice of each kind, with the longest numbers and texts.
fn largest() -> [Content; 7] {
    let text = Text::try_from("m".repeat(40).as_str()).unwrap();
    let max = u32::MAX;
    let health = Health {
        tick: max,
        failed_readings: max,
        implausible_readings: max,
        saturated_samples: max,
        oscillations: max,
        stops: max,
        moves_at_rest: max,
        overruns: max,
        longest_us: max,
        dropped: max,
        events_lost: max,
        corrupt: max,
    };
    let learned = Learned {
        tick: max,
        covariance: Some([1.0; 6]),
        expected: Some(1.0),
        counts: [max; 2],
        margins: Some([1.0; 4]),
        ..Learned::default()
    };
    [
        Content::Identity(Identity {
            name: text.clone(),
            unit: "12345678".try_into().unwrap(),
            ..Identity::default()
        }),
        Content::Sample(sample(max)),
        Content::Learned(learned),
        Content::Health(health),
        Content::Event(NumberedEvent {
            start: u16::MAX,
            number: max,
            oldest: max,
            tick: max,
            event: Event::Start {
                cause: text.clone(),
                starts: max,
            },
        }),
        Content::Event(NumberedEvent {
            start: u16::MAX,
            number: max,
            oldest: max,
            tick: max,
            event: Event::Model([1.0; 6]),
        }),
        Content::Answer(Answer {
            id: max,
            outcome: Outcome::Refused(Refusal::Value {
                name: text,
                value: 1.0,
                limits: [0.0; 2],
            }),
        }),
    ]
}
