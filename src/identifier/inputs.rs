//! Inputs made from the command: nonlinearities of valves, cylinders and friction as terms of the regressor.

use crate::error::positive;
use crate::estimation::terms::{Parameter, index_of};
use crate::identifier::Identifier;
use crate::identifier::outcome::Outcome;
use crate::trends::TrendOperator;

/// The two inputs that a valve with the dead zone `delta` needs beside a constant.
///
/// A valve that passes `u - delta sgn(u)` for `|u| > delta` and nothing inside is
/// linear in `[u, sgn(u)]`, both switched off inside the dead zone. The ratio of the
/// two numerators is `-delta`.
///
/// # Examples
/// ```
/// assert_eq!(trendid::inputs::dead_zone(0.5, 0.03), [0.5, 1.0]);
/// assert_eq!(trendid::inputs::dead_zone(-0.5, 0.03), [-0.5, -1.0]);
/// assert_eq!(trendid::inputs::dead_zone(0.02, 0.03), [0.0, 0.0]);
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

/// The two inputs of a valve with an unknown dead zone, and the estimate of its width.
///
/// With the inputs of [`dead_zone`] for a width delta near the true one, the numerators give the true one:
///
/// ```text
/// delta <- -b_sgn / b_u          once per block
/// ```
///
/// b_u and b_sgn are the b_0 of the first and the second input of the identifier. Samples with an old width contain its
/// error and have to be forgotten: give the identifier a memory of about two blocks. Begin with a width that is too small
/// rather than too large (0 is good).
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
/// See [`ValveServo`](crate::ValveServo) for a whole identification.
/// ```
/// let mut valve = trendid::inputs::DeadZone::new(0.0, 0.1, 2);
/// assert_eq!(valve.inputs(0.02), [0.02, 1.0]);
/// assert!(valve.correct([2.0, -0.06])); // delta = 0.06 / 2
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
    /// NaN and values outside their range become 0; a block of 0 samples corrects nothing.
    pub const fn new(delta: f32, largest: f32, block: u32) -> Self {
        let largest = if positive(largest) { largest } else { 0.0 };
        let delta = if delta >= 0.0 && delta <= largest {
            delta
        } else {
            0.0
        };
        Self {
            delta,
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

    /// Takes u(k) and y(k) into an identifier with these two inputs and corrects the width at the end of a block.
    #[inline]
    pub fn identify<T: TrendOperator<M>, const M: usize, const N: usize, const D: usize>(
        &mut self,
        identifier: &mut Identifier<T, M, N, 2, D>,
        u: f32,
        y: f32,
    ) -> Outcome {
        let outcome = identifier.update_inputs(self.inputs(u), y);
        let _ = self.update(identifier);
        outcome
    }

    /// Counts a sample; at the end of a block corrects the width by the numerators of the identifier.
    ///
    /// Returns whether it was corrected.
    #[inline]
    pub fn update<
        T: TrendOperator<M>,
        const M: usize,
        const N: usize,
        const I: usize,
        const D: usize,
    >(
        &mut self,
        identifier: &Identifier<T, M, N, I, D>,
    ) -> bool {
        self.count = self.count.saturating_add(1);
        if self.count < self.block || self.block == 0 {
            return false;
        }
        self.count = 0;
        let theta = identifier.theta();
        let parameters = identifier.structure().parameters();
        let b0 = |input| {
            let index = index_of(&parameters, Parameter::Input { input, power: 0 })?;
            theta.get(index).copied()
        };
        match (b0(0), b0(1)) {
            (Some(linear), Some(sign)) => self.correct([linear, sign]),
            _ => false,
        }
    }

    /// Corrects the width by the numerators `[b_u, b_sgn]`.
    ///
    /// Returns whether it was corrected: a quotient outside 0 ..= `largest` changes nothing.
    pub fn correct(&mut self, [linear, sign]: [f32; 2]) -> bool {
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
/// assert_eq!(trendid::inputs::asymmetric(-2.0), [0.0, -2.0]);
/// ```
#[inline]
pub fn asymmetric(u: f32) -> [f32; 2] {
    if u > 0.0 { [u, 0.0] } else { [0.0, u] }
}

/// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero.
///
/// # Examples
/// ```
/// assert_eq!(trendid::inputs::coulomb(-0.4, 0.01), -1.0);
/// assert_eq!(trendid::inputs::coulomb(0.001, 0.01), 0.0);
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
    use crate::identifier::servo::ValveServo;

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
            assert!(!valve.correct(numerators));
            assert_eq!(valve.delta(), 0.02);
        }
        assert_eq!(DeadZone::new(f32::NAN, 0.1, 1).delta(), 0.0);
        assert_eq!(DeadZone::new(0.2, 0.1, 1).delta(), 0.0);
        assert_eq!(DeadZone::new(0.2, f32::NAN, 1).delta(), 0.0);
        let mut valve = DeadZone::new(0.02, 0.1, 0);
        let servo = ValveServo::new(0.001, 20.0, 1.0, 50.0, 0.7).unwrap();
        for _ in 0..10 {
            assert!(!valve.update(&servo));
        }
        assert_eq!(valve.delta(), 0.02);
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
