//! To what the estimate returns where nothing excites it.

use crate::identifier::Identifier;
use crate::trends::TrendOperator;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Identifier<T, M, N, I, D>
{
    /// With a memory: makes the current estimate the nominal one, to which the estimate returns
    /// where nothing excites it; but for the initial state, which is another one of each beginning.
    ///
    /// They are as well known as the estimate is then: what only a prior had told stays as
    /// uncertain as that. Without this call the nominal values follow the estimate while it is well
    /// known.
    #[doc(alias = "trust")]
    pub fn set_nominal(&mut self) {
        self.state.set_nominal(&self.plan);
    }

    /// The same of an estimate that later data have confirmed, for less.
    pub(crate) fn set_nominal_as_shown(&mut self) {
        self.state.set_nominal_as_shown(&self.plan);
    }
}
