//! Telemetry over lines that damage, cut, repeat and lose.

use proptest::prelude::*;
use trendid::servo::{Config, Travel};
use trendid_link::telemetry::settings::{self, SETTINGS};
use trendid_link::telemetry::*;
use trendid_link::{Frame, VERSION, code};

/// A linear congruential generator; the seed is part of each test.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) as u32) % sides
    }
}

fn station() -> Station {
    let identity = Identity {
        sample_time: 1e-3,
        ..Identity::default()
    };
    Station::new(identity, 3, 1)
}

fn sample(tick: u32) -> Sample {
    Sample {
        tick,
        position: tick as f32,
        innovation: Some(0.5),
        ..Sample::default()
    }
}

fn push(station: &mut Station, bytes: &[u8]) -> Vec<Request> {
    bytes.iter().filter_map(|&b| station.push(b)).collect()
}

fn sent(station: &mut Station) -> Vec<u8> {
    std::iter::from_fn(|| station.next_byte()).collect()
}

fn heard(client: &mut Client, bytes: &[u8]) -> Vec<Content> {
    bytes.iter().filter_map(|&b| client.push(b)).collect()
}

fn order(id: u32, seen: u32, request: Request) -> Vec<u8> {
    Frame::encode(&Order { id, seen, request }).bytes().to_vec()
}

fn any_request() -> impl Strategy<Value = Request> {
    prop_oneof![
        Just(Request::Commission),
        Just(Request::Stop),
        any::<f32>().prop_map(Request::Move),
        (any::<f32>(), any::<f32>()).prop_map(|(amplitude, frequency)| Request::Oscillate {
            amplitude,
            frequency
        }),
        (any::<u8>(), any::<Option<f32>>())
            .prop_map(|(setting, value)| Request::Set { setting, value }),
        any::<[f32; 6]>().prop_map(Request::Install),
        any::<u16>().prop_map(Request::Stream),
        any::<u32>().prop_map(Request::Heard),
    ]
}

/// What a station does from here on, whatever its counter of damaged frames.
fn future(mut station: Station) -> Vec<u8> {
    for tick in 1..=700 {
        let _ = station.sample(sample(tick));
        if tick % 50 == 0 {
            let _ = sent(&mut station);
        }
    }
    sent(&mut station)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn noise_asks_for_nothing_and_changes_nothing(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let mut station = station();
        let before = future(station.clone());
        prop_assert!(push(&mut station, &bytes).is_empty());
        prop_assert!(push(&mut station, &[0]).is_empty());
        prop_assert_eq!(future(station.clone()), before);
        // And the next order is understood.
        prop_assert_eq!(push(&mut station, &order(1, 0, Request::Stop)), [Request::Stop]);
    }

    #[test]
    fn an_order_with_a_damaged_byte_changes_nothing(request in any_request(), place in any::<prop::sample::Index>(), flip in 1..=255_u8) {
        let mut bytes = order(1, 0, request);
        // The delimiters may be damaged: the next frame brings its own.
        let place = 1 + place.index(bytes.len() - 2);
        bytes[place] ^= flip;
        let mut station = station();
        let before = future(station.clone());
        prop_assert!(push(&mut station, &bytes).is_empty());
        prop_assert_eq!(future(station), before);
    }

    #[test]
    fn an_order_that_is_cut_changes_nothing(request in any_request(), cut in any::<prop::sample::Index>()) {
        let bytes = order(1, 0, request);
        let mut station = station();
        let before = future(station.clone());
        // All but the closing delimiter at most, then the next frame.
        let part = &bytes[..cut.index(bytes.len() - 1)];
        prop_assert!(push(&mut station, part).is_empty());
        prop_assert!(push(&mut station, &[0, 0]).is_empty() || part.len() + 1 == bytes.len());
        if part.len() + 1 < bytes.len() {
            prop_assert_eq!(future(station), before);
        }
    }

    #[test]
    fn an_intact_order_arrives_once_with_its_bits(request in any_request(), repetitions in 1..5_usize) {
        let bytes = order(9, 0, request.clone());
        let mut station = station();
        let own = matches!(request, Request::Stream(_) | Request::Heard(_));
        for repetition in 0..repetitions {
            let came = push(&mut station, &bytes);
            if own || repetition > 0 {
                prop_assert!(came.is_empty());
            } else {
                prop_assert_eq!(format!("{came:?}"), format!("{:?}", [&request]));
                station.answer(Outcome::Done);
            }
        }
        let mut client = Client::new(9);
        client.ask(request);
        let answers = heard(&mut client, &sent(&mut station));
        let done = Content::Answer(Answer { id: 9, outcome: Outcome::Done });
        prop_assert_eq!(answers.iter().filter(|c| **c == done).count(), 1);
    }

    #[test]
    fn noise_tells_the_client_nothing(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let mut client = Client::new(0);
        prop_assert!(heard(&mut client, &bytes).is_empty());
        let _ = client.push(0);
        let mut station = station();
        let _ = station.sample(sample(1));
        prop_assert!(heard(&mut client, &sent(&mut station)).contains(&Content::Sample(sample(1))));
    }
}

