//! The innovation gate: a spike does not enter the trends, a lasting change does.
//!
//! ```text
//! implausible  <=>  |e(k) - e_mean| > 4 sigma_y   and   |y(k) - 3 y(k-1) + 3 y(k-2) - y(k-3)| > 1.2 sqrt(20) sigma_y
//! ```
//!
//! e is the innovation, e_mean its mean over some samples: a model that is wrong makes e large and
//! e_mean with it. An implausible sample is replaced by `y - (e - e_mean)`. If the next one is
//! implausible too, the change lasts: both are taken as measured, and the gate stays open for a
//! while. So one wrong sample costs one row, and a step of the position enters the trends in the
//! sample in which it happened.
//!
//! Without a memory sigma_y is that of hours, of which a sensor of coarse digits may have shown
//! none at rest, and a step from digit to digit in a slow motion is several of it. There all limits
//! are five times as large, and nothing below the noise that is expected is implausible.

/// Standard deviations of the noise beyond which the innovation is implausible.
const INNOVATION: f32 = 4.0;

/// The same for the third difference of y, relative to its own standard deviation, sqrt(20) times
/// that of the noise.
const THIRD: f32 = 1.2;

/// How much larger both are without a memory, squared.
const COARSE: f32 = 25.0;

/// Share of the newest innovation in its mean.
const SHARE: f32 = 0.125;

/// Kind of a sample of y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SampleKind {
    Plausible,
    /// To be replaced by its prediction.
    Implausible,
    /// The one before was right.
    Lasting,
}

/// Memory of the gate; `T` is the memory of the trends of y.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gate<T> {
    /// Mean of the innovation.
    pub(crate) mean: f32,
    /// Samples for which the gate stays open.
    open: u32,
    /// The sample that was replaced one sample ago, with the memory of the trends before it; at a
    /// start, where none is replaced, what a beginning at 1 leaves in the trends.
    pub(crate) aside: Option<(f32, T)>,
}

impl<T> Gate<T> {
    /// A gate that is open for the first `open` samples.
    pub(crate) const fn new(open: u32) -> Self {
        Self {
            mean: 0.0,
            open,
            aside: None,
        }
    }

    /// Classifies a sample by its innovation and its third difference, in the unit of y; `noise` is
    /// the variance of y, and without a memory the one that is expected, otherwise 0.
    #[inline(always)]
    pub(crate) fn classify(
        &mut self,
        innovation: f32,
        third: f32,
        noise: [f32; 2],
        pause: u32,
    ) -> SampleKind {
        let jump = (innovation - self.mean) * (1.0 / INNOVATION);
        let third = third * third * (1.0 / (20.0 * THIRD * THIRD));
        let jump = jump * jump;
        let smaller = if jump < third { jump } else { third };
        if self.open > 0 || smaller <= noise[0] || is_allowed(smaller, noise) {
            self.open = self.open.saturating_sub(1);
            let mean = self.mean + SHARE * (innovation - self.mean);
            self.mean = if mean.is_finite() { mean } else { 0.0 };
            self.aside = None;
            return SampleKind::Plausible;
        }
        if self.aside.is_some() {
            self.keep_open(pause);
            return SampleKind::Lasting;
        }
        SampleKind::Implausible
    }

    /// Takes the next `samples` as they are.
    pub(crate) fn keep_open(&mut self, samples: u32) {
        self.open = self.open.max(samples);
    }
}

/// Whether a square beyond the variance of y is no more than what is allowed for without a memory.
fn is_allowed(square: f32, [noise, expected]: [f32; 2]) -> bool {
    expected > 0.0 && square <= expected + COARSE * noise
}

#[cfg(test)]
mod tests;
