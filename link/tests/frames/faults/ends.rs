//! The target behind a line with faults.

use std::collections::VecDeque;

use trendid_link::*;

use crate::dice::Dice;

/// The target as the firmware has it: a state that shows every sample that was processed, and how
/// often.
#[derive(Default)]
pub(crate) struct Target {
    pub(crate) responder: Responder,
    pub(crate) processed: u32,
    /// Wraps: a sum in which every sample and their order leave a trace.
    pub(crate) sum: i32,
}

impl Target {
    pub(crate) fn push(&mut self, byte: u8, out: &mut Vec<u8>) {
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

pub(crate) fn mix(sum: i32, sample: &Sample) -> i32 {
    sum.wrapping_mul(31).wrapping_add(sample.code.unwrap_or(7))
}

pub(crate) fn reply(sum: i32) -> Reply {
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
pub(crate) fn plain(seq: u32, code: i32) -> Sample {
    Sample {
        seq,
        code: Some(code),
        ..Sample::default()
    }
}

/// A sample that begins a run.
pub(crate) fn reset(seq: u32) -> Sample {
    let setup = Setup {
        bandwidth: 25.0,
        travel: [0.0, 400.0],
        mm_per_count: 0.01,
        dead_volume: None,
        adaptive: true,
    };
    let mut sample = plain(seq, 1);
    sample.requests.push(Request::Reset(setup)).expect("room");
    sample
}

/// The line to the target, with one fault in `one_in` frames in each direction.
pub(crate) struct Line {
    pub(crate) target: Target,
    pub(crate) dice: Dice,
    pub(crate) one_in: u32,
    pub(crate) injected: [u32; 4],
    pub(crate) inbox: VecDeque<u8>,
}

impl Line {
    pub(crate) fn new(seed: u64, one_in: u32) -> Self {
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
