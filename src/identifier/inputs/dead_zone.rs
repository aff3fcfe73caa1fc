//! A valve with a dead zone: its two inputs, and the estimate of its width.

use crate::error::positive;
use crate::estimation::terms::{Parameter, index_of};
use crate::math::{deviation, larger, smaller};
use crate::readout::Estimate;

/// Standard deviations by which the width in the inputs stays below the one found.
const CAUTION: f32 = 2.0;

/// Standard deviations of its denominator within which a quotient may be anything.
const DISTANCE: f32 = 3.0;

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

/// The width of an unknown dead zone, and the two inputs that are made with it.
///
/// With the inputs of [`dead_zone`] for a width delta near the true one, the numerators give the
/// true one:
///
/// ```text
/// delta <- -b_sgn / b_u                       once per block
/// w     <- max(0, delta - 2 sigma)            the width in the inputs; sigma by noise alone
/// upper <- delta + bias + 2 sigma             the largest that is possible
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
/// A quotient has a standard deviation while its denominator is more than three of its own away
/// from 0 (Fieller, 1954): `sigma / (1 - g)`, `g = (3 sigma_b / b_u)^2`, where sigma is that to
/// first order; from g = 1 on it is infinite.
///
/// # Limits
/// Two levels of the command do not determine gain, width and constant; three do if each of them
/// lasts long enough, some 3 / bandwidth. Until then [`DeadZone::std`] is large.
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | delta | `delta`, start; at most `largest` | of u |
/// | - | `largest`: no dead zone is wider | of u |
/// | - | `block` | samples between corrections |
///
/// Measured on the reference servo in closed loop (dead zone 0.03, memory 0.7 s, blocks of 0.3 s, 4
/// s of steps, 100 seeds): with white noise 0.02 mm wide the width is right within 0.0005 and C,
/// omega0 and xi within 1 %; with 0.1 mm their rms errors stay below 1 %.
///
/// # Examples
/// See [`ValveServo`](crate::ValveServo) for a whole identification, and [`Valved`](super::Valved)
/// for what the largest width that is possible means to the deviations.
/// ```
/// let valve = trendid::inputs::DeadZone::new(0.025, 0.1, 300);
/// assert_eq!(valve.inputs(0.02), [0.0, 0.0]);
/// assert_eq!(valve.inputs(0.03), [0.03, 1.0]);
/// assert!(valve.std().is_infinite()); // until a block has been measured
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadZone {
    delta: f32,
    std: f32,
    /// The width in the inputs.
    cautious: f32,
    /// The largest that is possible.
    upper: f32,
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
            upper: largest,
            largest,
            block,
            count: 0,
        }
    }

    /// Half width of the dead zone, in the unit of u.
    pub const fn delta(&self) -> f32 {
        self.delta
    }

    /// Standard deviation of the half width at the last correction, in the unit of u; infinite
    /// before.
    pub const fn std(&self) -> f32 {
        self.std
    }

    /// The largest width that is possible, in the unit of u.
    pub(super) const fn upper(&self) -> f32 {
        self.upper
    }

    /// The two inputs for a command. Cost: 6 instructions.
    #[inline]
    pub fn inputs(&self, u: f32) -> [f32; 2] {
        dead_zone(u, self.cautious)
    }

    /// Counts a sample; whether a block ends with it.
    #[inline]
    pub(super) const fn count_sample(&mut self) -> bool {
        self.count = self.count.saturating_add(1);
        let due = self.block > 0 && self.count >= self.block;
        if due {
            self.count = 0;
        }
        due
    }

    /// Corrects the width by an estimate, its deviations by noise alone, and its `bias` by the
    /// largest width that is possible.
    pub(super) fn take<const M: usize, const N: usize, const I: usize>(
        &mut self,
        estimate: &Estimate<M, N, I>,
        bias: &[f32; N],
    ) {
        if let Some(found) = Quotient::of(estimate, bias) {
            let _ = self.correct(found);
        }
    }

    /// Returns whether it was corrected: a quotient outside 0 ..= `largest` changes the width in
    /// the inputs alone.
    fn correct(&mut self, found: Quotient) -> bool {
        let Quotient { delta, noise, bias } = found;
        let accepted = delta >= 0.0 && delta <= self.largest;
        if accepted {
            self.delta = delta;
        }
        let noise = if noise >= 0.0 { noise } else { f32::INFINITY };
        let bias = if bias >= 0.0 { bias } else { f32::INFINITY };
        self.std = deviation(noise * noise + bias * bias);
        self.cautious = larger(self.delta - CAUTION * noise, 0.0);
        self.upper = smaller(self.delta + (bias + CAUTION * noise), self.largest);
        accepted
    }
}

/// -b_sgn / b_u, and what is unknown of it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Quotient {
    delta: f32,
    /// Standard deviation by noise.
    noise: f32,
    /// Size of the bias.
    bias: f32,
}

impl Quotient {
    /// That of a model with two inputs.
    fn of<const M: usize, const N: usize, const I: usize>(
        estimate: &Estimate<M, N, I>,
        bias: &[f32; N],
    ) -> Option<Self> {
        let parameters = estimate.structure().parameters();
        let (theta, covariance) = (estimate.theta(), estimate.covariance());
        let b0 = |input| index_of(&parameters, Parameter::Input { input, power: 0 });
        let (u, sgn) = (b0(0)?, b0(1)?);
        let (linear, sign) = (*theta.get(u)?, *theta.get(sgn)?);
        let entry = |i: usize, j: usize| covariance.get(i)?.get(j).copied();
        let quotient = sign / linear;
        let own = entry(u, u)?;
        let variance = entry(sgn, sgn)? + quotient * (quotient * own - 2.0 * entry(u, sgn)?);
        let near = DISTANCE * DISTANCE * own / (linear * linear);
        let known = if near < 1.0 { 1.0 - near } else { 0.0 };
        Some(Self {
            delta: -quotient,
            noise: deviation(variance) / (linear.abs() * known),
            bias: (bias.get(sgn)? - quotient * bias.get(u)?).abs() / linear.abs(),
        })
    }
}

#[cfg(test)]
mod tests;
