//! The wire between a computer and the controller on a microcontroller: telemetry and requests, and
//! processor in the loop.
//!
//! # Telemetry
//!
//! The controller runs in its own time; [`telemetry::Station`] sends what it does and takes
//! requests, a [`telemetry::Client`] on the computer receives and asks.
//!
//! # Lockstep
//!
//! For the processor in the loop time stands still between samples. Every sample the host sends one
//! [`Sample`] (the position code, and what is asked of the loop) and waits for the [`Reply`] with
//! the same sequence number (the next valve command and everything the loop knows). Time stands
//! still on both sides until the reply is there, so a lost or corrupt frame costs real time and
//! changes no number: the host sends the same sample again after a timeout, and the target answers
//! a repeated sequence number from its cache without processing the sample twice.
//!
//! # The loop
//!
//! [`Controller`] runs [`trendid::servo::ServoLoop`] on the target behind a [`Responder`]; the same
//! loop runs on the host beside an [`Exchange`], and [`Reply::of`] reports the same of both: every
//! number must be the same to the last bit.
//!
//! # Byte layout
//!
//! ```text
//! wire    00 | COBS( tag  version  payload  crc ) | 00
//! tag     1 byte: lockstep 0x53 'S' host to target, 0x52 'R' target to host; telemetry 0x4F 'O' and 0x4E 'N'
//! version 1 byte: [`VERSION`]
//! payload postcard encoding of the message, fields in the order of the structure:
//!           u32   variable length, 7 bits a byte, low bits first, bit 7 = more follows (1 to 5 bytes)
//!           i32   zigzag (0, -1, 1, -2, .. become 0, 1, 2, 3, ..), then as u32
//!           f32   4 bytes, little endian, the bits as they are (NaN and -0 survive)
//!           u8    1 byte; bool likewise, 0 or 1
//!           Option  0, or 1 and the value
//!           enum  number of the variant as u32, then its fields
//!           array the elements
//!           Vec   number of elements as u32, then the elements
//! crc     4 bytes, little endian: CRC-32 (IEEE 802.3, reflected 0xEDB88320) of tag, version and payload
//! ```
//!
//! Consistent overhead byte stuffing removes every zero from the body, so a zero is always a
//! delimiter. The leading zero ends whatever debris an earlier fault left in the receiver; empty
//! frames are ignored.
//!
//! ```
//! use trendid_link::{Frame, Receiver, Sample};
//!
//! let sample = Sample { seq: 7, code: Some(-25), ..Sample::default() };
//! let frame = Frame::encode(&sample);
//! let mut receiver = Receiver::<Sample>::new();
//! let received = frame.bytes().iter().find_map(|&byte| receiver.push(byte));
//! assert_eq!(received, Some(sample));
//! assert_eq!(receiver.corrupt(), 0);
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod controller;
mod frame;
mod lockstep;
mod message;
pub mod telemetry;

pub use controller::Controller;
pub use frame::{Frame, MAX_BODY, MAX_WIRE, Receiver, VERSION};
pub use lockstep::{Bytes, Exchange, ExchangeError, Incoming, Responder};
pub use message::{Counters, FIELDS, Message, REQUESTS, Reply, Request, Sample, Setup, code};
