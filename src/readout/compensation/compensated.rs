//! The estimate without the bias of white noise, and what is unknown of it.

use crate::math::matrix::{Matrix, add_square};
use crate::readout::beginning::Considered;
use crate::readout::compensation::correction::Correction;

/// Variances of the residual.
pub(crate) struct Residual {
    /// Of white noise of y, to be seen through `A/A_f`.
    pub(crate) shaped: f32,
    /// Of the rest.
    pub(crate) even: f32,
    /// By which the significance of a constant is measured.
    pub(crate) significance: f32,
}

/// The estimate with the bias of white noise taken out.
pub(crate) struct Compensated<const M: usize, const N: usize> {
    /// The parameters as the trends have them, in the user's units.
    pub(crate) theta: [f32; N],
    /// `None` where nothing was corrected.
    pub(super) correction: Option<Correction<M, N>>,
    /// Bias of each parameter by noise that was not taken out or is in doubt, in the user's units.
    pub(in crate::readout) left: [f32; N],
    /// The same by the noise in doubt for a drive that the estimate does not tell, parameter of y
    /// by parameter.
    pub(in crate::readout) in_doubt: [[f32; N]; M],
    pub(crate) residual: Residual,
    /// The error of y(0), of which theta knows nothing.
    pub(in crate::readout) considered: Option<Considered<N>>,
}

impl<const M: usize, const N: usize> Compensated<M, N> {
    /// P_c, normalised, from the covariance `p` of the recursion.
    pub(crate) fn covariance(&self, p: &Matrix<N>) -> Matrix<N> {
        let mut covariance = *p;
        if let Some(correction) = &self.correction {
            correction.add_covariance(&mut covariance);
        }
        covariance
    }

    /// The share of the noise that was taken out, in [0, 1].
    pub(crate) fn share(&self) -> f32 {
        self.correction.as_ref().map_or(1.0, |found| found.share)
    }

    /// Q, the change of the estimate per unit of a score, normalised.
    pub(crate) fn gain(&self, p: &Matrix<N>) -> Matrix<N> {
        let mut gain = *p;
        if let Some(correction) = &self.correction {
            correction.add_gain(&mut gain);
        }
        gain
    }

    /// Row `index` of P_c, enough for an estimate without deviations; what is only considered of
    /// a beginning changes no estimate, and is not in it.
    #[inline(always)]
    pub(crate) fn covariance_row(&self, p: &Matrix<N>, index: usize) -> Option<[f32; N]> {
        let mut row = *p.get(index)?;
        if let Some(correction) = &self.correction {
            correction.add_row(index, &mut row);
        }
        Some(row)
    }

    /// The variance of a parameter over that of its row, by what is only considered.
    #[inline(never)]
    pub(crate) fn considered(&self, p: &Matrix<N>, index: usize) -> f32 {
        let considered = self.considered.as_ref();
        let more = considered.map_or(0.0, |considered| considered.of(index));
        if more == 0.0 {
            return 1.0;
        }
        let row = self.covariance_row(p, index);
        let own = row.and_then(|row| row.get(index).copied()).unwrap_or(0.0);
        1.0 + if own > 0.0 { more / own } else { 0.0 }
    }

    /// Adds the bias by noise that was not taken out, and that in doubt, in the user's units.
    pub(crate) fn add_left(&self, covariance: &mut Matrix<N>) {
        for bias in self.biases() {
            add_square(covariance, &bias, 1.0);
        }
    }

    /// The vectors whose squares that adds.
    pub(crate) fn biases(&self) -> impl Iterator<Item = [f32; N]> {
        core::iter::once(self.left).chain(self.in_doubt)
    }

    /// The vectors whose squares P_c has beyond P.
    pub(crate) fn beyond(&self) -> impl Iterator<Item = [f32; N]> {
        let columns = |of| self.correction.as_ref().map(|found| found.columns(of));
        (0..M).filter_map(columns).flatten()
    }
}
