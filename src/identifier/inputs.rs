//! Inputs made from the command: what a valve, a cylinder or friction does belongs in the regressor.

use crate::error::positive;

/// The two inputs that a valve with the dead zone `delta` needs beside a constant.
///
/// A valve that passes `u - delta sgn(u)` for `|u| > delta` and nothing inside is
/// linear in `[u, sgn(u)]`, both switched off inside the dead zone. The ratio of the
/// two numerators is `-delta`.
///
/// # Examples
/// ```
/// assert_eq!(trendid::dead_zone(0.5, 0.03), [0.5, 1.0]);
/// assert_eq!(trendid::dead_zone(-0.5, 0.03), [-0.5, -1.0]);
/// assert_eq!(trendid::dead_zone(0.02, 0.03), [0.0, 0.0]);
/// ```
#[inline]
pub fn dead_zone(u: f32, delta: f32) -> [f32; 2] {
    if u > delta {
        [u, 1.0]
    } else if u < -delta {
        [u, -1.0]
    } else {
        [0.0, 0.0]
    }
}

/// The inputs of a valve whose dead zone is not known, and the dead zone itself, measured on the way.
///
/// With the inputs of [`dead_zone`] for any width delta near the true one, the model measures the true one:
///
/// ```text
/// delta <- -b_sgn / b_u          once per block
/// ```
///
/// What was learnt with the old width is wrong by what the width was wrong, so it must be forgotten: give the
/// identifier a memory of about two blocks. Begin with a width that is too small rather than too large (0 is good).
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | delta | `delta`, start; at most `largest` | of u |
/// | - | `block` | samples between corrections |
///
/// Measured on the reference servo in closed loop (dead zone 0.03, memory 0.7 s, blocks of 0.3 s, 4 s of steps, 100
/// seeds): with white noise 0.02 mm wide the width is right within 0.0005 and C, omega0 and xi within 1 %; with 0.1 mm
/// their rms errors stay below 1 %.
///
/// # Examples
/// ```
/// let mut valve = trendid::DeadZone::new(0.0, 0.1, 2);
/// assert_eq!(valve.inputs(0.02), [0.02, 1.0]);
/// assert!(!valve.update(|| [2.0, -0.06]));
/// assert!(valve.update(|| [2.0, -0.06])); // the block is full: delta = 0.06 / 2
/// assert!((valve.delta() - 0.03).abs() < 1e-7);
/// assert_eq!(valve.inputs(0.02), [0.0, 0.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadZone {
    delta: f32,
    largest: f32,
    block: u32,
    count: u32,
}

impl DeadZone {
    /// Starts at the half width `delta`, corrected every `block` samples within 0 ..= `largest`.
    ///
    /// What is not a number in its range becomes 0; a block of 0 samples corrects nothing.
    pub const fn new(delta: f32, largest: f32, block: u32) -> Self {
        let largest = if positive(largest) { largest } else { 0.0 };
        Self {
            delta: if delta >= 0.0 && delta <= largest {
                delta
            } else {
                0.0
            },
            largest,
            block,
            count: 0,
        }
    }

    /// Half width of the dead zone, in the unit of u.
    pub const fn delta(&self) -> f32 {
        self.delta
    }

    /// The two inputs for a command. Cost: 6 instructions.
    #[inline]
    pub fn inputs(&self, u: f32) -> [f32; 2] {
        dead_zone(u, self.delta)
    }

    /// Counts a sample; at the end of a block asks for the numerators `[b_u, b_sgn]` and corrects the width.
    ///
    /// Says whether it was corrected: a quotient outside 0 ..= `largest` changes nothing.
    #[inline]
    pub fn update(&mut self, numerators: impl FnOnce() -> [f32; 2]) -> bool {
        self.count = self.count.saturating_add(1);
        if self.count < self.block || self.block == 0 {
            return false;
        }
        self.count = 0;
        let [linear, sign] = numerators();
        let delta = -sign / linear;
        let accepted = delta >= 0.0 && delta <= self.largest;
        if accepted {
            self.delta = delta;
        }
        accepted
    }
}

/// The two inputs of an actuator with another gain in each direction: `max(u, 0)` and `min(u, 0)`.
///
/// # Examples
/// ```
/// assert_eq!(trendid::asymmetric(-2.0), [0.0, -2.0]);
/// ```
#[inline]
pub fn asymmetric(u: f32) -> [f32; 2] {
    if u > 0.0 { [u, 0.0] } else { [0.0, u] }
}

/// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero.
///
/// # Examples
/// ```
/// assert_eq!(trendid::coulomb(-0.4, 0.01), -1.0);
/// assert_eq!(trendid::coulomb(0.001, 0.01), 0.0);
/// ```
#[inline]
pub fn coulomb(velocity: f32, rest: f32) -> f32 {
    if velocity > rest {
        1.0
    } else if velocity < -rest {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dead_zone_refuses_nonsense() {
        let fresh = DeadZone::new(0.02, 0.1, 1);
        for numerators in [
            [0.0, 0.0],
            [f32::NAN, -0.1],
            [1.0, f32::INFINITY],
            [1.0, 0.05],
            [1.0, -0.2],
            [0.0, -0.1],
        ] {
            let mut valve = fresh;
            assert!(!valve.update(|| numerators));
            assert_eq!(valve.delta(), 0.02);
        }
        assert_eq!(DeadZone::new(f32::NAN, 0.1, 1).delta(), 0.0);
        assert_eq!(DeadZone::new(0.2, 0.1, 1).delta(), 0.0);
        assert_eq!(DeadZone::new(0.2, f32::NAN, 1).delta(), 0.0);
        let mut still = DeadZone::new(0.02, 0.1, 0);
        assert!(!still.update(|| [1.0, -0.03]));
    }

    #[test]
    fn inputs_at_the_edges() {
        assert_eq!(dead_zone(0.03, 0.03), [0.0, 0.0]);
        assert_eq!(dead_zone(f32::NAN, 0.03), [0.0, 0.0]);
        assert_eq!(asymmetric(0.5), [0.5, 0.0]);
        assert_eq!(asymmetric(0.0), [0.0, 0.0]);
        assert_eq!(coulomb(0.01, 0.01), 0.0);
        assert_eq!(coulomb(f32::NAN, 0.01), 0.0);
    }
}
