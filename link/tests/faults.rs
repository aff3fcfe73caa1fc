//! The lockstep over a line that corrupts, drops and repeats bytes and frames.

use std::collections::VecDeque;

use proptest::prelude::*;
use trendid_link::*;

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
    /// Wraps: a sum in which every sample and their order leave a trace.
    sum: i32,
}

impl Target {
    fn push(&mut self, byte: u8, out: &mut Vec<u8>) {
        match self.responder.push(byte) {
            Some(Incoming::New(sample)) => {
                self.processed += 1;
                self.sum = mix(self.sum, &sample);
                let reply = reply(self.sum);
                out.extend_from_slice(self.responder.answer(reply));
            }
            Some(Incoming::Repeated) => out.extend_from_slice(self.responder.cached()),
            Some(Incoming::Stale) | None => {}
        }
    }
}

fn mix(sum: i32, sample: &Sample) -> i32 {
    sum.wrapping_mul(31).wrapping_add(sample.code.unwrap_or(7))
}

fn reply(sum: i32) -> Reply {
    let x = f32::from_bits(sum.cast_unsigned());
    Reply {
        seq: 0,
        state: 1,
        reason: code::NO_REASON,
        retuned: true,
        command: x,
        position: -x,
        setpoint: [x, 0.0, -0.0, f32::NAN],
        innovation: (sum % 2 == 0).then_some(x),
        motion: [x; 3],
        disturbance: 0.0,
        model: [x; 6],
        theta: [-x; 6],
        counters: Counters::default(),
    }
}

/// A sample with this code and nothing asked.
fn plain(seq: u32, code: i32) -> Sample {
    Sample {
        seq,
        code: Some(code),
        ..Sample::default()
    }
}

/// A sample that begins a run.
fn reset(seq: u32) -> Sample {
    let setup = Setup {
        bandwidth: 25.0,
        travel: [0.0, 400.0],
        mm_per_count: 0.01,
        adaptive: true,
    };
    let mut sample = plain(seq, 1);
    sample.requests.push(Request::Reset(setup)).expect("room");
    sample
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
        let mut expected = 0;
        let mut last = None;
        for k in 0..2000u32 {
            let mut sample = plain(0, k.wrapping_mul(0x9E37_79B9).cast_signed());
            if k % 11 == 0 {
                sample.code = None;
            }
            expected = mix(expected, &sample);
            let got = exchange.exchange(&mut line, sample).expect("a reply");
            assert_eq!(
                got.fields(),
                reply(expected).fields(),
                "seed {seed}, sample {k}"
            );
            last = Some(got);
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
        exchange
            .exchange(&mut line, plain(0, k.cast_signed()))
            .expect("a reply");
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
        exchange.exchange(&mut line, plain(0, 0)),
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
        for &byte in Frame::encode(&plain(seq, 1)).bytes() {
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
    for sample in [plain(10, 1), plain(13, 1), reset(5), reset(5)] {
        for &byte in Frame::encode(&sample).bytes() {
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
    let mut sample = plain(300, -25);
    sample.requests.push(Request::MoveTo(1.0)).expect("room");
    let frame = Frame::encode(&sample);
    // 'S', the version, 300 in 7-bit groups, a code, -25 in zigzag, one request: the fourth, 1.0f32 little endian, check sum.
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
        // Damage of the outer delimiters alone may leave the body whole; then it must be the body that was sent.
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
