//! How well nominal values are known, and what they leave of P without data.

use crate::estimation::forgetting::StabilisedForgetting;

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
