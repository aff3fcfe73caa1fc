//! What an error of the first input does to the estimate.

use crate::estimation::terms::{Parameter, index_of};
use crate::math::matrix::product_row;
use crate::readout::source::ReadOut;

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// Index of b_0 of the first input.
    fn index_of_b0(&self) -> Option<usize> {
        index_of(
            &self.structure.parameters(),
            Parameter::Input { input: 0, power: 0 },
        )
    }

    /// Scale of the column of b_0; 0 where there is none.
    pub(crate) fn scale_of_b0(&self) -> f32 {
        let unit = self
            .index_of_b0()
            .and_then(|at| self.regressor.units().get(at));
        unit.map_or(0.0, |unit| unit * self.regressor.top_scale())
    }

    /// Bias of each parameter, in the user's units, by an error e of the first input, of which
    /// `scores` has `r = sum phi F e`, F e as the column of b_0.
    ///
    /// A row is off by `b_0 F e`, the estimate by `b_0 Q r`; of that b_0 is known with the part
    /// `rho = |(Q r)_b0|` of itself, so that it is `|found| / (1 - rho)` at most, and infinite from
    /// rho = 1 on. Rounding is as small beside it as the difference between the planes.
    pub(crate) fn bias_by_input(&self, scores: &[f32; N]) -> [f32; N] {
        let Some(at) = self.index_of_b0() else {
            return [0.0; N];
        };
        let regression = self.regression();
        let (found, _) = self.compensated(&regression, false);
        let relative = product_row(scores, &found.gain(&regression.p));
        let units = self.regressor.units();
        let known = 1.0 - relative[at].abs();
        let size = if known > 0.0 {
            found.theta[at].abs() / (known * units[at])
        } else {
            f32::INFINITY
        };
        core::array::from_fn(|i| match relative[i] == 0.0 {
            true => 0.0,
            false => size * relative[i] * units[i],
        })
    }
}
