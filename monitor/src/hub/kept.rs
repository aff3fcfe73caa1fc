//! What a page gets that comes later.

use std::collections::VecDeque;

use trendid_link::telemetry::{Health, Learned, NumberedEvent, Sample};

/// The newest of each kind that are kept.
const SAMPLES: usize = 30_000;
const ESTIMATES: usize = 3000;
const EVENTS: usize = 500;

/// The newest samples, estimates and events, and the health of the target.
pub(super) struct Kept {
    pub(super) samples: VecDeque<Sample>,
    /// Of them, those that the pages do not have yet.
    pub(super) fresh: usize,
    pub(super) learned: VecDeque<Learned>,
    pub(super) events: VecDeque<NumberedEvent>,
    pub(super) health: Health,
}

impl Kept {
    pub(super) fn new() -> Self {
        Self {
            samples: VecDeque::with_capacity(SAMPLES),
            fresh: 0,
            learned: VecDeque::with_capacity(ESTIMATES),
            events: VecDeque::with_capacity(EVENTS),
            health: Health::default(),
        }
    }

    pub(super) fn sample(&mut self, sample: Sample) {
        keep(&mut self.samples, sample, SAMPLES);
        self.fresh = (self.fresh + 1).min(SAMPLES);
    }

    pub(super) fn learn(&mut self, learned: Learned) {
        keep(&mut self.learned, learned, ESTIMATES);
    }

    pub(super) fn event(&mut self, event: NumberedEvent) {
        keep(&mut self.events, event, EVENTS);
    }

    /// The target has begun anew, and so have its ticks.
    pub(super) fn restart(&mut self) {
        self.samples.clear();
        self.learned.clear();
        self.fresh = 0;
        self.health = Health::default();
    }
}

fn keep<T>(queue: &mut VecDeque<T>, item: T, most: usize) {
    if queue.len() >= most {
        queue.pop_front();
    }
    queue.push_back(item);
}
