//! What an identifier shows of its samples to something that runs beside it.

use crate::estimation::rls::Estimator;

/// Sees the trends of the inputs and the rows of an identifier; `()` sees nothing and costs
/// nothing.
pub(crate) trait Witness<const M: usize, const N: usize, const I: usize> {
    /// The trends of the inputs begin anew, at rest.
    fn begin(&mut self);
    /// The trends of the inputs of a sample, also of one without y, and the inputs as they act,
    /// behind their delays.
    fn inputs(&mut self, trends: &[[f32; M]; I], acting: &[f32; I]);
    /// A row that the estimator has taken: the normalised regressor and its left-hand side, and
    /// whether lambda was applied before.
    fn row(&mut self, phi: &[f32; N], psi: f32, estimator: &Estimator<N>, forgot: bool);
    /// The initial state is another one from now on; `before`, normalised, is the one that the rows
    /// up to now had.
    #[inline(always)]
    fn another_initial_state(&mut self, before: f32) {
        let _ = before;
    }
    /// The covariance of the estimator was changed by something that is no row.
    #[inline(always)]
    fn widened(&mut self) {}
    /// The drive is another one from now on: rows up to now hold no information on it.
    #[inline(always)]
    fn changed(&mut self) {
        self.widened();
    }
}

impl<const M: usize, const N: usize, const I: usize> Witness<M, N, I> for () {
    #[inline(always)]
    fn begin(&mut self) {}
    #[inline(always)]
    fn inputs(&mut self, _: &[[f32; M]; I], _: &[f32; I]) {}
    #[inline(always)]
    fn row(&mut self, _: &[f32; N], _: f32, _: &Estimator<N>, _: bool) {}
}
