//! A valve with a dead zone: its two inputs, and the estimate of its width.

use crate::error::positive;
use crate::estimation::terms::{Parameter, index_of};
use crate::identifier::Identifier;
use crate::identifier::outcome::Outcome;
use crate::math::deviation;
use crate::readout::Estimate;
use crate::trends::TrendOperator;

/// Standard deviations by which the width in the inputs stays below the one found.
const CAUTION: f32 = 2.0;

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
/// With the inputs of [`dead_zone`] for a width delta near the true one, the numerators give the
/// true one:
///
/// ```text
/// delta <- -b_sgn / b_u                       once per block
/// w     <- max(0, delta - 2 sigma_delta)      the width in the inputs
/// ```
///
/// b_u and b_sgn are the b_0 of the first and the second input of the identifier. Samples with an
/// old width contain its error and have to be forgotten: give the identifier a memory of about two
/// blocks.
///
/// A width that is too small costs nothing while every command lies outside the dead zone. One
/// above a command that the valve lets pass switches that command off, and the estimate from such
/// inputs confirms the error. So the inputs are made with the width less two of its standard
/// deviations. Begin with a width that is too small (0 is good).
///
/// # Limits
/// Two levels of the command do not determine gain, width and constant; three do if each of them
/// lasts long enough, some 3 / bandwidth. Until then [`DeadZone::std`] is large. A smooth command,
/// a sine or a triangle, is for a part of the time between the width in the inputs and the true
/// one; such rows contradict the model, and width and deviations stay wrong.
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | delta | `delta`, start; at most `largest` | of u |
/// | - | `block` | samples between corrections |
///
/// Measured on the reference servo in closed loop (dead zone 0.03, memory 0.7 s, blocks of 0.3 s, 4
/// s of steps, 100 seeds): with white noise 0.02 mm wide the width is right within 0.0005 and C,
/// omega0 and xi within 1 %; with 0.1 mm their rms errors stay below 1 %.
///
/// # Examples
/// See [`ValveServo`](crate::ValveServo) for a whole identification.
/// ```
/// let mut valve = trendid::inputs::DeadZone::new(0.0, 0.1, 2);
/// assert_eq!(valve.inputs(0.02), [0.02, 1.0]);
/// assert!(valve.correct([2.0, -0.06], 0.002)); // delta = 0.06 / 2, known to 0.002
/// assert!((valve.delta() - 0.03).abs() < 1e-7);
/// assert_eq!(valve.inputs(0.02), [0.0, 0.0]);
/// assert_eq!(valve.inputs(0.028), [0.028, 1.0]); // may pass the valve
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadZone {
    delta: f32,
    std: f32,
    /// The width in the inputs.
    cautious: f32,
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
            std: f32::INFINITY,
            cautious: delta,
            largest,
            block,
            count: 0,
        }
    }

    /// Half width of the dead zone, in the unit of u.
    pub const fn delta(&self) -> f32 {
        self.delta
    }

    /// Standard deviation of -b_sgn / b_u at the last correction, in the unit of u; infinite
    /// before.
    pub const fn std(&self) -> f32 {
        self.std
    }

    /// The two inputs for a command. Cost: 6 instructions.
    #[inline]
    pub fn inputs(&self, u: f32) -> [f32; 2] {
        dead_zone(u, self.cautious)
    }

    /// Takes u(k) and y(k) into an identifier with these two inputs and corrects the width at the
    /// end of a block.
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

    /// Counts a sample; at the end of a block corrects the width by the numerators of the
    /// identifier.
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
        match numerators(&identifier.estimate()) {
            Some((numerators, std)) => self.correct(numerators, std),
            None => false,
        }
    }

    /// Corrects the width by the numerators `[b_u, b_sgn]`, whose quotient has the standard
    /// deviation `std`.
    ///
    /// Returns whether it was corrected: a quotient outside 0 ..= `largest` changes the width in
    /// the inputs alone.
    pub fn correct(&mut self, [linear, sign]: [f32; 2], std: f32) -> bool {
        let delta = -sign / linear;
        let accepted = delta >= 0.0 && delta <= self.largest;
        if accepted {
            self.delta = delta;
        }
        self.std = if std >= 0.0 { std } else { f32::INFINITY };
        self.cautious = (self.delta - CAUTION * self.std).max(0.0);
        accepted
    }
}

/// `[b_u, b_sgn]` of a model with two inputs, and the standard deviation of their quotient to first
/// order.
fn numerators<const M: usize, const N: usize, const I: usize>(
    estimate: &Estimate<M, N, I>,
) -> Option<([f32; 2], f32)> {
    let parameters = estimate.structure().parameters();
    let (theta, covariance) = (estimate.theta(), estimate.covariance());
    let b0 = |input| index_of(&parameters, Parameter::Input { input, power: 0 });
    let (u, sgn) = (b0(0)?, b0(1)?);
    let (linear, sign) = (*theta.get(u)?, *theta.get(sgn)?);
    let entry = |i: usize, j: usize| covariance.get(i)?.get(j).copied();
    let quotient = sign / linear;
    let variance = entry(sgn, sgn)? + quotient * (quotient * entry(u, u)? - 2.0 * entry(u, sgn)?);
    Some(([linear, sign], deviation(variance) / linear.abs()))
}

#[cfg(test)]
mod tests;
