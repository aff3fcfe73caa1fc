//! Bytes that are damaged, cut or noise change nothing.

use proptest::prelude::*;
use trendid_link::VERSION;
use trendid_link::telemetry::*;

use super::ends::{any_request, future, heard, order, push, sample, sent, station};

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
