//! What an estimate hands over to another filter.
//!
//! P of the recursion is no measure of what is known of the model: it counts the noise in its
//! regressors as motion, and knows nothing of a column that stands beside it. Behind another filter
//! that is no longer taken out at the read-out. So the recursion goes on with the covariance of
//! the estimate: `P_c`, the bias that is left in it and the error of trends in place of
//! derivatives, given as the vectors whose squares these are beyond P.

use crate::math::sqrt;
use crate::readout::beginning::Column;
use crate::readout::compensation::Compensated;
use crate::readout::source::ReadOut;

/// An estimate, and what is unknown of it beyond P.
pub(crate) struct HandedOver<const M: usize, const N: usize> {
    found: Compensated<M, N>,
    column: Option<Column<N>>,
    /// The error of each parameter that no residual shows, in the user's units, and the shares of
    /// its square that is common to all and its own.
    unseen: [f32; N],
    shares: [f32; 2],
    /// What normalises a parameter in the user's units, over the deviation of the residual.
    scales: [f32; N],
}

impl<const M: usize, const N: usize> HandedOver<M, N> {
    /// The parameters as the trends have them, in the user's units.
    pub(crate) const fn theta(&self) -> &[f32; N] {
        &self.found.theta
    }

    /// The vectors whose squares are beyond P, normalised.
    pub(crate) fn beyond(&self) -> impl Iterator<Item = [f32; N]> {
        let of_column = |column: &Column<N>| {
            let deviation = sqrt(column.variance);
            column.direction.map(|direction| direction * deviation)
        };
        let column = self.column.as_ref().map(of_column);
        let normalised = |bias: [f32; N]| core::array::from_fn(|j| bias[j] * self.scales[j]);
        let [common, own] = self.shares.map(sqrt);
        let alone = (0..N).map(move |i| {
            core::array::from_fn(|j| if i == j { own * self.unseen[j] } else { 0.0 })
        });
        let unseen = alone.chain([self.unseen.map(|error| common * error)]);
        let left = self.found.biases().chain(unseen).map(normalised);
        self.found.beyond().chain(column).chain(left)
    }
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// What another filter goes on from.
    #[inline(never)]
    pub(crate) fn handed_over(&self) -> HandedOver<M, N> {
        let mut regression = self.recursion_alone();
        let column = self.column(&regression);
        if let Some(column) = &column {
            column.enter(&mut regression);
        }
        let found = self.compensated(&regression, true).0;
        let common = self.common(false);
        let (units, deviation) = (self.regressor.units(), sqrt(self.residual()));
        HandedOver {
            unseen: self.floor_of(&found.theta),
            shares: [common, self.common(true) - common],
            found,
            column,
            scales: units.map(|unit| 1.0 / (unit * deviation)),
        }
    }
}
