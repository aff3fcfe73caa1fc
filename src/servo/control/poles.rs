//! The poles of loop and observer, and the gains that place them.

/// Poles of a loop in rad/s.
///
/// ```text
/// loop      (s + wc)(s^2 + z wp s + wp^2),   wp = the larger of wc and w0
/// observer  (s + wo)^3 (s + wd)
/// ```
///
/// The pair is never slower than the drive: to slow a drive down takes gains that no delay allows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Poles {
    /// wc, the bandwidth.
    pub(crate) bandwidth: f32,
    /// z.
    pub(crate) damping: f32,
    /// wo and wd.
    pub(crate) observer: f32,
    pub(crate) disturbance: f32,
}

/// Gains of position, velocity and drive: `b0 f = .. - k0 x - k1 v - k2 p`; and P1 for bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Feedback {
    pub(crate) k: [f32; 3],
    /// Coefficients of the loop's polynomial, from s^0 to s^2.
    pub(crate) p: [f32; 3],
}

/// Least pole of an observer over the natural frequency of its drive.
const OBSERVER_RATIO: f32 = 1.6;

impl Poles {
    /// The poles for a drive whose natural frequency `w0` has changed by a factor since they were
    /// found.
    ///
    /// A slower drive takes slower poles: in its own time it has the same margins, and more for the
    /// delay. A faster one keeps the bandwidth; only its observer must follow.
    pub(crate) fn on(&self, factor: f32, w0: f32, fastest: f32) -> Self {
        if factor < 1.0 {
            return Self {
                bandwidth: factor * self.bandwidth,
                observer: factor * self.observer,
                disturbance: factor * self.disturbance,
                ..*self
            };
        }
        let least = OBSERVER_RATIO * w0;
        let least = if least < fastest { least } else { fastest };
        Self {
            observer: if self.observer > least {
                self.observer
            } else {
                least
            },
            ..*self
        }
    }

    /// The poles with the bandwidth of the loop and of the disturbance multiplied by a factor.
    #[inline]
    pub(crate) fn derated(&self, factor: f32) -> Self {
        Self {
            bandwidth: factor * self.bandwidth,
            disturbance: factor * self.disturbance,
            ..*self
        }
    }

    /// Gains on a drive with these coefficients and natural frequency. Cost: about 15 instructions.
    #[inline]
    pub(crate) fn feedback(&self, a1: f32, a2: f32, frequency: f32) -> Feedback {
        let (c, z) = (self.bandwidth, self.damping);
        let w = if frequency > c { frequency } else { c };
        let p2 = c + z * w;
        let p1 = w * w + z * w * c;
        let p0 = c * w * w;
        let k2 = p2 - a2;
        Feedback {
            k: [p0, p1 - a1 - a2 * k2, k2],
            p: [p0, p1, p2],
        }
    }

    /// Gains of the observer's x, v, p and disturbance rate for the innovation. Cost: about 15
    /// instructions.
    #[inline]
    pub(crate) fn correction(&self, a1: f32, a2: f32) -> [f32; 4] {
        let (w, d) = (self.observer, self.disturbance);
        let l1 = 3.0 * w + d - a2;
        let l2 = 3.0 * w * (w + d) - a2 * l1 - a1;
        let l3 = w * w * (w + 3.0 * d) - a1 * l1;
        [l1, l2, l3, w * w * w * d]
    }
}

#[cfg(test)]
mod tests;
