//! How well nominal values are known, and what they leave of P without data.

use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::postponed::PAUSE;
use crate::math::{larger, smaller};

/// Share of the bound at which P_kk stays under rows that bring little.
const LEAST: f32 = 1.0 / (1.0 + PAUSE as f32);

/// `value`, but no less than `least` and no more than `most`.
const fn between(least: f32, value: f32, most: f32) -> f32 {
    smaller(larger(value, least), most)
}

impl<const N: usize> StabilisedForgetting<N> {
    /// Sets the standard deviations of the present nominal values, relative to the noise of psi.
    ///
    /// P counts the observations of nominal values as if they had the noise of the data; a reading
    /// adds this. It is forgotten parameter by parameter, when the data show one.
    pub(crate) fn set_nominal_std(&mut self, std: &[f32; N]) {
        self.unsupported = std.map(|std| std * std);
    }

    /// Sets the variances of nominal values that were set, in the same unit: whatever the data
    /// show, where they show nothing any more the estimate returns to values that are known so
    /// well and no better.
    pub(crate) const fn set_own(&mut self, variances: [f32; N]) {
        self.own = variances;
    }

    /// The own variance of each nominal value, 0 for a former estimate, and whether no data
    /// support it: then it is that of a prior, otherwise as it was set.
    pub(crate) fn own_variances(&self) -> [(bool, f32); N] {
        core::array::from_fn(|i| match self.unsupported[i] {
            prior if prior > 0.0 => (true, prior),
            _ => (false, self.own[i]),
        })
    }

    /// P_kk that nominal value `k` alone leaves of what is `now`, and how much of its own variance
    /// P lacks, which counts it as if it had the `noise` of the data, relative to the expected one.
    ///
    /// ```text
    /// Sigma <- sigma_0^2 (noise P + sum over k: (P e_k / whole_k) (P e_k / whole_k)' (own_k - whole_k noise))
    /// ```
    ///
    /// A prior alone leaves itself, observations of the value the bound or, as motion that shows
    /// little is forgotten for at every eighth row only, an eighth of it: as much as P_kk is
    /// between the least of these and the bound. So a value is taken for all that is known down to
    /// there, and by the share of P_kk below.
    pub(crate) fn lacking(&self, (prior, own): (bool, f32), now: f32, noise: f32) -> [f32; 2] {
        let whole = match prior && own > self.bound {
            true => own,
            false => between(smaller(own, LEAST * self.bound), now, self.bound),
        };
        [whole, own - whole * noise]
    }

    /// Sets the present estimate as nominal, as well known as it is: by `p`, under this `noise` of
    /// the data over the expected one, and by the nominal values before.
    ///
    /// With P alone a value that only a prior tells would count as one that was measured by the
    /// noise of the data: from then on wrong values, for certain.
    pub(crate) fn set_known(&mut self, theta: [f32; N], p: &[[f32; N]; N], noise: f32) {
        let own = self.own_variances();
        let mut known: [f32; N] = core::array::from_fn(|i| noise * p[i][i]);
        for (k, own) in own.into_iter().enumerate() {
            let [whole, missing] = self.lacking(own, p[k][k], noise);
            if !(whole > 0.0 && missing > 0.0) {
                continue;
            }
            let inverse = 1.0 / whole;
            for (known, row) in known.iter_mut().zip(p) {
                let share = row[k] * inverse;
                *known += share * share * missing;
            }
        }
        self.set_nominal(theta);
        self.set_own(known);
    }

    /// P_ii that each nominal value alone leaves, and its own variance.
    pub(crate) fn nominal_variances(&self) -> [(f32, f32); N] {
        let left = self.left();
        let own = self.own_variances();
        core::array::from_fn(|i| (left[i], own[i].1))
    }

    /// P_ii that each nominal value alone leaves.
    pub(crate) fn left(&self) -> [f32; N] {
        (self.unsupported).map(|own| if own > self.left { own } else { self.left })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_kept_between_its_limits_of_which_the_upper_one_counts_most() {
        for (value, kept) in [(0.5, 1.0), (2.0, 2.0), (4.0, 3.0)] {
            assert_eq!(between(1.0, value, 3.0), kept);
        }
        assert_eq!(between(5.0, 1.0, 3.0), 3.0);
    }
}
