//! When a verified model is worth a record.

use crate::servo::model::Model;

/// A parameter that moved by this share of itself has changed; models closer than their usual
/// standard deviation are one model.
const SHARE: f32 = 0.02;

/// Share of the full command below which dead zone and offset do not count as moved: that of
/// [`SHARE`] of a command of 0.1.
const COMMAND: f32 = 0.002;

/// Seconds between two records. A sector of 16 KiB holds 170 records and endures 10 000 erasures,
/// two sectors 3.4 million records: six years of one a minute without a pause, where a drive that
/// keeps its model writes none.
const PAUSE: u32 = 60;

/// Decides when to save: a change of more than 2 %, and not within a minute of the last record or
/// attempt.
///
/// # Examples
/// ```
/// use trendid::servo::{Model, store::Keeper};
/// let (old, new) = (Model::linear(400.0, 20.0, 1.0e6), Model::linear(410.0, 20.0, 1.0e6));
/// let mut keeper = Keeper::new(Some(old));
/// assert!(!keeper.is_due(&old, 1000) && keeper.is_due(&new, 1000));
/// keeper.saved(&new, 1000);
/// assert!(!keeper.is_due(&old, 1059) && keeper.is_due(&old, 1060));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Keeper {
    kept: Option<Model>,
    /// Time of the last record or attempt, in s.
    last: Option<u32>,
}

impl Keeper {
    /// A keeper that knows what was loaded.
    pub const fn new(kept: Option<Model>) -> Self {
        Self { kept, last: None }
    }

    /// Whether `model`, verified, is worth a record at the time `now` in s, which may wrap around.
    pub fn is_due(&self, model: &Model, now: u32) -> bool {
        let rested = self.last.is_none_or(|last| now.wrapping_sub(last) >= PAUSE);
        rested && model.is_finite() && self.kept.is_none_or(|kept| differ(&kept, model))
    }

    /// Notes that `model` was saved at the time `now` in s.
    pub const fn saved(&mut self, model: &Model, now: u32) {
        self.kept = Some(*model);
        self.last = Some(now);
    }

    /// Notes that nothing could be saved at the time `now` in s: another attempt waits as long as
    /// another record, since a flash that fails would else be written in every one.
    pub const fn failed(&mut self, now: u32) {
        self.last = Some(now);
    }
}

/// Whether a parameter differs by more than its share.
fn differ(old: &Model, new: &Model) -> bool {
    let moved = |old: f32, new: f32, floor: f32| {
        (new - old).abs() > (SHARE * old.abs().max(new.abs())).max(floor)
    };
    moved(old.a1, new.a1, 0.0)
        || moved(old.a2, new.a2, 0.0)
        || moved(old.b0, new.b0, 0.0)
        || moved(old.friction, new.friction, 0.0)
        || moved(old.dead_zone, new.dead_zone, COMMAND)
        || moved(old.offset, new.offset, COMMAND)
}
