//! Lines that lose, are slow, or are gone.

use trendid_link::telemetry::*;

use super::ends::{heard, order, push, sample, sent, station};
use crate::dice::Dice;

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

/// A line that carries a third of what is sampled: the rest is counted, events and answers pass,
/// the slot never waits.
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
    assert!(answered >= 19, "{answered}");
    station.health(Health::default());
    for content in heard(&mut client, &sent(&mut station)) {
        if let Content::Health(now) = content {
            health = now;
        }
    }
    assert_eq!(health.events_lost, 0);
    let dropped = health.dropped;
    assert!(samples > 2000 && dropped > 4000, "{samples} {health:?}");
    // Every sample and every slow notice has arrived or is counted.
    assert_eq!(samples + slow + dropped, 10_000 + 100, "{health:?}");
}

/// A line that comes back is watched as before: who asked for it once is not there to ask again.
#[test]
fn the_watchdog_of_the_line_watches_again_behind_a_silence() {
    for request in [Request::Alive, Request::Stream(1), Request::Watchdog(250)] {
        let mut station = station();
        assert!(push(&mut station, &order(1, 0, Request::Watchdog(250))).is_empty());
        let mut stops = Vec::new();
        for tick in 1..=3000 {
            if tick == 1000 || tick == 1100 {
                let _ = push(&mut station, &order(tick, 0, request.clone()));
            }
            if station.sample(sample(tick)).stop {
                stops.push(tick);
            }
        }
        assert_eq!(stops, [251, 1350], "{request:?}");
        let _ = push(&mut station, &order(2, 0, Request::Watchdog(0)));
        assert!((3001..=6000).all(|tick| !station.sample(sample(tick)).stop));
    }
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
fn a_watchdog_of_less_than_a_sample_is_one() {
    let identity = Identity {
        sample_time: 0.05,
        ..Identity::default()
    };
    for (ms, stops) in [(0, None), (1, Some(2)), (49, Some(2)), (100, Some(3))] {
        let mut station = Station::new(identity.clone(), 3, 1);
        assert!(push(&mut station, &order(1, 0, Request::Watchdog(ms))).is_empty());
        let found = (1..=200).find(|tick| station.sample(sample(*tick)).stop);
        assert_eq!(found, stops, "{ms} ms");
    }
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
    client.ask(Request::Get(0));
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

/// A target that begins again, at any number of its frames, is no loss; what is lost before and
/// after it is.
#[test]
fn another_start_of_the_target_is_no_loss() {
    for frames in [1, 100, 30_000, 40_000, 65_535] {
        let (mut client, mut first) = (Client::new(1), station());
        first.event(Event::Overrun);
        for tick in 1..=frames {
            let _ = first.sample(sample(tick));
            let _ = heard(&mut client, &sent(&mut first));
        }
        assert_eq!(client.losses().lost, 0, "{frames}");
        let identity = Identity {
            sample_time: 1e-3,
            ..Identity::default()
        };
        let mut second = Station::new(identity, 4, 1);
        second.event(Event::Overrun);
        for tick in 1..=10 {
            let _ = second.sample(sample(tick));
            let bytes = sent(&mut second);
            if tick != 5 {
                let _ = heard(&mut client, &bytes);
            }
        }
        assert_eq!(client.losses().lost, 1, "{frames}");
    }
}