#[test]
fn a_frame_of_another_version_is_refused() {
    let good = order(1, 0, Request::Stop);
    let mut body = [0; 128];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    for version in 0..=255_u8 {
        let message = (b'O', version, (1_u32, 0_u32, Request::Stop));
        let body = postcard::to_slice_crc32(&message, &mut body, crc.digest()).unwrap();
        let mut wire = [0; 140];
        let len = cobs::encode(body, &mut wire[1..]);
        let wire = &wire[..len + 2];
        let mut station = station();
        assert_eq!(
            !push(&mut station, wire).is_empty(),
            version == VERSION,
            "{version}"
        );
        assert!(version != VERSION || wire == good);
    }
}

/// Events arrive once and in order over a line that loses every second frame in both directions.
#[test]
fn events_arrive_once_and_in_order_over_a_bad_line() {
    for seed in 0..10 {
        let mut dice = Dice(seed);
        let mut lossy = |bytes: Vec<u8>| -> Vec<u8> {
            // A frame is what lies between two delimiters.
            let mut kept = Vec::new();
            for frame in bytes.split_inclusive(|b| *b == 0) {
                if dice.roll(2) == 0 {
                    kept.extend_from_slice(frame);
                    kept.push(0);
                }
            }
            kept
        };
        let (mut station, mut client) = (station(), Client::new(100));
        let mut numbers = Vec::new();
        let mut told = 0;
        for tick in 1..=30_000_u32 {
            // Twelve events, then the line has time to bring them.
            if tick % 100 == 0 && told < 12 {
                station.event(Event::Overrun);
                told += 1;
            }
            let _ = station.sample(sample(tick));
            for content in heard(&mut client, &lossy(sent(&mut station))) {
                if let Content::Event(event) = content {
                    numbers.push(event.number);
                }
            }
            let mut bytes = Vec::new();
            while let Some(byte) = client.next_byte(u64::from(tick)) {
                bytes.push(byte);
            }
            assert!(push(&mut station, &lossy(bytes)).is_empty());
        }
        // The first is the state of the first sample.
        assert_eq!(numbers, (0..13).collect::<Vec<_>>(), "seed {seed}");
        assert!(client.losses().lost > 1000, "seed {seed}: the line loses");
    }
}

/// A line that carries a third of what is sampled: the rest is counted, events and answers pass, the slot never waits.
#[test]
fn what_a_slow_line_cannot_carry_is_dropped_and_counted() {
    let (mut station, mut client) = (station(), Client::new(5));
    let (mut samples, mut slow, mut events, mut health) = (0_u32, 0, 0, Health::default());
    let mut answered = 0;
    for tick in 1..=10_000_u32 {
        if tick % 1000 == 0 {
            station.event(Event::Overrun);
        }
        if station.sample(sample(tick)).slow {
            station.health(Health::default());
        }
        if tick % 500 == 0 {
            client.ask(Request::Stop);
        }
        let mut asked = Vec::new();
        while let Some(byte) = client.next_byte(u64::from(tick)) {
            asked.push(byte);
        }
        for request in push(&mut station, &asked) {
            assert_eq!(request, Request::Stop);
            station.answer(Outcome::Done);
        }
        // At the end the line brings what still waits.
        let room = if tick < 10_000 { 12 } else { usize::MAX };
        for _ in 0..room {
            let Some(byte) = station.next_byte() else {
                break;
            };
            match client.push(byte) {
                Some(Content::Sample(_)) => samples += 1,
                Some(Content::Event(_)) => events += 1,
                Some(Content::Health(_)) => slow += 1,
                Some(Content::Answer(answer)) if answer.outcome == Outcome::Done => answered += 1,
                _ => {}
            }
        }
    }
    assert_eq!(client.losses(), Losses::default());
    assert_eq!(events, 11);
    // Answers to the requests, and to the acknowledgements of the events.
    assert!(
        answered >= 19 && health.events_lost == 0,
        "{answered} {health:?}"
    );
    station.health(Health::default());
    for content in heard(&mut client, &sent(&mut station)) {
        if let Content::Health(now) = content {
            health = now;
        }
    }
    let dropped = health.dropped;
    assert!(samples > 2000 && dropped > 4000, "{samples} {health:?}");
    // Every sample and every slow notice has arrived or is counted.
    assert_eq!(samples + slow + dropped, 10_000 + 100, "{health:?}");
}

