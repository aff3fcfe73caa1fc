//! What a client does with its orders, however slow the line is, and what is left of it when the
//! line is gone.

use trendid_link::telemetry::*;

use super::ends::{asked, heard, order, push, requests, sample, sent, station};

fn given_up(client: &mut Client) -> Vec<u32> {
    std::iter::from_fn(|| client.given_up()).collect()
}

#[test]
fn the_next_order_goes_out_as_soon_as_the_one_before_is_answered() {
    let (mut client, mut station) = (Client::new(1), station());
    client.ask(Request::Alive);
    client.ask(Request::Stream(0));
    assert!(push(&mut station, &asked(&mut client, 7)).is_empty());
    assert_eq!(asked(&mut client, 7), [], "one at a time");
    let _ = heard(&mut client, &sent(&mut station));
    assert_eq!(
        requests(&asked(&mut client, 7)),
        [Request::Stream(0)],
        "in the same millisecond"
    );
}

/// A line that takes longer for one frame than the client waits for an answer.
#[test]
fn an_order_that_is_still_on_its_way_is_not_sent_again() {
    let mut client = Client::new(1);
    let id = client.ask(Request::Alive).expect("a number");
    let mut now = 0;
    let mut bytes = Vec::new();
    while bytes.len() < 2 || bytes.last() != Some(&0) {
        bytes.extend(client.next_byte(now));
        now += 250;
    }
    assert!(now > 5 * 250, "longer than all attempts");
    assert_eq!(requests(&bytes), [Request::Alive]);
    assert_eq!(given_up(&mut client), []);
    for _ in 1..5 {
        assert_eq!(requests(&asked(&mut client, now)), [Request::Alive]);
        now += 250;
    }
    assert_eq!(asked(&mut client, now), []);
    assert_eq!(given_up(&mut client), [id]);
}

#[test]
fn a_stop_that_was_not_sent_yet_is_the_same_order_and_no_other_has_its_number() {
    let mut client = Client::new(1);
    let hello = client.ask(Request::Hello);
    let stop = client.ask(Request::Stop);
    let alive = client.ask(Request::Alive);
    assert_eq!(client.ask(Request::Stop), stop);
    let get = client.ask(Request::Get(0));
    assert_eq!([hello, stop, alive, get], [1, 2, 3, 4].map(Some));
    // The stop goes out, and so will what may be done behind it: nothing is given up.
    assert_eq!(given_up(&mut client), []);
    assert_eq!(client.losses().unanswered, 0);
    assert_eq!(requests(&asked(&mut client, 0)), [Request::Stop]);
}

#[test]
fn of_too_many_orders_that_were_given_up_the_newest_are_told() {
    let mut client = Client::new(1);
    let mut last = 0;
    for _ in 0..100 {
        last = client.ask(Request::Commission).expect("a number");
        client.ask(Request::Stop);
    }
    let told = given_up(&mut client);
    assert_eq!((told.len(), told.last()), (64, Some(&last)));
    assert_eq!(client.losses().unanswered, 100);
}

/// Half a frame that waits for the line is one that moves the axis when the line is back.
#[test]
fn nothing_of_an_order_is_left_behind_a_disconnection() {
    let mut client = Client::new(1);
    client.ask(Request::Move(100.0));
    // The driver of the line took a part of it.
    let begin: Vec<u8> = (0..3).filter_map(|_| client.next_byte(0)).collect();
    assert_eq!(begin.len(), 3);
    client.disconnect();
    assert_eq!(asked(&mut client, 0), []);
    // Who comes back waits for no answer of before.
    client.ask(Request::Hello);
    assert_eq!(requests(&asked(&mut client, 0)), [Request::Hello]);
}

#[test]
fn what_the_client_heard_of_a_line_that_is_gone_spoils_nothing_of_the_next_one() {
    let (mut client, mut station) = (Client::new(1), station());
    let _ = station.sample(sample(1));
    let _ = heard(&mut client, &sent(&mut station));
    // A frame that is damaged, and one that the end of the line has cut.
    assert_eq!(heard(&mut client, &[0, 1, 2, 3, 0]), []);
    let _ = station.sample(sample(2));
    let mut bytes = sent(&mut station);
    bytes.truncate(bytes.len() / 2);
    assert_eq!(heard(&mut client, &bytes), []);
    client.disconnect();
    // What was sent meanwhile was lost by nobody.
    for tick in 3..10 {
        let _ = station.sample(sample(tick));
        let _ = sent(&mut station);
    }
    let _ = station.sample(sample(10));
    // Without the delimiter that begins it: the line came back within a pause.
    let bytes = sent(&mut station);
    assert_eq!(heard(&mut client, &bytes[1..]).len(), 1);
    let losses = Losses {
        corrupt: 1,
        ..Losses::default()
    };
    assert_eq!(client.losses(), losses, "the damage is still counted");
}

#[test]
fn samples_come_as_often_as_they_are_asked_for_from_the_order_on() {
    let mut station = station();
    let ticks = |station: &mut Station, ticks: core::ops::Range<u32>| -> Vec<u32> {
        let mut told = Vec::new();
        for tick in ticks {
            let _ = station.sample(sample(tick));
            told.extend(heard(&mut Client::new(1), &sent(station)));
        }
        let tick = |content| match content {
            Content::Sample(sample) => Some(sample.tick),
            _ => None,
        };
        told.into_iter().filter_map(tick).collect()
    };
    assert_eq!(ticks(&mut station, 1..4), [1, 2, 3]);
    assert!(push(&mut station, &order(1, 3, Request::Stream(3))).is_empty());
    assert_eq!(ticks(&mut station, 4..12), [6, 9]);
    // Two samples have passed since: they count for nothing.
    assert!(push(&mut station, &order(2, 11, Request::Stream(3))).is_empty());
    assert_eq!(ticks(&mut station, 12..18), [14, 17]);
    assert!(push(&mut station, &order(3, 17, Request::Stream(0))).is_empty());
    assert_eq!(ticks(&mut station, 18..30), []);
}

/// A machine that takes no sample yet says who it is.
#[test]
fn who_is_there_is_answered_before_the_first_sample() {
    let mut station = station();
    assert!(push(&mut station, &order(1, 0, Request::Hello)).is_empty());
    let told = heard(&mut Client::new(1), &sent(&mut station));
    let identity = |content: &Content| matches!(content, Content::Identity(_));
    assert!(told.iter().any(identity), "{told:?}");
}
