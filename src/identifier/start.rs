//! Where y began, from more samples than the first.
//!
//! The trends begin at rest at y(0), so that its noise is in all of them as a step. Behind the
//! filter that is as much in the regressors as the noise of `(omega Delta)^-2` other samples, and
//! no residual shows it: one sample, and the estimate of a minute is wrong. So no row is taken
//! while a line through the samples tells the beginning better:
//!
//! ```text
//! y_0 = (2 (2n - 1) sum y - 6 sum k y) / (n (n + 1))           variance 4 sigma^2 / n
//! off by at most  R (n omega Delta)^2 / 12  from a drive of the design size, which bends off the line
//! n: the first with a known sigma at which the second is 2 sigma / sqrt(n), or n omega Delta is 1
//! ```
//!
//! Then the trends go on as if they had begun at y_0: they are linear in where they began. Where
//! y(0) alone is the better one, as of a sensor without noise, it stays. The rows that are left out
//! would have held the noise of y(0) above all. Where an input steps the velocity there is no line:
//! the kink of the first command passes for noise in the third difference.
//!
//! # What does not hold
//! What is left of the noise of y(0) after so many samples is still a step in the trends. What the
//! slow pole of the filter keeps of it the column of the initial state takes, or the sums beside
//! the recursion do ([`Beginning`](crate::estimation::beginning)); what the faster poles make of it
//! in the first rows is in the deviations of a structure with that column alone
//! ([`StartError`](crate::estimation::start_error)). A drive that is stronger at the start than its
//! design size bends off by as much more. The position loop, which tests every model on later
//! samples, does not wait. Where a filter is exchanged the trends settle for longer than this; a
//! sample that is missing meanwhile ends it, and y(0) stays.

/// Fewest samples that tell the noise.
const LEAST: u32 = 10;

/// When a line tells the beginning better than y(0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StartPlan {
    /// By how much a drive of the design size bends off a line within a sample: R (omega Delta)^2 /
    /// 12.
    pub(crate) bend: f32,
    /// 1/(omega Delta); 0 where trends have no memory of where they began, or where ten samples are
    /// longer.
    pub(crate) longest: u32,
}

impl StartPlan {
    /// For a movement of `range`; `angle` is omega Delta.
    pub(crate) fn new(range: f32, angle: f32, filtered: bool) -> Self {
        let longest = (1.0 / angle) as u32;
        Self {
            bend: range * angle * angle / 12.0,
            longest: if filtered && longest >= LEAST {
                longest
            } else {
                0
            },
        }
    }
}

/// The line through the first samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    samples: u32,
    /// Sums of y and k y from y(0).
    sum: f32,
    moment: f32,
    first: f32,
}

/// What a beginning says after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// More samples tell more.
    Wait,
    /// The line begins so far from y(0).
    Begin(f32),
    /// y(0) is the better one.
    Stay,
}

impl Start {
    /// At y(0) = `first`, where no sample has been taken.
    pub(super) const fn new(first: f32) -> Self {
        Self {
            samples: 0,
            sum: 0.0,
            moment: 0.0,
            first,
        }
    }

    /// Variance of where the line begins over that of the noise.
    pub(super) const fn variance(&self) -> f32 {
        4.0 / self.samples as f32
    }

    /// Takes y(k); `noise` is its variance, below 0 while it is not known.
    pub(super) fn take(&mut self, y: f32, noise: f32, plan: StartPlan) -> Verdict {
        let from_first = y - self.first;
        self.sum += from_first;
        self.moment += self.samples as f32 * from_first;
        self.samples += 1;
        let n = self.samples as f32;
        let bend = plan.bend * n * n;
        let (square, chance) = (bend * bend, noise * (4.0 / n));
        if self.samples < plan.longest && (noise < 0.0 || square < chance) {
            return Verdict::Wait;
        }
        match square + chance < noise {
            true => Verdict::Begin(
                (2.0 * (2.0 * n - 1.0) * self.sum - 6.0 * self.moment) / (n * (n + 1.0)),
            ),
            false => Verdict::Stay,
        }
    }
}

#[cfg(test)]
mod tests;
