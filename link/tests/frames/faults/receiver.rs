//! What a receiver takes, counts and leaves, frame by frame.

use std::fmt::Debug;

use serde::{Deserialize, Serialize};
use trendid_link::*;

use super::ends::plain;

/// A message of one tag, and one of the same layout with another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Ours(u32);
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Theirs(u32);

impl Message for Ours {
    const TAG: u8 = b'a';
}

impl Message for Theirs {
    const TAG: u8 = b'b';
}

/// A message that fills a body: 122 bytes between tag, version and check sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Full([[u8; 4]; 30], [u8; 2]);

impl Message for Full {
    const TAG: u8 = b'f';
}

/// One byte more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Fuller(Full, u8);

impl Message for Fuller {
    const TAG: u8 = b'f';
}

const FULL: Full = Full([[1, 2, 3, 4]; 30], [5, 6]);

/// The messages in these bytes, and the damaged frames beside them.
fn received<M: Message>(bytes: &[u8]) -> (Vec<M>, u32) {
    let mut receiver = Receiver::new();
    let found = bytes
        .iter()
        .filter_map(|&byte| receiver.push(byte))
        .collect();
    (found, receiver.corrupt())
}

fn is_received<M: Message + PartialEq + Debug>(message: M) {
    let bytes = Frame::encode(&message).bytes().to_vec();
    assert_eq!(received::<M>(&bytes), (vec![message], 0));
}

#[test]
fn a_frame_of_another_message_of_the_same_layout_is_damaged() {
    is_received(Ours(7));
    is_received(Theirs(7));
    assert_eq!(
        received::<Ours>(Frame::encode(&Theirs(7)).bytes()),
        (vec![], 1)
    );
}

#[test]
fn the_longest_body_is_sent_and_received_and_no_longer_one() {
    is_received(FULL);
    assert_eq!(Frame::encode(&FULL).bytes().len(), MAX_WIRE);
    assert!(Frame::encode(&Fuller(FULL, 5)).bytes().is_empty());
    // The state of a frame without bytes is that of any other.
    assert_eq!(
        received::<Fuller>(Frame::encode(&Fuller(FULL, 5)).bytes()),
        (vec![], 0)
    );
}

/// Whatever the begin of a frame says, one with bytes too many is none, and the next one is whole.
#[test]
fn bytes_behind_the_longest_frame_are_no_part_of_it_and_spoil_it() {
    let frame = Frame::encode(&FULL);
    for more in 1..600 {
        let mut bytes = frame.bytes().to_vec();
        let end = bytes.pop();
        bytes.extend(std::iter::repeat_n(9, more));
        bytes.extend(end);
        assert_eq!(received::<Full>(&bytes), (vec![], 1), "{more}");
        bytes.extend_from_slice(frame.bytes());
        assert_eq!(received::<Full>(&bytes), (vec![FULL], 1), "{more}");
    }
}

#[test]
fn every_damaged_frame_is_counted_once_and_an_empty_one_never() {
    let mut receiver = Receiver::<Sample>::new();
    let good = Frame::encode(&plain(1, 2));
    for frames in 1..=5 {
        for byte in [0, 0, 7, 0, 0] {
            assert_eq!(receiver.push(byte), None);
        }
        assert_eq!(receiver.corrupt(), frames);
        let found: Vec<_> = good
            .bytes()
            .iter()
            .filter_map(|&byte| receiver.push(byte))
            .collect();
        assert_eq!((found, receiver.corrupt()), (vec![plain(1, 2)], frames));
    }
    receiver.clear();
    assert_eq!(receiver.corrupt(), 0);
    let fresh = Receiver::<Sample>::default();
    assert_eq!(fresh.corrupt(), 0);
}

/// A byte that is lost costs its frame, and at most the one whose delimiter it was.
#[test]
fn a_lost_byte_costs_no_frame_but_its_own() {
    let sent: Vec<Ours> = (0..3).map(|k| Ours(300 + k)).collect();
    let frames: Vec<u8> = sent
        .iter()
        .flat_map(|ours| Frame::encode(ours).bytes().to_vec())
        .collect();
    for lost in 0..frames.len() {
        let mut bytes = frames.clone();
        let delimiter = bytes.remove(lost) == 0;
        let (found, damaged) = received::<Ours>(&bytes);
        let whole = frames.len() / 3;
        // Between two frames stand two delimiters; the last one alone ends the last frame.
        let kept = if !delimiter {
            sent.iter()
                .filter(|ours| ours.0 as usize - 300 != lost / whole)
                .copied()
                .collect()
        } else if lost + 1 == frames.len() {
            sent[..2].to_vec()
        } else {
            sent.clone()
        };
        assert_eq!(found, kept, "{lost}");
        assert_eq!(damaged, u32::from(!delimiter), "{lost}");
    }
}
