//! Another filter in front of the estimator, while the identifier runs.

use core::array::from_fn;

use crate::error::{ConfigError, check_not_negative, check_range, positive};
use crate::estimation::beginning::Beginning;
use crate::identifier::Identifier;
use crate::readout::in_band;
use crate::readout::s_plane::{theta_in_s_plane, theta_in_trend_plane};
use crate::trends::TrendOperator;

/// Covariance inflation at a change of the filter, for what is left of its transient and of the
/// errors of the old trends.
///
/// Of 1, 2, 3 and 5, over the drawn users of seeds 1 to 6000, more lets fewer readings err by three
/// deviations (6.6, 5.6, 5.6, 5.3 %) and fewer be within 10 % of the truth (89.7, 89.2, 88.8,
/// 88.1 %); with less than 3 the bent model of slow samples stays too long.
const INFLATION: f32 = 5.0;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Identifier<T, M, N, I, D>
{
    /// Goes on from the estimate with other trends: a filter nearer to the plant.
    ///
    /// The estimate stays, with five times the variance, so nothing jumps. The new filter begins at
    /// the present position; while its transient lasts, for `settling` seconds, the estimate is
    /// held, and the initial state becomes uncertain again. Three time constants of the slowest
    /// pole beside that of the initial state leave 5 % of the transient; no standard deviation
    /// contains this rest.
    /// A structure without an initial state has no column for the slow pole: the estimate is held
    /// until what the pole carries of a motion of `output_range` is below `output_noise`, 7 of its
    /// time constants by default.
    /// Where the filter is the same and only the numerators are new, the signals go on and nothing
    /// is held. [`Identifier::reset`] leads back to the trends of the construction. Cost: about
    /// 13000 instructions for order 3, once; not for every sample.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`] for another sample time or a negative time; nothing is changed
    /// then.
    pub fn retune(&mut self, trends: T, settling: f32) -> Result<(), ConfigError> {
        let plan = &self.plan;
        let (old, new) = (plan.trends.design(), trends.design());
        let sample_time = old.sample_time;
        check_range("sample_time", new.sample_time, [sample_time; 2])?;
        check_not_negative("settling", settling)?;
        // The noise bias belongs to the old filter: taken out now, the new one makes its own.
        let found = self.read_out().handed_over();
        let mut theta = *found.theta();
        // The covariance scales with the noise in band behind each filter.
        let a = plan.structure.denominator(&theta);
        let scale = match (old.filter, new.filter) {
            (Some(old), Some(new)) => {
                in_band(&a, &old, plan.bandwidth) / in_band(&a, &new, plan.bandwidth)
            }
            _ => 1.0,
        };
        let scale = if positive(scale) { scale } else { 1.0 };
        let units = plan.regressor.units();
        let moved = |theta: &[f32; N]| {
            if old.shares_plane(new) {
                return from_fn(|j| theta[j] / units[j]);
            }
            let s_plane = theta_in_s_plane(theta, &plan.structure, old, &[false; N]);
            let theta = theta_in_trend_plane(&s_plane, &plan.structure, new, &[false; N]);
            from_fn(|j| theta[j] / units[j])
        };
        theta = moved(&theta);
        // The nominal values mean the same model in the new plane.
        let nominal = *self.state.forgetting.nominal();
        let nominal = moved(&from_fn(|j| nominal[j] * units[j]));
        let same_filter = plan.same_filter(&trends);
        self.plan.retune(trends);
        let state = &mut self.state;
        let limit = self.plan.prior.std.map(|std| std * std);
        // What belongs to the old filter is not held for longer than the memory.
        state.call_in();
        state.postponed.suspect();
        state.remain_known();
        let noise = state.estimator.noise_variance();
        state.estimator.widen(found.beyond(), &limit);
        state.estimator.resume(theta, INFLATION * scale, &limit);
        if let Some(noise) = noise {
            // The variance of the estimate is that of P times it.
            state.estimator.expect_noise(noise / scale);
        }
        state.beginning = Beginning::new(!self.plan.structure.initial_state());
        state.start_error.end(scale, self.plan.forgets);
        state.forgetting.replace_nominal(nominal);
        if same_filter {
            return Ok(());
        }
        if let (true, Some(std)) = (
            self.plan.structure.initial_state(),
            self.plan.prior.std.last(),
        ) {
            state.estimator.inflate_last(std * std);
        }
        let settling = (settling / sample_time) as u32;
        let design = self.plan.trends.design();
        let fading = self.plan.times.fading(design);
        state.restart_signals(&self.plan, design.warm_up.max(settling).max(fading));
        Ok(())
    }
}

#[cfg(test)]
mod tests;
