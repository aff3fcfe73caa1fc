//! Events: none twice, none of another start, and the newest whatever happens.

use trendid_link::telemetry::*;

use super::ends::{asked, heard, order, push, requests, restarted, sample, sent, station};

fn events(heard: Vec<Content>) -> Vec<Event> {
    let event = |content| match content {
        Content::Event(event) => Some(event.event),
        _ => None,
    };
    heard.into_iter().filter_map(event).collect()
}

/// Nobody listens, and more happens than is kept.
#[test]
fn of_too_many_events_the_newest_are_kept_and_the_others_are_counted() {
    let mut station = station();
    for _ in 0..30 {
        station.event(Event::Overrun);
        let _ = sent(&mut station);
    }
    let fault = Event::Fault(text("the axis is blocked"));
    station.event(fault.clone());
    let _ = sent(&mut station);
    let mut client = Client::new(1);
    client.ask(Request::Hello);
    assert!(push(&mut station, &asked(&mut client, 0)).is_empty());
    let mut told = Vec::new();
    for tick in 1..=20 {
        let _ = station.sample(sample(tick));
        told.extend(events(heard(&mut client, &sent(&mut station))));
    }
    // The state of the first sample is one more.
    let last = told.iter().rev().find(|event| **event != state());
    assert_eq!((told.len(), last), (EVENTS, Some(&fault)));
    station.health(Health::default());
    let lost = heard(&mut client, &sent(&mut station));
    let lost = lost.iter().find_map(|content| match content {
        Content::Health(health) => Some(health.events_lost),
        _ => None,
    });
    assert_eq!(lost, Some(30 + 1 + 1 - EVENTS as u32));
}

/// The event of the first sample.
fn state() -> Event {
    let Sample { state, reason, .. } = sample(1);
    Event::State { state, reason }
}

/// A start with fewer events than the client has heard of the one before.
#[test]
fn events_of_another_start_are_heard_however_many_the_start_before_had() {
    let mut client = Client::new(1);
    let mut first = station();
    for tick in 1..=50_000 {
        if tick <= 5 {
            first.event(Event::Overrun);
        }
        let _ = first.sample(sample(tick));
        let _ = heard(&mut client, &sent(&mut first));
    }
    while client.next_byte(0).is_some() {}
    client.disconnect();

    // No sample of it is asked for.
    let mut second = restarted();
    let fault = Event::Fault(text("panic"));
    second.event(fault.clone());
    let _ = second.sample(sample(1));
    let told = events(heard(&mut client, &sent(&mut second)));
    assert_eq!(told, [fault, state()]);

    // Who was told of the fault acknowledges it, and nothing that was asked is too old for that.
    client.ask(Request::Acknowledge);
    let mut carried_out = Vec::new();
    for tick in 2..300 {
        let bytes = asked(&mut client, tick.into());
        let _ = second.sample(sample(tick));
        for request in push(&mut second, &bytes) {
            carried_out.push(request);
            second.answer(Outcome::Done);
        }
        let _ = heard(&mut client, &sent(&mut second));
    }
    assert_eq!(carried_out, [Request::Acknowledge]);
}

/// Many events before the client may send: their newest number says it for all.
#[test]
fn events_that_come_together_are_acknowledged_by_one_order() {
    let (mut client, mut station) = (Client::new(1), station());
    for _ in 0..5 {
        station.event(Event::Overrun);
    }
    assert_eq!(events(heard(&mut client, &sent(&mut station))).len(), 5);
    let mut orders = Vec::new();
    for now in 0..10 {
        let bytes = asked(&mut client, now);
        orders.extend(requests(&bytes));
        assert!(push(&mut station, &bytes).is_empty());
        let _ = heard(&mut client, &sent(&mut station));
    }
    assert_eq!(orders, [Request::Heard(4)]);
}

#[test]
fn a_number_that_no_event_has_yet_acknowledges_none() {
    let told = |number| {
        let mut station = station();
        station.event(Event::Overrun);
        let _ = sent(&mut station);
        assert!(push(&mut station, &order(1, 0, Request::Heard(number))).is_empty());
        assert!(push(&mut station, &order(2, 0, Request::Hello)).is_empty());
        let _ = station.sample(Sample::default());
        events(heard(&mut Client::new(1), &sent(&mut station))).len()
    };
    // The event, and the state of the first sample.
    assert_eq!([0, 1, 9, u32::MAX].map(told), [1, 2, 2, 2]);
}

/// Values of a setting, more than the line has room for.
const FLOOD: u32 = 200;

/// A station whose line is full of a value.
fn flooded() -> (Station, SettingValue) {
    let mut station = station();
    let value = SettingValue {
        setting: 3,
        value: None,
    };
    for _ in 0..FLOOD {
        station.setting(value);
    }
    (station, value)
}

/// A line that takes nothing for a while: what must arrive waits for its room, and no longer.
#[test]
fn what_found_no_room_is_sent_with_the_next_sample_that_has_it() {
    let (mut station, value) = flooded();
    station.event(Event::Overrun);
    let ordered = push(&mut station, &order(7, 0, Request::Commission));
    assert_eq!(ordered, [Request::Commission]);
    station.answer(Outcome::Refused(Refusal::Latched));
    let before = heard(&mut Client::new(7), &sent(&mut station));
    let is_value = |content: &Content| *content == Content::Setting(value);
    assert!(before.iter().all(is_value), "{before:?}");

    let _ = station.sample(sample(1));
    let mut client = Client::new(7);
    client.ask(Request::Commission);
    let told = heard(&mut client, &sent(&mut station));
    let answer = Answer {
        id: 7,
        outcome: Outcome::Refused(Refusal::Latched),
    };
    assert!(told.contains(&Content::Answer(answer)), "{told:?}");
    assert_eq!(events(told), [Event::Overrun, state()]);
}

#[test]
fn a_model_that_was_refused_is_an_event_once() {
    let (mut client, mut station) = (Client::new(1), station());
    let mut told = |refused| {
        let learned = Learned {
            refusal: 4,
            counts: [7, refused],
            ..Learned::default()
        };
        station.learned(learned);
        let told = heard(&mut client, &sent(&mut station));
        assert!(told.contains(&Content::Learned(learned)), "{refused}");
        events(told)
    };
    let refused = [0, 1, 1, 2].map(&mut told).concat();
    assert_eq!(refused, [Event::Refused(4), Event::Refused(4)]);
}

#[test]
fn a_line_that_was_silent_for_too_long_is_an_event() {
    let (mut client, mut station) = (Client::new(1), station());
    assert!(push(&mut station, &order(1, 0, Request::Watchdog(20))).is_empty());
    let mut told = Vec::new();
    for tick in 1..100 {
        let _ = station.sample(sample(tick));
        told.extend(events(heard(&mut client, &sent(&mut station))));
    }
    assert_eq!(told, [state(), Event::LineLost]);
}

#[test]
fn a_value_of_a_setting_that_finds_no_room_is_counted() {
    let (mut station, value) = flooded();
    let mut told = heard(&mut Client::new(1), &sent(&mut station));
    station.health(Health::default());
    told.extend(heard(&mut Client::new(1), &sent(&mut station)));
    let is_value = |content: &&Content| **content == Content::Setting(value);
    let arrived = told.iter().filter(is_value).count();
    let dropped = told.iter().find_map(|content| match content {
        Content::Health(health) => Some(health.dropped),
        _ => None,
    });
    assert_eq!(dropped, Some(FLOOD - arrived as u32));
}
