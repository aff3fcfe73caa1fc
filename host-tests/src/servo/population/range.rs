//! Ranges to draw from, and streams of random numbers that are the same on every machine.

use crate::random::Random;
use rand::RngExt;

use crate::signals::noise::numbered;

/// What random numbers are for; each purpose has a stream of its own, so that more draws for one
/// leave the others alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// Sizes of the axis.
    Axis = 1,
    /// What its user knows only roughly.
    Knowledge = 2,
    /// Places of the sequence.
    Sequence = 3,
    /// Noise of the sensor, and the time between samples.
    Disturbance = 4,
    /// The same while a practitioner tunes.
    Tuning = 5,
}

/// The stream of a purpose of a seed.
pub fn stream(seed: u64, purpose: Purpose) -> Random {
    numbered(seed, purpose as u64)
}

/// How values of a range are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// Each difference alike.
    Even,
    /// Each ratio alike.
    Ratio,
}

/// A range about the value of an ordinary machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub low: f64,
    /// Value of an ordinary machine.
    pub ordinary: f64,
    /// Largest value.
    pub high: f64,
    /// How values are spread.
    pub spread: Spread,
}

impl Range {
    /// Differences alike.
    pub const fn even(low: f64, ordinary: f64, high: f64) -> Self {
        Self {
            low,
            ordinary,
            high,
            spread: Spread::Even,
        }
    }

    /// Ratios alike.
    pub const fn ratio(low: f64, ordinary: f64, high: f64) -> Self {
        Self {
            low,
            ordinary,
            high,
            spread: Spread::Ratio,
        }
    }

    /// The half of the range about the ordinary value: each end comes half way to it.
    pub fn usual(&self) -> Self {
        let half = |end: f64| match self.spread {
            Spread::Even => 0.5 * (end + self.ordinary),
            Spread::Ratio => (end * self.ordinary).sqrt(),
        };
        Self {
            low: half(self.low),
            high: half(self.high),
            ..*self
        }
    }

    /// Draws a value, of the usual half or of the whole range.
    pub fn draw(&self, usual: bool, random: &mut Random) -> f64 {
        let range = if usual { self.usual() } else { *self };
        let part = random.random::<f64>();
        match range.spread {
            Spread::Even => range.low + part * (range.high - range.low),
            // The exponential of `libm` has the same bits on every machine, that of `std` has not.
            Spread::Ratio => {
                let value = range.low * libm::exp(part * libm::log(range.high / range.low));
                value.clamp(range.low, range.high)
            }
        }
    }

    /// Whether a value is in the range.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}
