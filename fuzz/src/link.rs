//! The bytes of a line: frames that were sent, damaged on the way, and anything between them.

use trendid_link::{
    Controller, Frame, Incoming, Message, Receiver, Reply, Request, Responder, Sample, Setup,
};

use crate::bytes::Bytes;

/// Wrong bits of a frame: its check finds any three.
const FLIPS: u8 = 3;

fn request(bytes: &mut Bytes<'_>) -> Request {
    match bytes.choice(6) {
        0 => Request::Commission,
        1 => Request::Abort,
        2 => Request::MoveTo(bytes.signal(400.0)),
        3 => Request::Oscillate {
            amplitude: bytes.signal(20.0),
            frequency: bytes.signal(2.0),
        },
        4 => Request::Reset(Setup {
            bandwidth: 20.0 * bytes.decades(1.0),
            travel: [0.0, 400.0],
            mm_per_count: 0.005,
            dead_volume: None,
            adaptive: bytes.byte() & 1 == 0,
        }),
        _ => Request::Reset(Setup {
            bandwidth: bytes.any(),
            travel: [bytes.signal(400.0), bytes.signal(400.0)],
            mm_per_count: bytes.any(),
            dead_volume: Some(bytes.any()),
            adaptive: true,
        }),
    }
}

fn sample(bytes: &mut Bytes<'_>, seq: u32) -> Sample {
    let mut sample = Sample {
        seq,
        code: (bytes.byte() < 250).then(|| i32::from(i16::from_le_bytes(bytes.take()))),
        ..Sample::default()
    };
    if bytes.byte() >= 250 {
        sample.code = Some(i32::from_le_bytes(bytes.take()));
    }
    for _ in 0..bytes.choice(8).saturating_sub(3) {
        // What has no room is not asked.
        let _ = sample.requests.push(request(bytes));
    }
    sample
}

/// Whether two messages say the same, bit by bit. NaN equals itself by its text, which takes long:
/// it is asked where the numbers differ.
fn same<M: Message + std::fmt::Debug + PartialEq>(one: &M, other: &M) -> bool {
    Frame::encode(one) == Frame::encode(other)
        && (one == other || format!("{one:?}") == format!("{other:?}"))
}

/// The target at the end of the line.
struct Target {
    responder: Responder,
    controller: Controller,
    host: Receiver<Reply>,
    /// Messages that were sent, without those that the fuzzer may have made up itself.
    sent: Vec<Sample>,
    /// Whether bytes were on the line that no host sent.
    debris: bool,
}

impl Target {
    fn receive(&mut self, wire: &[u8]) {
        for &byte in wire {
            match self.responder.push(byte) {
                Some(Incoming::New(sample)) => self.process(&sample),
                Some(Incoming::Repeated) => assert!(!self.responder.cached().is_empty()),
                Some(Incoming::Stale) | None => {}
            }
        }
    }

    fn process(&mut self, sample: &Sample) {
        let sent = || self.sent.iter().rev().any(|other| same(other, sample));
        assert!(self.debris || sent(), "nobody sent {sample:?}");
        let reply = self.controller.update(sample);
        for number in [reply.command, reply.position, reply.disturbance]
            .into_iter()
            .chain(reply.innovation)
            .chain(reply.setpoint)
            .chain(reply.motion)
            .chain(reply.model)
            .chain(reply.theta)
        {
            assert!(number.is_finite(), "{reply:?}");
        }
        assert!((-1.0..=1.0).contains(&reply.command));
        let mut answer = self.responder.answer(reply.clone()).to_vec();
        assert!(!answer.is_empty() && answer.len() <= trendid_link::MAX_WIRE);
        let (seq, counters) = (sample.seq, self.responder.counters());
        let back = answer.drain(..).find_map(|byte| self.host.push(byte));
        let expected = Reply {
            seq,
            counters,
            ..reply
        };
        assert!(
            back.as_ref().is_some_and(|back| same(back, &expected)),
            "{back:?} for {expected:?}"
        );
    }
}

/// Runs what the bytes say.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let mut target = Target {
        responder: Responder::new(),
        controller: Controller::new(),
        host: Receiver::new(),
        sent: Vec::new(),
        debris: false,
    };
    let mut seq = u32::from_le_bytes(bytes.take());
    while !bytes.is_empty() {
        match bytes.byte() {
            0..=31 => {
                target.debris = true;
                let wire: Vec<u8> = (0..bytes.byte()).map(|_| bytes.byte()).collect();
                target.receive(&wire);
            }
            kind => {
                seq = seq.wrapping_add(u32::from(bytes.byte() / 100));
                let sample = sample(&mut bytes, seq);
                let mut wire = Frame::encode(&sample).bytes().to_vec();
                assert!(!wire.is_empty(), "every message fits");
                target.sent.push(sample);
                damage(&mut wire, kind, &mut bytes);
                target.receive(&wire);
            }
        }
    }
}

/// What a line does to a frame.
fn damage(wire: &mut Vec<u8>, kind: u8, bytes: &mut Bytes<'_>) {
    match kind {
        32..=63 => {
            for _ in 0..bytes.choice(FLIPS + 1) {
                let place = usize::from(bytes.byte()) % wire.len();
                wire[place] ^= 1 << bytes.choice(8);
            }
        }
        64..=79 => {
            wire.remove(usize::from(bytes.byte()) % wire.len());
        }
        80..=95 => wire.truncate(usize::from(bytes.byte()) % wire.len()),
        96..=111 => wire.extend_from_within(..),
        _ => {}
    }
}
