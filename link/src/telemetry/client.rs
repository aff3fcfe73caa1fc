//! The host's end.

use heapless::Deque;

use crate::telemetry::{Answer, Content, Notice, NumberedEvent, Order, Request};
use crate::{Frame, MAX_WIRE, Receiver};

/// Orders that wait at most.
const WAITING: usize = 64;

/// Time after which an order is sent again, and how often, in ms.
const AGAIN_MS: u64 = 200;
const ATTEMPTS: u32 = 5;

/// What came in, besides what the client answers itself.
pub type Heard = Content;

/// What was lost on the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Notices whose number never came.
    pub lost: u32,
    /// Damaged frames.
    pub corrupt: u32,
    /// Orders that were never answered.
    pub unanswered: u32,
}

/// The host's end: numbers orders, sends one at a time until it is answered, acknowledges events,
/// counts losses. A stop goes before all that waits.
#[derive(Clone, Debug)]
pub struct Client {
    receiver: Receiver<Notice>,
    next_id: u32,
    seen: u32,
    seq: Option<u16>,
    /// Start of the target, and number of the next event of it.
    event: Option<(u16, u32)>,
    waiting: Deque<Order, WAITING>,
    /// When the first order was sent last, and how often.
    sent: Option<(u64, u32)>,
    bytes: Deque<u8, { 2 * MAX_WIRE }>,
    losses: Losses,
    given_up: Deque<u32, WAITING>,
}

impl Client {
    /// A client whose orders are numbered from `first`, which should differ from run to run.
    #[must_use]
    pub const fn new(first: u32) -> Self {
        Self {
            receiver: Receiver::new(),
            next_id: first,
            seen: 0,
            seq: None,
            event: None,
            waiting: Deque::new(),
            sent: None,
            bytes: Deque::new(),
            losses: Losses {
                lost: 0,
                corrupt: 0,
                unanswered: 0,
            },
            given_up: Deque::new(),
        }
    }

    /// Asks for something; gives the number of the order, `None` when too many wait.
    ///
    /// A [`Request::Stop`] is sent at once, since what waits may wait for a line that brings no
    /// answers, and is never one too many. One that was not sent yet is the same order; one that
    /// was is given up for the new one, since it may be done already, and the axis move again. What
    /// was asked before it and moves the axis is given up, and what must not be done twice.
    pub fn ask(&mut self, request: Request) -> Option<u32> {
        if request == Request::Stop {
            return Some(self.stop());
        }
        let id = self.next_id;
        let order = Order {
            id,
            seen: self.seen,
            request,
        };
        self.waiting.push_back(order).ok()?;
        self.next_id = id.wrapping_add(1);
        Some(id)
    }

    fn stop(&mut self) -> u32 {
        let is_stop = |order: &Order| order.request == Request::Stop;
        let known = self.waiting.iter().find(|order| is_stop(order));
        let known = known.filter(|_| self.sent.is_none());
        let id = known.map_or(self.next_id, |order| order.id);
        if known.is_none() {
            self.next_id = id.wrapping_add(1);
            // What is on its way is sent again behind the stop.
            self.sent = None;
        }
        let mut kept = Deque::new();
        // There is room: the stop takes no place but its own, and the last one makes it.
        let _ = kept.push_back(Order {
            id,
            seen: self.seen,
            request: Request::Stop,
        });
        while let Some(order) = self.waiting.pop_front() {
            let number = order.id;
            if number == id {
                continue;
            }
            let once =
                is_stop(&order) || matches!(order.request, Request::Acknowledge | Request::Store);
            let again = !order.request.moves() && !once;
            if !again || kept.push_back(order).is_err() {
                self.give_up(number);
            }
        }
        self.waiting = kept;
        id
    }

    fn give_up(&mut self, order: u32) {
        self.losses.unanswered = self.losses.unanswered.saturating_add(1);
        // Nobody asked for the oldest ones.
        if self.given_up.is_full() {
            let _ = self.given_up.pop_front();
        }
        let _ = self.given_up.push_back(order);
    }

