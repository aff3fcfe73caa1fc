//! Whether friction holds the axis: the measured position stays where it is.

use crate::servo::design::AnchorDesign;

/// What a sample shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stiction {
    /// The axis slides.
    Sliding,
    /// It began to stick.
    Stuck,
    /// It sticks.
    Sticking,
    /// It left its place in this direction.
    Left(f32),
}

/// A place that the measured position does not leave.
///
/// While friction holds, the position carries no information: an observer would wind up on its
/// noise. The place is the mean of the first samples there, and then stays.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Anchor {
    design: AnchorDesign,
    place: f32,
    /// Samples within the band, and their sum from the first one.
    count: u32,
    /// Mean of the latest deviations: a start is noticed before one of them leaves the band.
    late: f32,
    sum: f32,
    first: f32,
    held: bool,
    /// Samples since the axis began to stick, or to slide.
    since: u32,
}

/// Share of a sample in the mean of the latest, whose deviation is 0.42 of that of one, and its
/// band over that of one.
const LATE_SHARE: f32 = 0.3;
const LATE_BAND: f32 = 0.5;
/// Deviation of the place over that of a reading: it falls with the root of how many its mean has,
/// however far apart they are.
const PLACE_DEVIATION: f32 = 0.158;
const PLACE_READINGS: u32 = (1.0 / (PLACE_DEVIATION * PLACE_DEVIATION)) as u32;
/// Time over that of the observer within which nothing moved. The observer is slow against the
/// sample time (`OBSERVER_STEP`), so that it is at least sixteen readings: fewer within the band
/// would be chance.
const TIME_RATIO: f32 = 5.0;

impl Anchor {
    pub(crate) const fn new(design: &AnchorDesign) -> Self {
        Self {
            design: *design,
            place: 0.0,
            count: 0,
            late: 0.0,
            sum: 0.0,
            first: 0.0,
            held: false,
            since: 0,
        }
    }

    /// Time for which nothing may move, from the pole of the observer.
    pub(crate) fn tune(&mut self, observer: f32) {
        self.design.time = TIME_RATIO / observer;
    }

    /// Knows no place.
    pub(crate) const fn restart(&mut self) {
        self.count = 0;
        self.held = false;
        self.since = 0;
    }

    /// Takes a position; `slow`: the observer sees next to no velocity. Cost: about 25
    /// instructions.
    #[inline]
    pub(crate) fn update(&mut self, y: f32, slow: bool) -> Stiction {
        self.since = self.since.saturating_add(1);
        let away = y - self.place;
        self.late += LATE_SHARE * (away - self.late);
        let starts = self.held && !(self.late.abs() <= LATE_BAND * self.design.band);
        if self.count == 0 || starts || !(away.abs() <= self.design.band) {
            let was = self.held;
            self.place = y;
            self.first = y;
            self.late = 0.0;
            self.sum = 0.0;
            self.count = 1;
            self.held = false;
            if was {
                self.since = 0;
                return Stiction::Left(if away > 0.0 { 1.0 } else { -1.0 });
            }
            return Stiction::Sliding;
        }
        self.count = self.count.saturating_add(1);
        if self.count <= PLACE_READINGS {
            // Relative to the first one: no digit is lost.
            self.sum += y - self.first;
            self.place = self.first + self.sum / self.count as f32;
        }
        if self.held {
            return Stiction::Sticking;
        }
        if slow && self.count as f32 * self.design.sample_time > self.design.time {
            self.held = true;
            self.since = 0;
            return Stiction::Stuck;
        }
        Stiction::Sliding
    }

    pub(crate) const fn holds(&self) -> bool {
        self.held
    }

    pub(crate) const fn place(&self) -> f32 {
        self.place
    }

    pub(crate) const fn since(&self) -> u32 {
        self.since
    }
}
