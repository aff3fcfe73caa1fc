//! Both ends of a line.

use proptest::prelude::*;
use trendid_link::telemetry::*;
use trendid_link::{Frame, Receiver};

fn identity() -> Identity {
    Identity {
        sample_time: 1e-3,
        ..Identity::default()
    }
}

pub(crate) fn station() -> Station {
    Station::new(identity(), 3, 1)
}

/// The station of the next start.
pub(crate) fn restarted() -> Station {
    Station::new(identity(), 4, 0)
}

pub(crate) fn sample(tick: u32) -> Sample {
    Sample {
        tick,
        position: tick as f32,
        innovation: Some(0.5),
        ..Sample::default()
    }
}

pub(crate) fn push(station: &mut Station, bytes: &[u8]) -> Vec<Request> {
    bytes.iter().filter_map(|&b| station.push(b)).collect()
}

pub(crate) fn sent(station: &mut Station) -> Vec<u8> {
    std::iter::from_fn(|| station.next_byte()).collect()
}

/// What a client has for the line at `now`.
pub(crate) fn asked(client: &mut Client, now: u64) -> Vec<u8> {
    std::iter::from_fn(|| client.next_byte(now)).collect()
}

/// The requests of the orders in these bytes.
pub(crate) fn requests(bytes: &[u8]) -> Vec<Request> {
    let mut receiver = Receiver::<Order>::new();
    let orders = bytes.iter().filter_map(|&byte| receiver.push(byte));
    orders.map(|order| order.request).collect()
}

pub(crate) fn heard(client: &mut Client, bytes: &[u8]) -> Vec<Content> {
    bytes.iter().filter_map(|&b| client.push(b)).collect()
}

pub(crate) fn order(id: u32, seen: u32, request: Request) -> Vec<u8> {
    Frame::encode(&Order { id, seen, request }).bytes().to_vec()
}

pub(crate) fn any_request() -> impl Strategy<Value = Request> {
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
pub(crate) fn future(mut station: Station) -> Vec<u8> {
    for tick in 1..=700 {
        let _ = station.sample(sample(tick));
        if tick % 50 == 0 {
            let _ = sent(&mut station);
        }
    }
    sent(&mut station)
}
