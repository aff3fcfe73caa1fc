//! How certain the parameters are that a fit has found, in pieces.

use crate::math::matrix::{Matrix, factor_columns};
use crate::servo::commissioning::predictor::PARAMETERS;
use crate::servo::commissioning::sums::{HALF, Sums};

/// How far the standard deviations are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Certainty {
    /// Half of the Cholesky factor of the normal equations in reverse order is there, or all of it.
    Halved,
    Factored,
    Known([f32; 4]),
}

impl Certainty {
    /// That of what no point shows.
    pub(super) const UNKNOWN: Self = Self::Known([f32::INFINITY; 4]);

    /// A piece of the standard deviations of these sums in these scales, in the same `factor` each
    /// time. Cost: some 1500 instructions.
    pub(super) fn advance(
        self,
        factor: &mut Matrix<PARAMETERS>,
        sums: &Sums,
        scale: &[f32; PARAMETERS],
    ) -> Self {
        let (next, solved) = match self {
            Self::Known(_) => {
                *factor = sums.reversed(scale);
                (Self::Halved, factor_columns(factor, 0, HALF))
            }
            Self::Halved => (Self::Factored, factor_columns(factor, HALF, PARAMETERS)),
            Self::Factored => (Self::Known(sums.std(factor, scale)), true),
        };
        if solved { next } else { Self::UNKNOWN }
    }
}
