//! An identifier behind a valve whose dead zone it measures.

use crate::error::ConfigError;
use crate::identifier::inputs::dead_zone::DeadZone;
use crate::identifier::inputs::width_error::WidthError;
use crate::identifier::{Config, Identifier, Outcome};
use crate::readout::Estimate;
use crate::trends::{FilteredTrends, TrendOperator};

/// An [`Identifier`] behind a valve with a dead zone, whose first two inputs are those of a
/// [`DeadZone`]: the command and its sign.
///
/// The const parameters are those of [`Identifier`].
///
/// # The width that is not known
/// The inputs are made with a width w that is too small rather than too large. A command between w
/// and the true width delta enters the rows as a flow, and none passes the valve:
///
/// ```text
/// e(u; delta) = sgn(u) (delta - |u|)     w < |u| < delta, else 0
/// psi         = phi' theta + b_0 F e     F: the filter of the trends
/// bias        = b_0 Q r,  r = sum phi F e                      Q: change of the estimate per score
/// ```
///
/// At no sample is e larger than for the largest width that is possible. So r is kept for that one,
/// forgotten as the rows are, and every standard deviation of [`Valved::estimate`] contains b_0 Q r
/// beside what the noise makes. b_0 itself is off by rho = |(Q r)_b0| of itself at most,
///
/// ```text
/// |b_0| <= |b_0 found| / (1 - rho)
/// ```
///
/// and from rho = 1 on no deviation is finite: all commands may have been inside the dead zone.
/// Once per block the largest width becomes the one found, and its bias, and two deviations by
/// noise.
///
/// Guarantees: as [`Identifier`]; the sample that ends a block is a reading besides, with roots and
/// powers. Cost: see the table of instruction counts.
///
/// # Limits
/// [`Identifier::estimate`] of [`Valved::identifier`] has the deviations by noise alone. A width in
/// the inputs that is too large all the same is not counted, but for its two deviations. The rows
/// are not asked which widths they exclude: while every command lies below the `largest` width of
/// the [`DeadZone`] no deviation is finite, however well they fit. Give one below the smallest
/// command that surely moves the drive. An offset that acts before the dead zone makes it another
/// one in each direction, which these inputs do not describe. After [`Valved::retune`] the bias is
/// counted with the inflation of the variance.
///
/// # Examples
/// See [`ValveServo`](crate::ValveServo).
#[derive(Debug, Clone, PartialEq)]
pub struct Valved<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize = 2,
    const D: usize = 0,
