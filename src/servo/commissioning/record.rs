//! The last positions and commands of a commissioning, in a ring of fixed size.

/// Points that are kept.
pub(crate) const POINTS: usize = 512;

/// Positions and commands at a spacing that grows until the time scale of the axis is known.
///
/// Point i holds the position at its instant and the mean of the commands from there to the next
/// point. Points have absolute numbers; the ring keeps the newest 512 of them. Memory: 4 kB.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MotionRecord {
    y: [f32; POINTS],
    u: [f32; POINTS],
    /// Number of the next point.
    end: usize,
    /// Samples per point, and samples of the present point so far.
    stride: usize,
    filled: usize,
    /// Position and sum of the commands of the present point.
    position: f32,
    sum: f32,
    /// Whether a full record doubles its stride instead of losing its oldest points.
    compacting: bool,
}

impl MotionRecord {
    #[inline(always)]
    pub(crate) const fn new() -> Self {
        Self {
            y: [0.0; POINTS],
            u: [0.0; POINTS],
            end: 0,
            stride: 1,
            filled: 0,
            position: 0.0,
            sum: 0.0,
            compacting: true,
        }
    }

    /// Forgets everything; takes every `stride`-th sample from now on.
    pub(crate) const fn restart(&mut self, stride: usize) {
        self.end = 0;
        self.stride = stride;
        self.filled = 0;
        self.sum = 0.0;
        self.compacting = true;
    }

    /// Takes a position and the command in force from now on.
    #[inline]
    pub(crate) fn push(&mut self, y: f32, u: f32) {
        if self.filled == 0 {
            self.position = y;
            self.sum = 0.0;
        }
        self.sum += u;
        self.filled += 1;
        if self.filled < self.stride {
            return;
        }
        self.filled = 0;
        let at = self.end % POINTS;
        self.y[at] = self.position;
        self.u[at] = self.sum / self.stride as f32;
        self.end += 1;
        if self.compacting && self.end == POINTS {
            self.halve();
        }
    }

    /// Doubles the stride. Only before the ring has turned. Cost: about 5 instructions per point.
    fn halve(&mut self) {
        // The ring has not turned: no more than all points.
        let half = (self.end / 2).min(POINTS / 2);
        for i in 0..half {
            self.y[i] = self.y[2 * i];
            self.u[i] = 0.5 * (self.u[2 * i] + self.u[2 * i + 1]);
        }
        self.end = half;
        self.stride *= 2;
        self.filled = 0;
    }

    /// Coarser points, as far as doubling leads to at most `stride`, one doubling per call; whether
    /// it is done: from then on the oldest points are lost.
    pub(crate) fn fix(&mut self, stride: usize) -> bool {
        if 2 * self.stride <= stride {
            self.halve();
            return false;
        }
        self.compacting = false;
        true
    }

    /// Samples per point.
    pub(crate) const fn stride(&self) -> usize {
        self.stride
    }

    /// Number after the newest point.
    pub(crate) const fn end(&self) -> usize {
        self.end
    }

    /// Position of a point that is still kept.
    #[inline]
    pub(crate) const fn y(&self, i: usize) -> f32 {
        self.y[i % POINTS]
    }

    /// Command of a point that is still kept; before the first one the valve was at rest.
    #[inline]
    pub(crate) const fn u(&self, i: usize, back: usize) -> f32 {
        if back > i {
            return 0.0;
        }
        self.u[(i - back) % POINTS]
    }
}

#[cfg(test)]
mod tests;
