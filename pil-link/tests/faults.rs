//! The lockstep over a line that corrupts, drops and repeats bytes and frames.

use std::collections::VecDeque;

use proptest::prelude::*;
use trendid_pil_link::*;

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

/// The target as the firmware has it: a state that shows every sample that was processed, and how often.
#[derive(Default)]
struct Target {
    responder: Responder,
    processed: u32,
    sum: f32,
}

impl Target {
    fn push(&mut self, byte: u8, out: &mut Vec<u8>) {
        match self.responder.push(byte) {
            Some(Incoming::New(sample)) => {
                self.processed += 1;
                self.sum = self.sum * 0.5 + sample.y;
                let reply = reply(0, self.sum);
                out.extend_from_slice(self.responder.answer(reply));
            }
            Some(Incoming::Repeated) => out.extend_from_slice(self.responder.cached()),
            Some(Incoming::Stale) | None => {}
        }
    }
}

fn reply(seq: u32, u: f32) -> Reply {
    Reply {
        seq,
        u,
        innovation: -u,
        parameters: [u, 0.0, -0.0, f32::NAN].into_iter().collect(),
        status: status::ESTIMATED,
        counters: Counters::default(),
    }
}

/// The line to the target, with one fault in `one_in` frames in each direction.
struct Line {
    target: Target,
    dice: Dice,
    one_in: u32,
    injected: [u32; 4],
    inbox: VecDeque<u8>,
}

impl Line {
    fn new(seed: u64, one_in: u32) -> Self {
        Self {
            target: Target::default(),
            dice: Dice(seed),
            one_in,
            injected: [0; 4],
            inbox: VecDeque::new(),
        }
    }

    fn disturb(&mut self, frame: &[u8]) -> Vec<u8> {
        let mut bytes = frame.to_vec();
        if bytes.is_empty() || self.dice.roll(self.one_in) != 0 {
            return bytes;
        }
        let kind = self.dice.roll(4);
        self.injected[kind as usize] += 1;
        let at = self.dice.roll(bytes.len() as u32) as usize;
        match kind {
            0 => bytes[at] ^= 1 << self.dice.roll(8),
            1 => {
                bytes.remove(at);
            }
            2 => bytes.clear(),
            _ => bytes.extend_from_slice(frame),
        }
        bytes
    }
}

impl Bytes for Line {
    type Error = ();

    fn send(&mut self, bytes: &[u8]) -> Result<(), ()> {
        let mut out = Vec::new();
        for byte in self.disturb(bytes) {
            let mut answer = Vec::new();
            self.target.push(byte, &mut answer);
            out.extend(self.disturb(&answer));
        }
        self.inbox.extend(out);
        Ok(())
    }