> {
    identifier: Identifier<T, M, N, I, D>,
    dead_zone: DeadZone,
    /// The dead zone as constructed.
    unknown: DeadZone,
    error: WidthError<T::Memory, N>,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Valved<T, M, N, I, D>
{
    /// An identifier at rest, and what is known of the dead zone.
    ///
    /// The identifier needs a memory of about two blocks of the dead zone.
    ///
    /// # Errors
    /// As [`Identifier::try_new`].
    pub fn try_new(
        config: &Config<M, N, I>,
        trends: T,
        dead_zone: DeadZone,
    ) -> Result<Self, ConfigError> {
        const { assert!(I >= 2, "the command and its sign are two inputs") }
        let identifier = Identifier::try_new(config, trends)?;
        Ok(Self {
            error: WidthError::new(dead_zone.upper(), identifier.read_out().scale_of_b0()),
            identifier,
            dead_zone,
            unknown: dead_zone,
        })
    }

    /// Begins anew with other settings, as [`Identifier::reconfigure`].
    ///
    /// # Errors
    /// As of [`Valved::try_new`]; nothing is changed then.
    pub fn reconfigure(
        &mut self,
        config: &Config<M, N, I>,
        trends: T,
        dead_zone: DeadZone,
    ) -> Result<(), ConfigError> {
        self.identifier.reconfigure(config, trends)?;
        self.unknown = dead_zone;
        self.begin();
        Ok(())
    }

    /// Takes u(k), in force from now until the next sample, the inputs beside it and y(k).
    ///
    /// The first two of `inputs` are made from `u`, whatever they are.
    #[inline]
    pub fn update_inputs(&mut self, u: f32, mut inputs: [f32; I], y: f32) -> Outcome {
        let made = match u.is_finite() {
            true => self.dead_zone.inputs(u),
            // Refused below.
            false => [u; 2],
        };
        for (place, value) in inputs.iter_mut().zip(made) {
            *place = value;
        }
        let Identifier { plan, state } = &mut self.identifier;
        let mut seen = self.error.seen(plan);
        let outcome = state.update(plan, inputs, y, &mut seen);
        if self.dead_zone.count_sample() {
            self.measure();
        }
        outcome
    }

    /// As [`Identifier::skip`].
    pub fn skip(&mut self, samples: u32) {
        let Identifier { plan, state } = &mut self.identifier;
        let mut seen = self.error.seen(plan);
        state.skip_all(plan, samples, &mut seen);
    }

    /// The end of a block.
    #[inline(never)]
    fn measure(&mut self) {
        let (noise, bias) = (self.identifier.estimate(), self.bias());
        self.dead_zone.take(&noise, &bias);
        self.error.set_width(self.dead_zone.upper());
    }

    /// What the largest width that is possible would do to each parameter.
    fn bias(&self) -> [f32; N] {
        let read_out = self.identifier.read_out();
        read_out.bias_by_input(self.error.scores())
    }

    /// The model found, with its uncertainty, that of the width included.
    pub fn estimate(&self) -> Estimate<M, N, I> {
        let mut estimate = self.identifier.estimate();
        estimate.consider(&self.bias());
        estimate
    }

    /// As [`Identifier::restart_trends`].
    pub fn restart_trends(&mut self) {
        self.identifier.restart_trends();
    }

    /// As [`Identifier::adapt`].
    pub fn adapt(&mut self, on: bool) {
        self.identifier.adapt(on);
    }

    /// As [`Identifier::set_nominal`].
    pub fn set_nominal(&mut self) {
        self.identifier.set_nominal();
    }

    /// As [`Identifier::warm_start`]; of the width is known what was.
    ///
    /// # Errors
    /// As [`Identifier::warm_start`].
    pub fn warm_start(&mut self, theta: [f32; N], std: [f32; N]) -> Result<(), ConfigError> {
        self.identifier.warm_start(theta, std)?;
        self.forget_rows();
        Ok(())
    }

    /// As [`Identifier::retune`].
    ///
    /// # Errors
    /// As [`Identifier::retune`].
    pub fn retune(&mut self, trends: T, settling: f32) -> Result<(), ConfigError> {
        self.identifier.retune(trends, settling)
    }

    /// Back to what was constructed.
    pub fn reset(&mut self) {
        self.identifier.reset();
        self.begin();
    }

    fn begin(&mut self) {
        self.dead_zone = self.unknown;
        self.forget_rows();
    }

    /// Of the width is known what was, of the rows nothing.
    fn forget_rows(&mut self) {
        self.error = WidthError::new(
            self.dead_zone.upper(),
            self.identifier.read_out().scale_of_b0(),
        );
    }

    /// The dead zone as it is known now.
    pub const fn dead_zone(&self) -> &DeadZone {
        &self.dead_zone
    }

    /// The identifier: the same parameters, predictions, noise.
    pub const fn identifier(&self) -> &Identifier<T, M, N, I, D> {
        &self.identifier
    }
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const D: usize> Valved<T, M, N, 2, D> {
    /// Takes u(k), in force from now until the next sample, and y(k).
    #[inline]
    pub fn update(&mut self, u: f32, y: f32) -> Outcome {
        self.update_inputs(u, [u; 2], y)
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize>
    Valved<FilteredTrends<M>, M, N, I, D>
{
    /// As [`Identifier::retune_to`].
    ///
    /// # Errors
    /// As [`Identifier::retune_to`].
    pub fn retune_to(&mut self, omega0: f32) -> Result<(), ConfigError> {
        self.identifier.retune_to(omega0)
    }
}

#[cfg(test)]
mod tests;
