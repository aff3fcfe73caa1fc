//! The motion that is wanted, and the one that is measured.

use crate::servo::design::constants::SETTLING_RATIO;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::followed::Followed;
use crate::servo::motion::trajectory::Trajectory;

/// Reference and measured motion of the axis.
#[derive(Debug, Clone)]
pub(crate) struct Moves {
    pub(crate) trajectory: Trajectory,
    /// What of it is on its way to the axis.
    pub(crate) followed: Followed,
    /// Pole in rad/s with which a motion that is taken over runs out.
    pub(crate) run_out_rate: f32,
    /// The motion from the positions alone.
    pub(crate) tracking: AlphaBetaGamma,
    /// Samples until it has settled behind a first reading.
    pub(crate) unsettled: u32,
    /// The largest distance of a reading from what the filter expected of it, outside of control,
    /// which decays half as fast as what such a reading leaves in the filter; infinite where that
    /// begins again with the next reading.
    pub(crate) astray: f32,
    /// What it takes while readings fail.
    pub(crate) gap: Gap,
}

impl Moves {
    /// The axis follows the reference from where that is now, a delay behind.
    pub(crate) fn follow(&mut self, delay: usize, sample_time: f32) {
        let newest = self.trajectory.setpoint();
        self.followed.begin(newest, delay, sample_time);
    }

    /// The filter has a first position, or other poles: how the axis moves is known when it has
    /// settled.
    #[cold]
    pub(crate) fn unsettle(&mut self, sample_time: f32) {
        let samples = SETTLING_RATIO / (self.tracking.rate() * sample_time);
        self.unsettled = 1 + samples as u32;
        self.astray = 0.0;
    }

    /// A reading that nobody judges, before the filter takes it. One that has not settled expects
    /// nothing that could be held against it.
    #[cold]
    #[inline(never)]
    pub(crate) fn look(&mut self, y: f32, sample_time: f32) {
        if self.unsettled > 0 {
            if self.astray > 0.0 {
                self.begin_again(y, sample_time);
            }
            return;
        }
        let error = (y - self.tracking.motion().after(sample_time)).abs();
        let left = self.astray - 0.5 * self.tracking.rate() * sample_time * self.astray;
        self.astray = if error > left { error } else { left };
    }

    /// Nothing of what the filter knew counts: it begins again at rest at `position`.
    #[cold]
    pub(crate) fn begin_again(&mut self, position: f32, sample_time: f32) {
        self.tracking.place(position);
        self.unsettle(sample_time);
    }

    /// The same with the next reading: the newest one may be the one that was off.
    #[cold]
    pub(crate) fn disbelieve(&mut self, sample_time: f32) {
        self.unsettle(sample_time);
        self.astray = f32::INFINITY;
    }

    /// One sample outside of commissioning and control.
    #[inline]
    pub(crate) const fn settle(&mut self) {
        self.unsettled = self.unsettled.saturating_sub(1);
    }
}

/// Samples in a row without a measured position.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Gap {
    samples: u32,
    /// The position before them; `None` where the observer of the controller bridged some.
    before: Option<f32>,
}

impl Gap {
    /// One sample more; `before`: the position of the sample before it, measured or expected.
    pub(crate) const fn grow(&mut self, before: Option<f32>) {
        if self.samples == 0 || before.is_none() {
            self.before = before;
        }
        self.samples = self.samples.saturating_add(1);
    }

    /// Whether the newest sample is one of them.
    #[inline]
    pub(crate) const fn is_open(&self) -> bool {
        self.samples > 0
    }

    /// The gap ends with a reading: the mean speed since the reading before it, per sample.
    pub(crate) fn end(&mut self, y: f32) -> Option<f32> {
        let Self { samples, before } = core::mem::take(self);
        before.map(|before| (y - before) / (samples as f32 + 1.0))
    }
}
