//! What a running controller tells, and what may be asked of it.
//!
//! ```text
//! target   Station  --- Notice: samples, estimate, health, events, answers --->  Client   host
//!                   <-- Order: requests, one at a time, each answered --------
//! ```
//!
//! | content | when | when the line is full |
//! |---|---|---|
//! | [`Sample`] | every n-th sample, n by request | dropped and counted |
//! | [`Learned`], [`Health`] | ten times a second | dropped and counted |
//! | [`Event`] | at once, and again until it is acknowledged | waits |
//! | [`Answer`] | to each order, done or refused with its reason | waits |
//!
//! # What holds on a bad line
//!
//! - A frame that is damaged, of another version, or cut short changes nothing but a counter.
//! - An order that comes again is answered again and carried out once.
//! - An order carries the tick of the newest sample that its sender saw. What moves the axis is
//!   refused when that is older than [`STALE_MS`]: bytes that were kept somewhere and arrive later
//!   move nothing.
//! - A watchdog can be asked for: without an intact order for that long the station asks the
//!   machine to stop, once for each silence.
//! - What a start of the target was asked is not done in the next one: it acknowledges neither the
//!   events nor the fault of that.
//! - The slot never waits: what does not fit into the outbox of [`OUTBOX`] bytes is dropped
//!   (samples) or waits (the rest).
//!
//! [`operate`] carries requests out on a [`ServoLoop`](trendid::servo::ServoLoop); [`settings`] is
//! the table of what may be set.

mod client;
mod notice;
mod operate;
mod outbox;
mod reading;
mod reasons;
mod request;
pub mod settings;
mod station;
mod text;

pub use client::{Client, Heard, Losses};
pub use notice::{Content, Event, Identity, Notice, NumberedEvent};
pub use operate::{Machine, operate};
pub use outbox::{EVENTS, OUTBOX};
pub use reading::{Health, Learned, Sample};
pub use reasons::{reason_of, state_of};
pub use request::{Answer, Order, Outcome, Refusal, Request, SettingValue, Trick};
pub use station::{STALE_MS, Station, Wanted};
pub use text::{Text, text};
