//! A change of the drive in motion: found by the innovation within the bandwidth, answered by a
//! memory that becomes short.
//!
//! ```text
//! e_f, psi_f   innovation and left-hand side of the equation behind a lag of 1/(2 omega)
//! E, S         their mean squares over 4/omega            L    mean of E over the memory
//! changed  <=>  E > 0.1^2 S   and   E > 12 L (1 + phi' P phi)   and   E > 12 times a fiftieth of the expected noise, squared
//! ```
//!
//! White noise passes the lag weakened, a wrong model does not: the command moves the drive within
//! the bandwidth. The second condition is relative to what is usual, so noise of any colour and a
//! model that is slightly wrong all the time are none; the first one leaves out what matters
//! little. L follows E and not e_f^2, so that what is new does not pass for usual at once; with a
//! memory below some 20/omega it does all the same, and the memory itself is short enough. With
//! Gaussian innovations E has about sixteen degrees of freedom, so that chance alone exceeds 12
//! times the mean with a probability below 1e-30 per 4/omega: false alarms come from drives that
//! the model does not describe. They cost accuracy for one memory, nothing else.
//!
//! Then nothing learnt counts any more: P becomes what the observations of nominal values alone
//! leave, [`StabilisedForgetting`](crate::estimation::StabilisedForgetting), with theta as their
//! value. So the bound of P holds, and how large the rows of the old drive were does not matter:
//! one of them left in could outweigh all those of a slower drive. The rows are left out while the
//! filter carries both drives: for three time constants of its pair, and on until twice e^-3 of a
//! row is the old one's, `S(change) e^(-2t/tau) <= 4 e^-6 psi^2`, or less than noise. What the slow
//! pole carries on is an initial state, which becomes uncertain again, as at the start. The rows
//! behind that are weighed against so little that the memory plays no part: it is as long as the
//! time since, until that is as long as the memory.
//!
//! P with the usual noise says nothing of values that are wrong: the read-out adds what is left of
//! the old drive, and knows nothing before the first row of the new one.

use crate::estimation::mean_square::{MeanSquare, flush};
use crate::readout::Former;
use crate::trends::filter::settling_time;

/// Share of the motion beyond which a change matters, squared.
const MATTERS: f32 = 0.01;

/// Share of a row that the filter may carry of the old drive, squared: twice e^-3.
const FADED: f32 = 0.009_92;

/// How much larger than usual the innovation is.
const UNUSUAL: f32 = 12.0;

/// What the detector remembers; all in normalised quantities.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ChangeDetector {
    /// e_f and psi_f.
    lagged: [f32; 2],
    /// E and S; while rows are left out 0, and the square of what the filter carries.
    power: [f32; 2],
    /// L.
    usual: MeanSquare,
    /// Samples until the detector may find a change again.
    blind: u32,
    /// Samples for which the rows are still left out.
    pub(crate) settling: u32,
    /// Whether a change was found since the estimate began.
    answered: bool,
}

/// Shares of the newest sample in the lag and in the mean squares, what the filter still carries of
/// a square in the next one, and what is always allowed for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shares {
    pub(crate) lag: f32,
    pub(crate) power: f32,
    pub(crate) carried: f32,
    /// A variance of the innovation that is always allowed for.
    pub(crate) least: f32,
}

impl Shares {
    /// Nothing is taken over.
    pub(crate) const NONE: Self = Self {
        lag: 0.0,
        power: 0.0,
        carried: 0.0,
        least: 0.0,
    };

    /// For bandwidth times sample time, and a variance of the innovation that is always allowed
    /// for.
    pub(crate) const fn new(angle: f32, least: f32) -> Self {
        Self {
            lag: 2.0 * angle / (1.0 + 2.0 * angle),
            power: 0.25 * angle / (1.0 + 0.25 * angle),
            carried: 1.0 / (1.0 + 6.0 * angle / settling_time(1.0)),
            least,
        }
    }
}

impl ChangeDetector {
    /// Nothing seen; blind for the first `blind` samples.
    pub(crate) const fn new(forgetting: f32, blind: u32) -> Self {
        Self {
            lagged: [0.0; 2],
            power: [0.0; 2],
            usual: MeanSquare::new(forgetting),
            blind,
            settling: 0,
            answered: false,
        }
    }

    /// Takes innovation and left-hand side of a row; whether the drive has changed. `spread` gives
    /// phi' P phi.
    ///
    /// Cost: 35 instructions.
    #[inline(always)]
    pub(crate) fn found(
        &mut self,
        row: [f32; 2],
        shares: Shares,
        spread: impl FnOnce() -> f32,
    ) -> bool {
        for ((lagged, power), x) in self.lagged.iter_mut().zip(&mut self.power).zip(row) {
            *lagged += shares.lag * (x - *lagged);
            *power += shares.power * (*lagged * *lagged - *power);
        }
        let [error, whole] = self.power;
        self.usual.update(error);
        if self.blind > 0 {
            self.blind -= 1;
            return false;
        }
        error > UNUSUAL * shares.least
            && error > MATTERS * whole
            && self.usual.exceeded_by(error * (1.0 / UNUSUAL))
            && self.usual.exceeded_by(error / (UNUSUAL * (1.0 + spread())))
    }

    /// Begins anew behind a change: at least `settling` samples without rows, and blind for `blind`
    /// samples.
    pub(crate) const fn answer(&mut self, forgetting: f32, settling: u32, blind: u32) {
        let [_, whole] = self.power;
        *self = Self::new(forgetting, blind);
        self.power = [0.0, whole];
        self.settling = settling;
        self.answered = true;
    }

    /// A sample while the filter carries the old drive, with the left-hand side of its row.
    ///
    /// Ends in a bounded time, whatever the new drive does: what is carried falls below what is
    /// always allowed for.
    pub(crate) fn settle(&mut self, psi: f32, shares: Shares) {
        let [_, carried] = &mut self.power;
        *carried *= shares.carried;
        if self.settling > 1 || *carried <= FADED * psi * psi || *carried <= shares.least {
            self.settling -= 1;
        }
        if self.settling == 0 {
            *carried = 0.0;
        }
    }

    /// The estimate begins from values that are not of any drive before.
    pub(crate) const fn begin(&mut self) {
        self.answered = false;
    }

    /// What counts of the drive before the newest change.
    pub(crate) fn former(&self, forgetting: f32) -> Former {
        match self.answered {
            true => Former::behind(self.settling > 0, self.usual.samples(), 1.0 - forgetting),
            false => Former::NONE,
        }
    }

    /// What has decayed behind the lag becomes zero before it becomes subnormal.
    pub(crate) fn flush_lagged(&mut self) {
        for x in &mut self.lagged {
            flush(x, 1e-15);
        }
        self.usual.flush();
    }

    /// The same for the mean squares.
    pub(crate) fn flush_power(&mut self) {
        for x in &mut self.power {
            flush(x, 1e-30);
        }
    }
}

#[cfg(test)]
mod tests;
