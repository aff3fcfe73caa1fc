//! The check of each sample and the delay line of an input.

/// Whether a value may enter the buffers: finite and within `limit` of zero.
///
/// One comparison, because a comparison with NaN is false. Cost: 3 instructions.
#[inline(always)]
pub(crate) fn acceptable(value: f32, limit: f32) -> bool {
    value.abs() <= limit
}

/// Ring buffer that delays a signal by up to `D` samples.
///
/// # Examples
/// ```
/// use trendid::trends::DelayLine;
/// let mut line = DelayLine::<4>::new();
/// assert_eq!(line.update(1.0, 2), 0.0);
/// assert_eq!(line.update(2.0, 2), 0.0);
/// assert_eq!(line.update(3.0, 2), 1.0);
/// assert_eq!(line.update(4.0, 0), 4.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DelayLine<const D: usize> {
    ring: [f32; D],
    newest: usize,
}

impl<const D: usize> DelayLine<D> {
    /// A line filled with zeros.
    pub const fn new() -> Self {
        Self {
            ring: [0.0; D],
            newest: 0,
        }
    }

    /// Takes u(k), gives u(k - delay); a delay beyond `D` gives u(k - D).
    #[inline]
    pub fn update(&mut self, value: f32, delay: usize) -> f32 {
        let out = self.past(value, delay);
        self.push(value);
        out
    }

    /// Takes u(k), gives the mean over the sample interval from k on of an input held from sample
    /// to sample that is `delay + part` samples late, `part` from 0 to 1:
    /// `(1 - part) u(k - delay) + part u(k - delay - 1)`.
    ///
    /// What a held input integrates to over an interval is exact with it; a delay beyond `D - 1`
    /// counts as that, and a line of length 0 delays nothing.
    ///
    /// # Examples
    /// ```
    /// use trendid::trends::DelayLine;
    /// let mut line = DelayLine::<4>::new();
    /// assert_eq!(line.update_between(0.0, 1, 0.25), 0.0);
    /// assert_eq!(line.update_between(4.0, 1, 0.25), 0.0);
    /// assert_eq!(line.update_between(4.0, 1, 0.25), 3.0);
    /// assert_eq!(line.update_between(4.0, 1, 0.25), 4.0);
    /// ```
    #[inline(never)]
    pub fn update_between(&mut self, value: f32, delay: usize, part: f32) -> f32 {
        let delay = delay.min(D.saturating_sub(1));
        let newer = self.past(value, delay);
        let older = self.past(value, delay + 1);
        self.push(value);
        newer + part * (older - newer)
    }

    /// u(k - delay) before u(k), which is `value`, is in the ring.
    #[inline]
    fn past(&self, value: f32, delay: usize) -> f32 {
        let delay = if delay < D { delay } else { D };
        // The ring holds u(k-1) at `newest`, u(k-2) before it, and so on.
        let Some(back) = delay.checked_sub(1) else {
            return value;
        };
        let index = if self.newest >= back {
            self.newest - back
        } else {
            self.newest + D - back
        };
        self.ring.get(index).copied().unwrap_or(0.0)
    }

    #[inline]
    fn push(&mut self, value: f32) {
        let next = self.newest + 1;
        let next = if next >= D { 0 } else { next };
        if let Some(slot) = self.ring.get_mut(next) {
            *slot = value;
        }
        self.newest = next;
    }
}

impl<const D: usize> Default for DelayLine<D> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_delay_of_a_line() {
        for delay in 0..=6 {
            let mut line = DelayLine::<4>::new();
            for k in 0..20 {
                let out = line.update(1.0 + k as f32, delay);
                // A delay beyond the line is the line's.
                let back = if delay < 4 { delay } else { 4 };
                let wanted = if k >= back {
                    (1 + k - back) as f32
                } else {
                    0.0
                };
                assert_eq!(out, wanted, "delay {delay}, sample {k}");
            }
        }
        assert_eq!(DelayLine::<0>::default().update(7.0, 3), 7.0);
    }

    #[test]
    fn between_two_samples_of_a_line() {
        for delay in [0, 1, 2, 3, 4, 6, usize::MAX] {
            for part in [0.0, 0.25, 1.0] {
                let mut line = DelayLine::<4>::new();
                let late = if delay < 3 { delay } else { 3 } as f32 + part;
                for k in 0..20 {
                    // Of a ramp the mean of two samples lies between them.
                    let out = line.update_between(k as f32, delay, part);
                    if k > 4 {
                        assert_eq!(out, k as f32 - late, "delay {delay} + {part}, sample {k}");
                    }
                }
            }
        }
        assert_eq!(DelayLine::<0>::new().update_between(7.0, 3, 0.25), 7.0);
    }

    #[test]
    fn only_numbers_within_reach_are_acceptable() {
        for good in [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE] {
            assert!(acceptable(good, 1.0));
        }
        for bad in [1.0001, -2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!acceptable(bad, 1.0));
        }
    }
}
