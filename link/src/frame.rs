//! Encoding of a message into a frame, and the incremental receiver.

use core::marker::PhantomData;

use cobs::{DecodeResult, DecoderState};
use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;

use crate::Message;

/// Second byte of every body: a receiver refuses frames of another version. It changes with the
/// layout of any message.
pub const VERSION: u8 = 3;

/// Longest body (tag, version, payload and check sum) in bytes.
pub const MAX_BODY: usize = 128;

// Up to here the stuffing takes one byte and splits no run.
const _: () = assert!(MAX_BODY < 254);

/// Longest body with its byte of stuffing.
const MAX_STUFFED: usize = MAX_BODY + 1;

/// Longest frame on the wire in bytes: body, one byte of stuffing, two delimiters.
pub const MAX_WIRE: usize = MAX_STUFFED + 2;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// One encoded frame with its delimiters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    wire: [u8; MAX_WIRE],
    len: usize,
}

impl Frame {
    /// Encodes `message`.
    ///
    /// Every message of this crate fits ([`MAX_BODY`]); a longer message of another crate gives a
    /// frame without bytes.
    #[must_use]
    pub fn encode<M: Message>(message: &M) -> Self {
        let mut body = [0; MAX_BODY];
        let mut wire = [0; MAX_WIRE];
        // The first byte and the one after the stuffed body stay zero: the delimiters.
        let stuffed =
            postcard::to_slice_crc32(&(M::TAG, VERSION, message), &mut body, CRC.digest())
                .ok()
                .and_then(|body| cobs::try_encode(body, &mut wire[1..]).ok());
        let len = stuffed.map_or(0, |len| len + 2);
        Self { wire, len }
    }

    /// The bytes to send.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.wire.get(..self.len).unwrap_or_default()
    }
}

/// Finds the messages in a stream of bytes and counts the frames that are damaged.
#[derive(Clone, Debug)]
pub struct Receiver<M> {
    stuffed: Vec<u8, MAX_STUFFED>,
    overlong: bool,
    corrupt: u32,
    message: PhantomData<M>,
}

impl<M: Message> Receiver<M> {
    /// A receiver that has seen nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            stuffed: Vec::new(),
            overlong: false,
            corrupt: 0,
            message: PhantomData,
        }
    }

    /// Takes one byte; gives the message when the byte ends an intact frame.
    pub fn push(&mut self, byte: u8) -> Option<M> {
        if byte != 0 {
            self.overlong |= self.stuffed.push(byte).is_err();
            return None;
        }
        if self.stuffed.is_empty() {
            return None;
        }
        let message = self.message();
        if message.is_none() {
            self.corrupt = self.corrupt.saturating_add(1);
        }
        self.stuffed.clear();
        self.overlong = false;
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
        if self.overlong {
            return None;
        }
        let body = self.body()?;
        // A body with bytes left over is a frame of another version.
        match postcard::take_from_bytes_crc32::<(u8, u8, M)>(&body, CRC.digest()) {
            Ok(((tag, VERSION, message), [])) if tag == M::TAG => Some(message),
            _ => None,
        }
    }

    /// The body without stuffing. Byte by byte, because the decoder of slices has indices that are
    /// checked: a panic would be reachable.
    fn body(&self) -> Option<Vec<u8, MAX_BODY>> {
        let mut body = Vec::new();
        let mut decoder = DecoderState::Idle;
        for &byte in &self.stuffed {
            if let DecodeResult::DataContinue(byte) = decoder.feed(byte).ok()? {
                body.push(byte).ok()?;
            }
        }
        match decoder.feed(0) {
            Ok(DecodeResult::DataComplete) => Some(body),
            _ => None,
        }
    }
}

impl<M: Message> Default for Receiver<M> {
    fn default() -> Self {
        Self::new()
    }
}
