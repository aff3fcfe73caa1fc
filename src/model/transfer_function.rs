//! The transfer function that theta stands for, its poles and its stability.

use crate::math::polynomial::is_hurwitz;
use crate::math::{pow, sqrt};

/// `G(s) = (b_{m-1} s^{m-1} + .. + b_0) / (s^m + a_{m-1} s^{m-1} + .. + a_0)` for each input, equation (1).
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
///     integrators: 1,
/// };
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
    /// What the constant input contributes, in units of y per s^m.
    pub constant: f32,
    /// How many poles the structure puts at s = 0.
    pub integrators: usize,
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
    /// Whether every coefficient is finite.
    pub fn is_finite(&self) -> bool {
        self.a.iter().all(|v| v.is_finite())
            && self.b.as_flattened().iter().all(|v| v.is_finite())
            && self.constant.is_finite()
    }

    /// Static gain `b_0/a_0`; with integrators the gain behind them, `b_0/a_nu` (velocity per unit of u for one).
    ///
    /// `None` if the input does not exist, a_nu is 0 or the quotient is not finite.
    pub fn gain(&self, input: usize) -> Option<f32> {
        let b0 = self.b.get(input)?.first()?;
        let below = match self.a.get(self.integrators) {
            Some(a) => *a,
            None => 1.0, // nothing but integrators
        };
        let gain = b0 / below;
        (below != 0.0 && gain.is_finite()).then_some(gain)
    }

    /// Whether all poles but the integrators lie in the left half plane (Hurwitz conditions).
    pub fn is_stable(&self) -> bool {
        self.a.get(self.integrators..).is_none_or(is_hurwitz)
    }

    /// The poles in rad/s, integrators first, then by rising distance from zero.
    ///
    /// `None` if a coefficient is not finite or the iteration (Durand-Kerner) does not settle.
    pub fn poles(&self) -> Option<[Pole; M]> {
        let mut poles = [Pole { re: 0.0, im: 0.0 }; M];
        let a = self.a.get(self.integrators..)?;
        let found = poles.get_mut(self.integrators..)?;
        if !a.iter().all(|v| v.is_finite()) {
            return None;
        }
        match *a {
            [] => {}
            [a0] => found[0].re = -a0,
            [a0, a1] => quadratic(a0, a1, found),
            _ => durand_kerner(a, found)?,
        }
        let finite = poles.iter().all(|p| p.re.is_finite() && p.im.is_finite());
        finite.then_some(poles)
    }
}

/// Roots of s^2 + a1 s + a0 without cancellation.
fn quadratic(a0: f32, a1: f32, roots: &mut [Pole]) {
    let half = 0.5 * a1;
    let discriminant = half * half - a0;
    if discriminant < 0.0 {
        let im = sqrt(-discriminant);
        roots[0] = Pole { re: -half, im };
        roots[1] = Pole { re: -half, im: -im };
        return;
    }
    let root = sqrt(discriminant);
    let far = if half < 0.0 {
        -half + root
    } else {
        -half - root
    };
    let near = if far != 0.0 { a0 / far } else { 0.0 };
    roots[0] = Pole { re: near, im: 0.0 };
    roots[1] = Pole { re: far, im: 0.0 };
}

/// Sum of the last steps, on roots whose product is 1, up to which the iteration counts as settled.
const SETTLED: f32 = 0.1;

/// All roots at once, on the polynomial scaled to a unit product of roots.
fn durand_kerner(a: &[f32], roots: &mut [Pole]) -> Option<()> {
    let order = a.len();
    if order > 4 {
        return None;
    }
    let scale = pow(a[0].abs(), 1.0 / order as f32);
    let scale = if scale > 0.0 && scale.is_finite() {
        scale
    } else {
        1.0
    };
    let mut normal = [0.0; 4];
    let mut power = 1.0;
    for i in (0..order).rev() {
        power *= scale;
        normal[i] = a[i] / power;
    }
    // Starting values on a spiral that no symmetry of the polynomial can trap.
    let seed = Pole { re: 0.4, im: 0.9 };
    let mut start = Pole { re: 1.0, im: 0.0 };
    for root in roots.iter_mut() {
        start = mul(start, seed);
        *root = start;
    }
    // Near a multiple root rounding throws the iterates about: the calmest ones are the answer.
    let mut calmest = f32::MAX;
    let mut best = [Pole { re: 0.0, im: 0.0 }; 4];
    for _ in 0..200 {
        let mut moved = 0.0;
        for i in 0..order {
            let mut value = Pole { re: 1.0, im: 0.0 };
            for j in (0..order).rev() {
                value = mul(value, roots[i]);
                value.re += normal[j];
            }
            let mut product = Pole { re: 1.0, im: 0.0 };
            for j in 0..order {
                if j != i {
                    let apart = Pole {
                        re: roots[i].re - roots[j].re,
                        im: roots[i].im - roots[j].im,
                    };
                    product = mul(product, apart);
                }
            }
            let size = product.re * product.re + product.im * product.im;
            if size > 0.0 {
                let step = mul(
                    value,
                    Pole {
                        re: product.re / size,
                        im: -product.im / size,
                    },
                );
                roots[i].re -= step.re;
                roots[i].im -= step.im;
                moved += step.re.abs() + step.im.abs();
            }
        }
        if moved < calmest {
            calmest = moved;
            best[..order].copy_from_slice(roots);
        }
        if moved < 1e-6 {
            break;
        }
    }
    roots.copy_from_slice(&best[..order]);
    for root in roots.iter_mut() {
        if root.im.abs() < 1e-4 * (root.re.abs() + 1e-3) {
            root.im = 0.0;
        }
        root.re *= scale;
        root.im *= scale;
    }
    roots.sort_unstable_by(|p, q| {
        let (p, q) = (p.re * p.re + p.im * p.im, q.re * q.re + q.im * q.im);
        p.total_cmp(&q)
    });
    // A k-fold root is found to the k-th root of the precision only: 2^-6 for four equal ones.
    (calmest < SETTLED).then_some(())
}

fn mul(p: Pole, q: Pole) -> Pole {
    Pole {
        re: p.re * q.re - p.im * q.im,
        im: p.re * q.im + p.im * q.re,
    }
}
