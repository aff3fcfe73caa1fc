//! What waits for the line: frames in a ring of bytes, and events until they are acknowledged.

use heapless::Deque;

use crate::telemetry::{Content, Event, Notice, NumberedEvent};
use crate::{Frame, MAX_WIRE};

/// Bytes that wait for the line at most.
pub const OUTBOX: usize = 1024;

/// Events that wait for their acknowledgement at most; the oldest goes when one more comes.
pub const EVENTS: usize = 16;

/// Room that samples leave for events and answers.
const RESERVE: usize = 3 * MAX_WIRE;

/// Frames on their way to the line.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    bytes: Deque<u8, OUTBOX>,
    seq: u16,
    start: u16,
    pub(super) dropped: u32,
    events: Deque<NumberedEvent, EVENTS>,
    /// Number of the next event, and of the first that was not sent yet.
    next: u32,
    unsent: u32,
    pub(super) events_lost: u32,
}

impl Outbox {
    /// An empty one of the start `start`.
    pub(super) const fn new(start: u16) -> Self {
        Self {
            bytes: Deque::new(),
            seq: 0,
            start,
            dropped: 0,
            events: Deque::new(),
            next: 0,
            unsent: 0,
            events_lost: 0,
        }
    }

    /// Puts what may be dropped.
    pub(super) fn offer(&mut self, content: Content) {
        if !self.fits(content) {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Puts what waits for the room that samples have; whether it was there.
    pub(super) fn fits(&mut self, content: Content) -> bool {
        self.put(content, RESERVE)
    }

    /// Puts what must arrive; whether there was room.
    pub(super) fn urge(&mut self, content: Content) -> bool {
        self.put(content, 0)
    }

    fn put(&mut self, content: Content, reserve: usize) -> bool {
        if OUTBOX - self.bytes.len() < reserve + MAX_WIRE {
            return false;
        }
        let frame = Frame::encode(&Notice {
            seq: self.seq,
            content,
        });
        self.seq = self.seq.wrapping_add(1);
        for &byte in frame.bytes() {
            // There is room for the longest frame.
            let _ = self.bytes.push_back(byte);
        }
        true
    }

    /// Keeps an event until it is acknowledged.
    pub(super) fn keep(&mut self, tick: u32, event: Event) {
        let numbered = NumberedEvent {
            start: self.start,
            number: self.next,
            oldest: self.next,
            tick,
            event,
        };
        self.next = self.next.wrapping_add(1);
        if self.events.is_full() {
            let _ = self.events.pop_front();
            self.events_lost = self.events_lost.saturating_add(1);
        }
        let _ = self.events.push_back(numbered);
    }

    /// Sends the events that were not sent yet, as far as there is room.
    pub(super) fn post(&mut self) {
        while let Some(event) = self
            .events
            .iter()
            .find(|event| !is_before(event.number, self.unsent))
        {
            let number = event.number;
            let oldest = self.events.front().map_or(number, |first| first.number);
            let event = NumberedEvent {
                oldest,
                ..event.clone()
            };
            if !self.urge(Content::Event(event)) {
                return;
            }
            self.unsent = number.wrapping_add(1);
        }
    }

    /// Sends all events again that are not acknowledged.
    pub(super) fn again(&mut self) {
        if let Some(first) = self.events.front() {
            self.unsent = first.number;
        }
    }

    /// Events up to `number` have arrived.
    pub(super) fn heard(&mut self, number: u32) {
        // A number that was never given acknowledges nothing.
        if !is_before(number, self.next) {
            return;
        }
        while let Some(first) = self.events.front()
            && !is_before(number, first.number)
        {
            let _ = self.events.pop_front();
        }
    }

    pub(super) fn next_byte(&mut self) -> Option<u8> {
        self.bytes.pop_front()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

/// Whether `a` comes before `b` in numbers that wrap.
const fn is_before(a: u32, b: u32) -> bool {
    a.wrapping_sub(b).cast_signed() < 0
}
