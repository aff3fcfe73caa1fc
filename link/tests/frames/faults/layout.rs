//! The messages on the wire.

use proptest::prelude::*;
use trendid_link::*;

use super::ends::{plain, reply, reset};

#[test]
fn the_layout_on_the_wire_is_as_documented() {
    let mut sample = plain(300, -25);
    sample.requests.push(Request::MoveTo(1.0)).expect("room");
    let frame = Frame::encode(&sample);
    // 'S', the version, 300 in 7-bit groups, a code, -25 in zigzag, one request: the fourth, 1.0f32
    // little endian, check sum.
    let mut body = vec![
        0x53, VERSION, 0xAC, 0x02, 1, 49, 1, 3, 0x00, 0x00, 0x80, 0x3F,
    ];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&body);
    body.extend_from_slice(&crc.to_le_bytes());
    let mut wire = vec![0, 9, 0x53, VERSION, 0xAC, 0x02, 1, 49, 1, 3, 1, 7];
    wire.extend_from_slice(&body[10..]);
    wire.push(0);
    assert!(
        !body[12..].contains(&0),
        "the example has no zero in its check sum"
    );
    assert_eq!(frame.bytes(), wire);
}

/// Encodes and decodes.
fn there_and_back<M: Message>(message: &M) -> Option<M> {
    let frame = Frame::encode(message);
    let mut receiver = Receiver::new();
    frame.bytes().iter().find_map(|&byte| receiver.push(byte))
}

#[test]
fn the_longest_messages_fit() {
    let longest = Reply {
        seq: u32::MAX,
        innovation: Some(1.5),
        counters: Counters {
            corrupt: u32::MAX,
            lost: u32::MAX,
            repeated: u32::MAX,
        },
        setpoint: [1.5; 4],
        ..reply(0x3FC0_0000)
    };
    // From this follows how many samples per second a serial line takes.
    assert_eq!(Frame::encode(&longest).bytes().len(), 125);
    assert_eq!(there_and_back(&longest), Some(longest));
    let asks_nothing = plain(u32::MAX, i32::MIN);
    assert_eq!(Frame::encode(&asks_nothing).bytes().len(), 21);
    let mut longest = reset(u32::MAX);
    longest.code = Some(i32::MIN);
    while longest.requests.push(longest.requests[0]).is_ok() {}
    assert_eq!(longest.requests.len(), REQUESTS);
    assert_eq!(there_and_back(&longest), Some(longest));
}

#[test]
fn every_field_of_a_reply_is_compared() {
    let base = Reply {
        setpoint: [1.0; 4],
        ..reply(0x3F80_0000)
    };
    let mut others = vec![base.clone(); FIELDS];
    others[0].state += 1;
    others[1].reason -= 1;
    others[2].retuned = false;
    others[3].command = 2.0;
    others[4].position = 2.0;
    for j in 0..4 {
        others[5 + j].setpoint[j] = 2.0;
    }
    others[9].innovation = None;
    for j in 0..3 {
        others[10 + j].motion[j] = 2.0;
    }
    // Minus zero is another number.
    others[13].disturbance = -0.0;
    for j in 0..6 {
        others[14 + j].model[j] = 2.0;
        others[20 + j].theta[j] = f32::NAN;
    }
    for (j, other) in others.iter().enumerate() {
        let differ = |k: &usize| base.fields()[*k] != other.fields()[*k];
        let found: Vec<usize> = (0..FIELDS).filter(differ).collect();
        assert_eq!(found, [j], "{:?}", base.fields()[j].0);
        assert_eq!(
            there_and_back(other).map(|r| r.fields()),
            Some(other.fields())
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn every_bit_pattern_survives(seq: u32, code: Option<i32>, bits: u32) {
        let mut sent = Sample { seq, code, ..Sample::default() };
        sent.requests.push(Request::MoveTo(f32::from_bits(bits))).expect("room");
        let got = there_and_back(&sent).expect("a message");
        let Some(Request::MoveTo(target)) = got.requests.first() else { panic!("{got:?}") };
        prop_assert_eq!((got.seq, got.code, target.to_bits()), (seq, code, bits));
    }

    #[test]
    fn one_or_two_wrong_bits_never_pass(seq: u32, code: Option<i32>, first: prop::sample::Index, second: prop::sample::Index) {
        let sent = Sample { seq, code, ..Sample::default() };
        let frame = Frame::encode(&sent);
        let mut wire = frame.bytes().to_vec();
        let count = wire.len() * 8;
        for at in [first.index(count), second.index(count)] {
            wire[at / 8] ^= 1 << (at % 8);
        }
        prop_assume!(wire != frame.bytes());
        let mut receiver = Receiver::<Sample>::new();
        let got: Vec<_> = wire.iter().chain(&[0]).filter_map(|&byte| receiver.push(byte)).collect();
        // Damage of the outer delimiters alone may leave the body whole; then it must be the body
        // that was sent.
        for sample in got {
            prop_assert_eq!(&sample, &sent);
        }
    }

    #[test]
    fn noise_never_panics_and_the_next_frame_gets_through(noise: Vec<u8>) {
        let mut receiver = Receiver::<Sample>::new();
        for byte in noise {
            let _ = receiver.push(byte);
        }
        let sent = plain(1, 2);
        let got = Frame::encode(&sent).bytes().iter().find_map(|&byte| receiver.push(byte));
        prop_assert_eq!(got, Some(sent));
    }
}
