//! Other settings and other trends for an identifier, in pieces of a sample each.

use crate::error::ConfigError;
use crate::identifier::Identifier;
use crate::identifier::config::Config;
use crate::identifier::plan::Plan;
use crate::trends::TrendOperator;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Identifier<T, M, N, I, D>
{
    /// Takes other settings and other trends. [`Identifier::expect_noise`] and
    /// [`Identifier::reset`] must follow before the next update; in samples of their own, where all
    /// are too much for one.
    ///
    /// # Errors
    /// As of [`Identifier::try_new`]; nothing is changed then.
    pub(crate) fn replan(
        &mut self,
        config: &Config<M, N, I>,
        trends: T,
    ) -> Result<(), ConfigError> {
        self.plan = Plan::unweighed(config, trends, D)?;
        Ok(())
    }

    /// The part of a new plan that [`Identifier::replan`] leaves out.
    ///
    /// # Errors
    /// As of [`Identifier::try_new`]; none with an initial estimate of 0 and no prior.
    pub(crate) fn expect_noise(&mut self, config: &Config<M, N, I>) -> Result<(), ConfigError> {
        self.plan.expect_noise(config)
    }
}