    /// Whether no order waits: then [`Request::Alive`] says what any order does.
    #[must_use]
    pub fn is_quiet(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Takes a byte of the line; gives what is new.
    pub fn push(&mut self, byte: u8) -> Option<Heard> {
        let Notice { seq, content } = self.receiver.push(byte)?;
        if let Some(expected) = self.seq {
            let gap = seq.wrapping_sub(expected);
            // Another start of the target, which says so first or steps back, is not a loss of so
            // many numbers.
            if gap < u16::MAX / 2 && !self.is_start(&content) {
                self.losses.lost = self.losses.lost.saturating_add(u32::from(gap));
            }
        }
        self.seq = Some(seq.wrapping_add(1));
        match &content {
            Content::Sample(sample) => self.seen = sample.tick,
            Content::Learned(learned) => self.seen = learned.tick,
            Content::Health(health) => self.seen = health.tick,
            Content::Answer(Answer { id, .. }) => {
                let first = self.waiting.front().map(|order| order.id);
                if first != Some(*id) {
                    return None;
                }
                let _ = self.waiting.pop_front();
                self.sent = None;
            }
            Content::Event(event) => {
                let new = self.is_new(event);
                if new {
                    self.event = Some((event.start, event.number.wrapping_add(1)));
                }
                if let Some((_, next)) = self.event {
                    self.acknowledge(next.wrapping_sub(1));
                }
                if !new {
                    return None;
                }
            }
            _ => {}
        }
        Some(content)
    }

    /// Whether this is the first that another start of the target tells.
    fn is_start(&self, content: &Content) -> bool {
        match (content, self.event) {
            (Content::Event(event), Some((start, _))) => event.start != start,
            _ => false,
        }
    }

    /// Whether an event is the next one. One after a gap is not, while those before it can still
    /// come.
    fn is_new(&mut self, event: &NumberedEvent) -> bool {
        if let Some((start, _)) = self.event
            && start != event.start
        {
            // Another start of the target: its numbers begin again, and no sample of it was seen.
            self.event = None;
            self.seen = 0;
        }
        let next = self.event.map_or(event.oldest, |(_, next)| next);
        let gone = event.oldest.wrapping_sub(next).cast_signed() > 0;
        event.number == if gone { event.oldest } else { next }
    }

    fn acknowledge(&mut self, number: u32) {
        // Not more than one at a time: the newest number says it for all before.
        let waiting = |order: &Order| matches!(order.request, Request::Heard(_));
        let sent = usize::from(self.sent.is_some());
        if let Some(order) = self.waiting.iter_mut().skip(sent).find(|o| waiting(o)) {
            order.request = Request::Heard(number);
            return;
        }
        let _ = self.ask(Request::Heard(number));
    }

    /// The next byte for the line at the time `now_ms`.
    pub fn next_byte(&mut self, now_ms: u64) -> Option<u8> {
        if self.bytes.is_empty() {
            self.load(now_ms);
        }
        self.bytes.pop_front()
    }

    fn load(&mut self, now_ms: u64) {
        let attempts = match self.sent {
            Some((at, _)) if now_ms.saturating_sub(at) < AGAIN_MS => return,
            Some((_, ATTEMPTS..)) => {
                if let Some(order) = self.waiting.pop_front() {
                    self.give_up(order.id);
                }
                0
            }
            Some((_, attempts)) => attempts,
            None => 0,
        };
        self.sent = None;
        let Some(order) = self.waiting.front() else {
            return;
        };
        for &byte in Frame::encode(order).bytes() {
            let _ = self.bytes.push_back(byte);
        }
        self.sent = Some((now_ms, attempts + 1));
    }

    /// The number of an order that was never answered, or not sent because of a stop; each once.
    pub fn given_up(&mut self) -> Option<u32> {
        self.given_up.pop_front()
    }

    /// Forgets the line: nothing that waited is sent later.
    pub fn disconnect(&mut self) {
        self.waiting.clear();
        self.bytes.clear();
        self.sent = None;
        self.seq = None;
        let corrupt = self.losses.corrupt.saturating_add(self.receiver.corrupt());
        self.losses.corrupt = corrupt;
        self.receiver = Receiver::new();
    }

    /// What was lost so far.
    #[must_use]
    pub fn losses(&self) -> Losses {
        Losses {
            corrupt: self.losses.corrupt.saturating_add(self.receiver.corrupt()),
            ..self.losses
        }
    }
}