#[test]
fn the_watchdog_of_the_line_stops_once() {
    let mut station = station();
    assert!(push(&mut station, &order(1, 0, Request::Watchdog(250))).is_empty());
    let stops: Vec<u32> = (1..=2000)
        .filter(|tick| station.sample(sample(*tick)).stop)
        .collect();
    assert_eq!(stops, [251]);
    // Without being asked for there is none.
    let mut silent = self::station();
    assert!((1..=5000).all(|tick| !silent.sample(sample(tick)).stop));
}

#[test]
fn what_moves_is_refused_when_its_sender_saw_nothing_recent() {
    let mut station = station();
    for tick in 1..=5000 {
        let _ = station.sample(sample(tick));
        let _ = sent(&mut station);
    }
    let refused = Outcome::Refused(Refusal::Stale);
    let recent = 5000 - STALE_MS;
    // Of the past, of an earlier start of the target, and of the future.
    for (id, seen) in [(1, recent - 1), (2, 0), (3, 5001), (4, u32::MAX)] {
        assert!(push(&mut station, &order(id, seen, Request::Commission)).is_empty());
        let mut client = Client::new(id);
        client.ask(Request::Commission);
        let answers = heard(&mut client, &sent(&mut station));
        assert!(
            answers.contains(&Content::Answer(Answer {
                id,
                outcome: refused.clone()
            })),
            "{seen}"
        );
    }
    assert_eq!(
        push(&mut station, &order(6, recent, Request::Commission)),
        [Request::Commission]
    );
    // A stop is never too old.
    assert_eq!(
        push(&mut station, &order(7, 0, Request::Stop)),
        [Request::Stop]
    );
}

#[test]
fn a_client_gives_an_order_up_and_sends_nothing_after_a_disconnection() {
    let mut client = Client::new(1);
    client.ask(Request::Commission);
    client.ask(Request::Stop);
    let mut frames = 0;
    let mut bytes = |client: &mut Client, now| {
        let count = std::iter::from_fn(|| client.next_byte(now)).count();
        frames += u32::from(count > 0);
    };
    for now in (0..1000).step_by(10) {
        bytes(&mut client, now);
    }
    bytes(&mut client, 1000);
    assert_eq!(client.given_up(), Some(1));
    assert_eq!(client.losses().unanswered, 1);
    client.disconnect();
    bytes(&mut client, 5000);
    // Five times the first, once the second.
    assert_eq!(frames, 6);
}

#[test]
fn every_setting_is_read_as_it_was_set_and_refuses_what_is_out_of_bounds() {
    let config = Config::new(
        1e-3,
        20.0,
        Travel {
            min: 0.0,
            max: 400.0,
        },
    );
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
        let changed = settings::with(&config, number, Some(value))
            .unwrap_or_else(|refusal| panic!("{}: {refusal}", setting.name));
        assert_eq!(
            settings::get(&changed, number),
            Ok(Some(value)),
            "{}",
            setting.name
        );
        assert_ne!(changed, config, "{}", setting.name);
        for wrong in [low - 1.0, 2.0 * high + 1.0, f32::NAN, f32::INFINITY] {
            let refusal = settings::with(&config, number, Some(wrong)).unwrap_err();
            let named =
                matches!(&refusal, Refusal::Value { name, .. } if name.as_str() == setting.name);
            assert!(named, "{}: {refusal:?}", setting.name);
        }
        assert_eq!(
            settings::with(&config, number, None).is_ok(),
            setting.follows
        );
        assert!(setting.name.len() <= 40, "a refusal has room for the name");
    }
    let beyond = SETTINGS.len() as u8;
    assert_eq!(settings::get(&config, beyond), Err(Refusal::Unsupported));
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
    let text = Text::try_from("m".repeat(40).as_str()).unwrap();
    let max = u32::MAX;
    let health = Health {
        tick: max,
        failed_readings: max,
        implausible_readings: max,
        saturated_samples: max,
        oscillations: max,
        stops: max,
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
    let contents = [
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
    ];
    for content in contents {
        let frame = Frame::encode(&Notice {
            seq: u16::MAX,
            content: content.clone(),
        });
        assert!(!frame.bytes().is_empty(), "{content:?}");
    }
}
