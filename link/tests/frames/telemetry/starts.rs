//! A target that begins again, and orders of the start before.

use trendid_link::telemetry::*;

use super::ends::{asked, heard, order, push, restarted, sample, sent, station};

/// What a station answers to the order `id`.
fn answered(station: &mut Station, id: u32) -> Option<Outcome> {
    let mut client = Client::new(id);
    client.ask(Request::Alive);
    let told = heard(&mut client, &sent(station));
    told.into_iter().find_map(|content| match content {
        Content::Answer(answer) => Some(answer.outcome),
        _ => None,
    })
}

/// The second start, `ticks` samples old.
fn again(ticks: u32, fault: bool) -> Station {
    let mut station = station();
    if fault {
        station.event(Event::Fault(text("the watchdog was not fed")));
    }
    for tick in 1..=ticks {
        let _ = station.sample(sample(tick));
        let _ = sent(&mut station);
    }
    station
}

#[test]
fn an_acknowledgement_is_none_of_the_fault_of_a_later_start() {
    for ticks in [0, 1, 300, 1000] {
        // It was asked for in the start before, and comes again.
        let late = order(5, 60_000, Request::Acknowledge);
        let mut faulty = again(ticks, true);
        assert!(push(&mut faulty, &late).is_empty(), "{ticks}");
        let refused = Some(Outcome::Refused(Refusal::Stale));
        assert_eq!(answered(&mut faulty, 5), refused, "{ticks}");
        // Who has seen this start acknowledges its fault, however long ago that was.
        for (id, seen) in [(6, ticks), (7, 0)] {
            let asked = push(&mut faulty, &order(id, seen, Request::Acknowledge));
            assert_eq!(asked, [Request::Acknowledge], "{ticks}");
        }
        // A start without a fault says to the one that comes again that it was done.
        assert_eq!(
            push(&mut again(ticks, false), &late),
            [Request::Acknowledge]
        );
    }
}

#[test]
fn events_of_a_start_are_not_acknowledged_for_that_before() {
    let told = |seen| {
        let mut station = again(100, true);
        assert!(push(&mut station, &order(1, seen, Request::Heard(9))).is_empty());
        assert!(push(&mut station, &order(2, seen, Request::Heard(1))).is_empty());
        let _ = station.sample(sample(101));
        assert!(push(&mut station, &order(3, 100, Request::Hello)).is_empty());
        let _ = station.sample(sample(102));
        let all = heard(&mut Client::new(3), &sent(&mut station));
        all.iter()
            .filter(|c| matches!(c, Content::Event(_)))
            .count()
    };
    // The fault and the state of the first sample.
    assert_eq!((told(60_000), told(100)), (2, 0));
}

/// A client that asks for no samples hears of the next start by its events, and acknowledges them.
#[test]
fn events_of_another_start_are_acknowledged_at_once() {
    let mut client = Client::new(1);
    let mut first = again(0, true);
    let _ = heard(&mut client, &sent(&mut first));
    for tick in 1..=50_000 {
        let _ = first.sample(sample(tick));
        let _ = heard(&mut client, &sent(&mut first));
    }
    let mut second = restarted();
    second.event(Event::Fault(text("panic")));
    let mut events = 0;
    for tick in 1..=2000 {
        let _ = second.sample(sample(tick));
        assert!(push(&mut second, &asked(&mut client, tick.into())).is_empty());
        let bytes = sent(&mut second);
        let told = heard(&mut Client::new(1), &bytes);
        events += told
            .iter()
            .filter(|c| matches!(c, Content::Event(_)))
            .count();
        let _ = heard(&mut client, &bytes);
    }
    // The fault and the state of the first sample, each once.
    assert_eq!(events, 2);
}

#[test]
fn who_asks_who_is_there_hears_it_however_full_the_line_is() {
    let mut station = station();
    for tick in 1..=500 {
        let _ = station.sample(sample(tick));
    }
    assert!(push(&mut station, &order(1, 500, Request::Hello)).is_empty());
    let mut client = Client::new(1);
    let mut identities = 0;
    for tick in 501..=700 {
        let _ = station.sample(sample(tick));
        let told = heard(&mut client, &sent(&mut station));
        let identity = |content: &&Content| matches!(content, Content::Identity(_));
        identities += told.iter().filter(identity).count();
    }
    assert_eq!(identities, 1);
}

#[test]
fn a_value_that_is_asked_for_goes_before_samples() {
    let mut station = station();
    for tick in 1..=500 {
        let _ = station.sample(sample(tick));
    }
    let value = SettingValue {
        setting: 3,
        value: Some(0.5),
    };
    station.setting(value);
    let told = heard(&mut Client::new(1), &sent(&mut station));
    assert!(told.contains(&Content::Setting(value)), "{told:?}");
}

#[test]
fn a_machine_that_is_stopped_is_in_no_state_that_moves() {
    let moved = Sample {
        velocity: 3.0,
        command: 0.5,
        innovation: Some(0.1),
        retuned: true,
        ..sample(7)
    };
    for state in 0..=7_u8 {
        let before = Sample {
            state,
            reason: 12,
            ..moved
        };
        let rests = Sample::stopped(8, 120.5, &before);
        let known = state_of(rests.state, rests.reason).expect("a state");
        assert!(!known.is_controlling() && !known.is_commissioning());
        // A reason that the loop gave stays; without one there is none.
        let reason = if state == 7 {
            12
        } else {
            trendid_link::code::NO_REASON
        };
        let expected = Sample {
            tick: 8,
            state: if state == 7 { 7 } else { 0 },
            reason,
            position: 120.5,
            setpoint: [120.5, 0.0],
            ..Sample::default()
        };
        assert_eq!(rests, expected);
        assert_eq!(
            Sample::stopped(9, 120.5, &rests),
            Sample { tick: 9, ..rests }
        );
    }
    assert_eq!(Sample::stopped(1, f32::NAN, &moved).position, 0.0);
}
