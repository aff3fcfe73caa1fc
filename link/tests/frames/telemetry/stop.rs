//! A stop over lines that answer late or never.

use trendid_link::telemetry::*;

use super::ends::{asked, heard, order, push, sample, sent, station};
use crate::dice::Dice;

/// Both ends, and the orders whose answers arrived.
struct Ends {
    client: Client,
    station: Station,
    answered: Vec<u32>,
}

impl Ends {
    /// Ends that have seen samples.
    fn new() -> Self {
        let mut ends = Self {
            client: Client::new(1),
            station: station(),
            answered: Vec::new(),
        };
        let _ = ends.carry_out(1..10, || true);
        ends
    }

    /// What the station carries out, and when; `arrives` says whether what it sends arrives.
    fn carry_out(
        &mut self,
        times: core::ops::Range<u32>,
        mut arrives: impl FnMut() -> bool,
    ) -> Vec<(u32, Request)> {
        let mut done = Vec::new();
        for now in times {
            let _ = self.station.sample(sample(now));
            let client = &mut self.client;
            let bytes = asked(client, u64::from(now));
            for request in push(&mut self.station, &bytes) {
                done.push((now, request));
                self.station.answer(Outcome::Done);
            }
            let bytes = sent(&mut self.station);
            if arrives() {
                self.answered
                    .extend(
                        heard(&mut self.client, &bytes)
                            .iter()
                            .filter_map(|told| match told {
                                Content::Answer(answer) => Some(answer.id),
                                _ => None,
                            }),
                    );
            }
        }
        done
    }
}

#[test]
fn a_stop_waits_for_nothing_that_was_asked_before() {
    for waiting in [0, 1, 20, 63, 64] {
        let mut ends = Ends::new();
        for place in 0..waiting {
            ends.client.ask(Request::Set {
                setting: place,
                value: None,
            });
        }
        // No answer comes back from here on.
        let _ = ends.carry_out(10..100, || false);
        assert!(ends.client.ask(Request::Stop).is_some(), "{waiting}");
        let done = ends.carry_out(100..1000, || false);
        assert_eq!(done, [(100, Request::Stop)], "{waiting}");
    }
}

#[test]
fn nothing_moves_behind_a_stop_that_was_asked_before_it() {
    for seed in 0..40 {
        let mut dice = Dice(seed);
        let mut ends = Ends::new();
        let mut asked = Vec::new();
        for _ in 0..1 + dice.roll(10) {
            asked.extend(ends.client.ask(match dice.roll(5) {
                0 => Request::Commission,
                1 => Request::Move(dice.roll(100) as f32),
                2 => Request::Acknowledge,
                3 => Request::Get(1),
                _ => Request::Limits {
                    velocity: 1.0,
                    acceleration: 1.0,
                    jerk: 1.0,
                },
            }));
        }
        let mut lossy = Dice(seed + 1000);
        let begin = 10 + dice.roll(300);
        let _ = ends.carry_out(10..begin, || lossy.roll(3) == 0);
        assert!(ends.client.ask(Request::Stop).is_some());
        let then = begin + 8000;
        let done = ends.carry_out(begin..then, || lossy.roll(3) == 0);
        let moved = |(_, request): &(u32, Request)| {
            request.moves() || matches!(request, Request::Acknowledge | Request::Store)
        };
        assert_eq!(done.first(), Some(&(begin, Request::Stop)), "seed {seed}");
        assert!(!done.iter().any(moved), "seed {seed}: {done:?}");
        // Who asked is told what came of it.
        let given_up: Vec<u32> = std::iter::from_fn(|| ends.client.given_up()).collect();
        for id in asked {
            let told = ends.answered.contains(&id) || given_up.contains(&id);
            assert!(told, "seed {seed}: {id}");
        }
        ends.client.ask(Request::Move(1.0));
        let done = ends.carry_out(then..then + 9000, || true);
        assert!(done.iter().any(moved), "seed {seed}");
    }
}

#[test]
fn stops_that_are_asked_again_and_again_are_all_answered() {
    let mut ends = Ends::new();
    let ids: Vec<_> = (0..100).map(|_| ends.client.ask(Request::Stop)).collect();
    assert!(ids.iter().all(Option::is_some));
    let done = ends.carry_out(10..300, || true);
    assert!(!done.is_empty() && done.iter().all(|(_, request)| *request == Request::Stop));
}

#[test]
fn an_order_that_takes_its_time_is_no_answer_to_the_stop_behind_it() {
    let mut station = station();
    assert_eq!(
        push(&mut station, &order(1, 0, Request::Store)),
        [Request::Store]
    );
    let stop = order(2, 0, Request::Stop);
    assert_eq!(push(&mut station, &stop), [Request::Stop]);
    station.answer(Outcome::Done);
    // The memory is done only now.
    station.answer(Outcome::Refused(Refusal::Storage));
    let _ = sent(&mut station);
    // The answer was lost, and the order comes again.
    assert!(push(&mut station, &stop).is_empty());
    let mut client = Client::new(2);
    client.ask(Request::Stop);
    let answer = Answer {
        id: 2,
        outcome: Outcome::Done,
    };
    assert_eq!(
        heard(&mut client, &sent(&mut station)),
        [Content::Answer(answer)]
    );
}

/// The answer to a stop is lost, the axis is started by its button, and the stop is asked for again.
#[test]
fn a_stop_that_is_asked_again_is_carried_out_again() {
    let mut ends = Ends::new();
    ends.answered.clear();
    let first = ends.client.ask(Request::Stop).expect("a number");
    let done = ends.carry_out(10..60, || false);
    assert_eq!(done, [(10, Request::Stop)]);
    let second = ends.client.ask(Request::Stop).expect("a number");
    let done = ends.carry_out(60..100, || true);
    assert_eq!(done, [(60, Request::Stop)]);
    // The first is told as one that nobody answered.
    assert_eq!(ends.client.given_up(), Some(first));
    assert_eq!(
        (ends.answered, ends.client.given_up()),
        (vec![second], None)
    );
}