    fn receive(&mut self, bytes: &mut [u8]) -> Result<usize, ()> {
        let count = bytes.len().min(self.inbox.len());
        for (place, byte) in bytes.iter_mut().zip(self.inbox.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}

#[test]
fn every_sample_is_processed_once_on_a_bad_line() {
    for seed in 1..=20 {
        let mut line = Line::new(seed, 5);
        // Starts just before the wrap of the sequence number.
        let mut exchange = Exchange::new(u32::MAX - 500, 50);
        let mut expected = 0.0f32;
        let mut last = None;
        for k in 0..2000u32 {
            let y = (k as f32 * 0.37).fract() - 0.5;
            expected = expected * 0.5 + y;
            let reply = exchange.exchange(&mut line, y, 0).expect("a reply");
            assert_eq!(
                reply.u.to_bits(),
                expected.to_bits(),
                "seed {seed}, sample {k}"
            );
            last = Some(reply);
        }
        let target = line.target.responder.counters();
        let host = exchange.counters();
        assert_eq!(line.target.processed, 2000, "seed {seed}");
        assert!(
            line.injected.iter().all(|&count| count > 50),
            "seed {seed}: {:?}",
            line.injected
        );
        // Every kind of fault is seen by somebody: damage by a check sum, loss by a timeout, doubles by the number.
        assert!(
            target.corrupt > 20 && host.corrupt > 20,
            "seed {seed}: {target:?} {host:?}"
        );
        assert!(host.lost > 100, "seed {seed}: {host:?}");
        assert!(target.repeated > 100, "seed {seed}: {target:?}");
        assert_eq!(target.lost, 0, "seed {seed}: the lockstep leaves no gap");
        assert!(last.expect("a reply").counters.repeated > 100);
    }
}

#[test]
fn a_clean_line_counts_nothing() {
    let mut line = Line::new(1, u32::MAX);
    let mut exchange = Exchange::new(0, 1);
    for k in 0..1000u32 {
        exchange.exchange(&mut line, k as f32, 0).expect("a reply");
    }
    assert_eq!(exchange.counters(), Counters::default());
    assert_eq!(line.target.responder.counters(), Counters::default());
}

#[test]
fn a_dead_line_is_an_error() {
    struct Dead(u32);
    impl Bytes for Dead {
        type Error = ();
        fn send(&mut self, _: &[u8]) -> Result<(), ()> {
            self.0 += 1;
            Ok(())
        }
        fn receive(&mut self, _: &mut [u8]) -> Result<usize, ()> {
            Ok(0)
        }
    }
    let mut line = Dead(0);
    let mut exchange = Exchange::new(9, 3);
    assert_eq!(
        exchange.exchange(&mut line, 0.0, 0),
        Err(ExchangeError::NoReply(9))
    );
    assert_eq!(line.0, 3);
    assert_eq!(exchange.counters().lost, 3);
}

#[test]
fn a_gap_and_an_old_frame_are_counted() {
    let mut target = Target::default();
    let mut out = Vec::new();
    for seq in [10, 13, 12] {
        for &byte in Frame::encode(&Sample {
            seq,
            y: 1.0,
            flags: 0,
        })
        .bytes()
        {
            target.push(byte, &mut out);
        }
    }
    assert_eq!(target.processed, 2);
    assert_eq!(
        target.responder.counters(),
        Counters {
            corrupt: 0,
            lost: 2,
            repeated: 1
        }
    );
}

#[test]
fn a_reset_clears_the_counters_and_takes_any_number() {
    let mut target = Target::default();
    let mut out = Vec::new();
    for (seq, flags) in [(10, 0), (13, 0), (5, flags::RESET), (5, flags::RESET)] {
        for &byte in Frame::encode(&Sample { seq, y: 1.0, flags }).bytes() {
            target.push(byte, &mut out);
        }
    }
    assert_eq!(
        target.processed, 3,
        "the repeated reset is answered from the cache"
    );
    assert_eq!(
        target.responder.counters(),
        Counters {
            corrupt: 0,
            lost: 0,
            repeated: 1
        }
    );
}

#[test]
fn the_layout_on_the_wire_is_as_documented() {
    let frame = Frame::encode(&Sample {
        seq: 300,
        y: 1.0,
        flags: 2,
    });
    // Body: 'S', 300 in 7-bit groups, 1.0f32 little endian, flags, check sum.
    let mut body = vec![0x53, 0xAC, 0x02, 0x00, 0x00, 0x80, 0x3F, 0x02];
    body.extend_from_slice(&crc32(&body).to_le_bytes());
    let mut wire = vec![0, 4, 0x53, 0xAC, 0x02, 1, 8];
    wire.extend_from_slice(&body[5..]);
    wire.push(0);
    assert!(
        !body[8..].contains(&0),
        "the example has no zero in its check sum"
    );
    assert_eq!(frame.bytes(), wire);
}

#[test]
fn the_longest_reply_fits() {
    let longest = Reply {
        seq: u32::MAX,
        u: -1.0,
        innovation: 1.0,
        parameters: [1.5; PARAMETERS].into_iter().collect(),
        status: u8::MAX,
        counters: Counters {
            corrupt: u32::MAX,
            lost: u32::MAX,
            repeated: u32::MAX,
        },
    };
    let frame = Frame::encode(&longest);
    assert!(!frame.bytes().is_empty());
    let mut receiver = Receiver::new();
    assert_eq!(
        frame.bytes().iter().find_map(|&byte| receiver.push(byte)),
        Some(longest)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn every_bit_pattern_survives(seq: u32, bits: u32, flags: u8) {
        let sent = Sample { seq, y: f32::from_bits(bits), flags };
        let mut receiver = Receiver::<Sample>::new();
        let frame = Frame::encode(&sent);
        let got = frame.bytes().iter().find_map(|&byte| receiver.push(byte)).expect("a message");
        prop_assert_eq!((got.seq, got.y.to_bits(), got.flags), (seq, bits, flags));
    }

    #[test]
    fn one_or_two_wrong_bits_never_pass(seq: u32, bits: u32, first: prop::sample::Index, second: prop::sample::Index) {
        let frame = Frame::encode(&Sample { seq, y: f32::from_bits(bits), flags: 0 });
        let mut wire = frame.bytes().to_vec();
        let count = wire.len() * 8;
        for at in [first.index(count), second.index(count)] {
            wire[at / 8] ^= 1 << (at % 8);
        }
        prop_assume!(wire != frame.bytes());
        let mut receiver = Receiver::<Sample>::new();
        let got: Vec<_> = wire.iter().chain(&[0]).filter_map(|&byte| receiver.push(byte)).collect();
        // Damage of the outer delimiters alone may leave the body whole; then it must be the body that was sent.
        for sample in got {
            prop_assert_eq!((sample.seq, sample.y.to_bits()), (seq, bits));
        }
    }

    #[test]
    fn noise_never_panics_and_the_next_frame_gets_through(noise: Vec<u8>) {
        let mut receiver = Receiver::<Sample>::new();
        for byte in noise {
            let _ = receiver.push(byte);
        }
        let sent = Sample { seq: 1, y: 2.0, flags: 0 };
        let got = Frame::encode(&sent).bytes().iter().find_map(|&byte| receiver.push(byte));
        prop_assert_eq!(got, Some(sent));
    }
}
