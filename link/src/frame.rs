//! Encoding of a message into a frame, and the incremental receiver.

use core::marker::PhantomData;

use crate::{Message, cobs, crc32};

/// Longest body (tag, payload and check sum) in bytes.
pub const MAX_BODY: usize = 128;

// Up to here the stuffing takes one byte and splits no run.
const _: () = assert!(MAX_BODY < 254);

/// Longest frame on the wire in bytes: body, one byte of stuffing, two delimiters.
pub const MAX_WIRE: usize = MAX_BODY + 3;

const CRC: usize = 4;

/// One encoded frame with its delimiters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    wire: [u8; MAX_WIRE],
    len: usize,
}

impl Frame {
    /// Encodes `message`.
    ///
    /// Every message of this crate fits ([`MAX_BODY`]); a longer message of another crate gives a frame without bytes.
    #[must_use]
    pub fn encode<M: Message>(message: &M) -> Self {
        let mut body = [0; MAX_BODY];
        body[0] = M::TAG;
        let mut frame = Self {
            wire: [0; MAX_WIRE],
            len: 0,
        };
        let Ok(payload) = postcard::to_slice(message, &mut body[1..MAX_BODY - CRC]) else {
            return frame;
        };
        let end = 1 + payload.len();
        let crc = crc32(&body[..end]);
        body[end..end + CRC].copy_from_slice(&crc.to_le_bytes());
        // wire[0] and the byte after the stuffed body stay zero: the delimiters.
        frame.len = cobs::encode(&body[..end + CRC], &mut frame.wire[1..]) + 2;
        frame
    }

    /// The bytes to send.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.wire[..self.len]
    }
}

/// Finds the messages in a stream of bytes and counts the frames that are damaged.
#[derive(Clone, Debug)]
pub struct Receiver<M> {
    body: [u8; MAX_BODY],
    len: usize,
    overlong: bool,
    stuffing: cobs::Decoder,
    corrupt: u32,
    message: PhantomData<M>,
}

impl<M: Message> Receiver<M> {
    /// A receiver that has seen nothing.
    #[must_use]
    pub fn new() -> Self {
        Self {
            body: [0; MAX_BODY],
            len: 0,
            overlong: false,
            stuffing: cobs::Decoder::default(),
            corrupt: 0,
            message: PhantomData,
        }
    }

    /// Takes one byte; gives the message when the byte ends an intact frame.
    pub fn push(&mut self, byte: u8) -> Option<M> {
        if byte != 0 {
            if let Some(byte) = self.stuffing.push(byte) {
                match self.body.get_mut(self.len) {
                    Some(place) => {
                        *place = byte;
                        self.len += 1;
                    }
                    None => self.overlong = true,
                }
            }
            return None;
        }
        if self.stuffing.is_empty() {
            return None;
        }
        let message = self.message();
        if message.is_none() {
            self.corrupt = self.corrupt.saturating_add(1);
        }
        self.len = 0;
        self.overlong = false;
        self.stuffing = cobs::Decoder::default();
        message
    }

    /// Number of damaged frames since the start or the last [`clear`](Self::clear); saturates.
    #[must_use]
    pub fn corrupt(&self) -> u32 {
        self.corrupt
    }

    /// Sets the count of damaged frames to zero.
    pub fn clear(&mut self) {
        self.corrupt = 0;
    }

    fn message(&self) -> Option<M> {
        if self.overlong || !self.stuffing.complete() {
            return None;
        }
        let (body, crc) = self.body[..self.len].split_last_chunk::<CRC>()?;
        let (&tag, payload) = body.split_first()?;
        if tag != M::TAG || crc32(body) != u32::from_le_bytes(*crc) {
            return None;
        }
        // A payload with bytes left over is a frame of another version.
        match postcard::take_from_bytes(payload) {
            Ok((message, [])) => Some(message),
            _ => None,
        }
    }
}

impl<M: Message> Default for Receiver<M> {
    fn default() -> Self {
        Self::new()
    }
}
