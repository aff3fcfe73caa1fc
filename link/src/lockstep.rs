//! Both ends of the lockstep: retransmission on the host, the cached answer on the target.

use crate::{Counters, Frame, Receiver, Reply, Sample};

/// Duty of the target for a sample that came in.
#[derive(Clone, Debug, PartialEq)]
pub enum Incoming {
    /// A new sample: process it, then call [`Responder::answer`].
    New(Sample),
    /// The last sample came again: send the bytes of [`Responder::cached`] and process nothing.
    Repeated,
    /// A frame that is older than the last sample: send nothing.
    Stale,
}

/// The target's end: receives samples, counts faults, remembers the last answer.
#[derive(Clone, Debug, Default)]
pub struct Responder {
    receiver: Receiver<Sample>,
    counters: Counters,
    last: Option<u32>,
    answer: Option<Frame>,
}

impl Responder {
    /// A responder that waits for the first sample.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one byte from the line; gives what to do when it ends an intact frame.
    pub fn push(&mut self, byte: u8) -> Option<Incoming> {
        let sample = self.receiver.push(byte)?;
        let reset = sample.is_reset();
        // Distance in serial-number arithmetic, so that the wrap of the number is no gap.
        let ahead = self
            .last
            .map(|last| sample.seq.wrapping_sub(last).cast_signed());
        Some(match ahead {
            Some(0) if self.answer.is_some() => {
                self.counters.repeated = self.counters.repeated.saturating_add(1);
                Incoming::Repeated
            }
            _ if reset => {
                self.counters = Counters::default();
                self.receiver.clear();
                self.accept(sample)
            }
            Some(ahead) if ahead > 0 => {
                self.counters.lost = self.counters.lost.saturating_add(ahead.cast_unsigned() - 1);
                self.accept(sample)
            }
            None => self.accept(sample),
            Some(_) => {
                self.counters.repeated = self.counters.repeated.saturating_add(1);
                Incoming::Stale
            }
        })
    }

    /// Encodes and remembers the answer to the last new sample; gives the bytes to send.
    ///
    /// Sequence number and counters of `reply` are filled in here.
    pub fn answer(&mut self, mut reply: Reply) -> &[u8] {
        reply.seq = self.last.unwrap_or(reply.seq);
        reply.counters = self.counters();
        self.answer.insert(Frame::encode(&reply)).bytes()
    }

    /// The bytes of the last answer; empty before the first.
    #[must_use]
    pub fn cached(&self) -> &[u8] {
        self.answer.as_ref().map_or(&[], Frame::bytes)
    }

    /// Faults since the start of the run.
    #[must_use]
    pub fn counters(&self) -> Counters {
        Counters {
            corrupt: self.receiver.corrupt(),
            ..self.counters
        }
    }

    fn accept(&mut self, sample: Sample) -> Incoming {
        self.last = Some(sample.seq);
        self.answer = None;
        Incoming::New(sample)
    }
}

/// The line as the host sees it.
pub trait Bytes {
    /// Error of the line.
    type Error;

    /// Sends all bytes.
    ///
    /// # Errors
    /// The error of the line.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// Waits for bytes, one timeout long at most; gives their number, zero after the timeout.
    ///
    /// # Errors
    /// The error of the line.
    fn receive(&mut self, bytes: &mut [u8]) -> Result<usize, Self::Error>;
}

/// Why the host got no reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExchangeError<E> {
    /// The line failed.
    Line(E),
    /// No reply to the sample with this number after all attempts.
    NoReply(u32),
}

/// The host's end: sends a sample until its reply is there.
#[derive(Clone, Debug)]
pub struct Exchange {
    receiver: Receiver<Reply>,
    seq: u32,
    attempts: u32,
    counters: Counters,
}

impl Exchange {
    /// Starts at sequence number `seq`; each sample is sent `attempts` times at most.
    ///
    /// Two runs on the same target need different first numbers, or the first sample of the second
    /// run is taken for a repetition.
    #[must_use]
    pub fn new(seq: u32, attempts: u32) -> Self {
        Self {
            receiver: Receiver::new(),
            seq,
            attempts,
            counters: Counters::default(),
        }
    }

    /// Faults seen by the host: corrupt replies, timeouts (`lost`), replies to earlier samples
    /// (`repeated`).
    #[must_use]
    pub fn counters(&self) -> Counters {
        Counters {
            corrupt: self.receiver.corrupt(),
            ..self.counters
        }
    }

    /// Sends `sample` and gives the reply to it; its number is filled in here.
    ///
    /// # Errors
    /// [`ExchangeError::Line`] when the line fails, [`ExchangeError::NoReply`] after the last
    /// attempt.
    pub fn exchange<L: Bytes>(
        &mut self,
        line: &mut L,
        mut sample: Sample,
    ) -> Result<Reply, ExchangeError<L::Error>> {
        let seq = self.seq;
        sample.seq = seq;
        let frame = Frame::encode(&sample);
        let mut buffer = [0; 64];
        for _ in 0..self.attempts {
            line.send(frame.bytes()).map_err(ExchangeError::Line)?;
            loop {
                let count = line.receive(&mut buffer).map_err(ExchangeError::Line)?;
                if count == 0 {
                    self.counters.lost = self.counters.lost.saturating_add(1);
                    break;
                }
                let mut found = None;
                for &byte in &buffer[..count] {
                    match self.receiver.push(byte) {
                        Some(reply) if reply.seq == seq => found = Some(reply),
                        Some(_) => {
                            self.counters.repeated = self.counters.repeated.saturating_add(1)
                        }
                        None => {}
                    }
                }
                if let Some(reply) = found {
                    self.seq = seq.wrapping_add(1);
                    return Ok(reply);
                }
            }
        }
        Err(ExchangeError::NoReply(seq))
    }
}
