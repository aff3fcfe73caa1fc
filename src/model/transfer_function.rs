//! Transfer functions, their poles and their stability.

use crate::math::complex::Complex;
use crate::math::polynomial::is_hurwitz;
use crate::math::roots::roots;

/// `G(s) = (b_{m-1} s^{m-1} + .. + b_0) / (s^m + a_{m-1} s^{m-1} + .. + a_0)` for each input,
/// equation (1).
///
/// Absent parameters are 0. Units: a_i in s^(i-m), b_i in unit of y per unit of u per s^(m-i).
///
/// # Examples
/// ```
/// use trendid::TransferFunction;
/// let servo = TransferFunction::<3, 1> {
///     a: [0.0, 400.0, 20.0],
///     b: [[1.0e6, 0.0, 0.0]],
///     constant: 0.0,
/// };
/// assert_eq!(servo.integrators(), 1);
/// assert_eq!(servo.gain(0), Some(2500.0)); // b0 / a1: velocity per unit of u
/// assert!(servo.is_stable());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TransferFunction<const M: usize, const I: usize> {
    /// a_0 .. a_{m-1}.
    pub a: [f32; M],
    /// b_0 .. b_{m-1} of each input.
    pub b: [[f32; M]; I],
    /// The contribution of the constant input, in units of y per s^m.
    pub constant: f32,
}

/// A pole, in rad/s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pole {
    /// Real part.
    pub re: f32,
    /// Imaginary part.
    pub im: f32,
}

impl<const M: usize, const I: usize> TransferFunction<M, I> {
    /// How many poles lie at s = 0: the coefficients from a_0 on that are 0.
    pub fn integrators(&self) -> usize {
        self.a.iter().take_while(|a| **a == 0.0).count()
    }

    /// Whether every coefficient is 0: an estimate before the first sample.
    fn is_empty(&self) -> bool {
        let zero = |v: &f32| *v == 0.0;
        self.a.iter().all(zero) && self.b.as_flattened().iter().all(zero)
    }

    /// Whether every coefficient is finite.
    pub fn is_finite(&self) -> bool {
        self.a.iter().all(|v| v.is_finite())
            && self.b.as_flattened().iter().all(|v| v.is_finite())
            && self.constant.is_finite()
    }

    /// Static gain `b_0/a_0`; with integrators the gain behind them, `b_0/a_nu` (velocity per unit
    /// of u for one).
    ///
    /// `None` if the input does not exist, every coefficient is 0 or the quotient is not finite.
    pub fn gain(&self, input: usize) -> Option<f32> {
        let b0 = self.b.get(input)?.first()?;
        let below = match self.a.get(self.integrators()) {
            Some(a) => *a,
            None => 1.0, // nothing but integrators
        };
        let gain = b0 / below;
        (!self.is_empty() && gain.is_finite()).then_some(gain)
    }

    /// Whether all poles but the integrators lie in the left half plane (Hurwitz conditions).
    ///
    /// `false` if every coefficient is 0.
    pub fn is_stable(&self) -> bool {
        !self.is_empty() && self.behind_integrators().is_some_and(is_hurwitz)
    }

    /// The poles in rad/s, integrators first, then by rising distance from zero.
    ///
    /// `None` if a coefficient is not finite or the iteration (Durand-Kerner) does not settle.
    pub fn poles(&self) -> Option<[Pole; M]> {
        let a = self.behind_integrators()?;
        if !a.iter().all(|v| v.is_finite()) {
            return None;
        }
        let mut found = [Complex::ZERO; M];
        roots(a, found.get_mut(M - a.len()..)?)?;
        let finite = found.iter().all(|p| p.re.is_finite() && p.im.is_finite());
        finite.then_some(found.map(|Complex { re, im }| Pole { re, im }))
    }

    /// The denominator behind the integrators.
    pub(crate) fn behind_integrators(&self) -> Option<&[f32]> {
        self.a.get(self.integrators()..)
    }
}
