//! Settings of an identifier.

use crate::error::{ConfigError, check_finite, check_not_negative, check_positive, check_range};
use crate::estimation::structure::Structure;
use crate::trends::Hold;

/// Settings of an [`Identifier`](crate::Identifier): what the user knows before the first sample.
///
/// # Examples
/// ```
/// use trendid::{Config, Structure};
/// // A servo: about 20 rad/s, commands around 1, strokes around 50 mm.
/// let mut config = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [1.0], 50.0);
/// config.memory = Some(2.0); // follow changes within seconds
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Config<const M: usize, const N: usize, const I: usize> {
    /// Which parameters the model has.
    pub structure: Structure<M, N, I>,
    /// Rough bandwidth of the plant in rad/s, within a factor of three; scales the regressor.
    pub bandwidth: f32,
    /// Typical size of each input, in its unit.
    pub input_range: [f32; I],
    /// Typical movement of the output, in its unit.
    pub output_range: f32,
    /// Expected standard deviation of the noise of one output sample; weighs the prior, default
    /// `output_range / 1000`.
    pub output_noise: f32,
    /// Course of each input between samples; default held.
    pub holds: [Hold; I],
    /// Delay of each input in samples, at most `D`; default 0.
    pub delays: [usize; I],
    /// Part of a sample by which each input is later than `delays`, 0 to below 1; default 0.
    /// [`Config::set_delay`] sets both.
    pub delay_parts: [f32; I],
    /// Input in equilibrium before the first sample; default 0.
    #[doc(alias = "rest")]
    pub initial_input: [f32; I],
    /// Memory of the estimator in s, from N (N - 1) samples, 3 at least, to 2^20 samples; `None`
    /// forgets nothing (default).
    ///
    /// In motion: while samples bring little information it is up to eight times as long, and while
    /// the drive does not move the estimate is held and nothing forgotten; an innovation of six
    /// standard deviations then makes up for that at once. Where nothing excites a parameter its
    /// covariance stops at a bound and the parameter at its nominal value
    /// ([`Identifier::set_nominal`](crate::Identifier::set_nominal)).
    pub memory: Option<f32>,
    /// With a memory: whether a change of the drive in motion makes the memory short until the new
    /// drive is known; default `false`.
    ///
    /// A change is what lets the innovation, within the bandwidth, grow beyond what noise and
    /// uncertainty explain and beyond a tenth of the motion itself. What was learnt before hardly
    /// counts then, and the estimate is held while the filter carries both drives; so long the
    /// standard deviations are infinite, and behind it they contain what is left of the old drive.
    /// [`Identifier::changes`](crate::Identifier::changes) counts. A drive with friction or a dead
    /// zone that the model leaves out shows itself as a change now and then.
    pub follow_changes: bool,
    /// Which input is the sign of the velocity ([`inputs::coulomb`](crate::inputs::coulomb)), if
    /// one is; default `None`.
    ///
    /// While it is 0 the axis may stick, and no model contains how large the friction is: the
    /// estimate is held, and behind an integrator the trends begin anew at rest when the axis
    /// breaks away. Before that, in models of order 1 and 2, a command up to twice the friction
    /// found counts as one that did not act.
    pub friction_input: Option<usize>,
    /// Estimate at the start, in the order of theta and the user's units; default 0.
    pub initial: [f32; N],
    /// Standard deviation of `initial`, 0 for a known parameter; default `None`: ten times the
    /// design size, and 3 % of the size of the input for the constant of a drive that integrates.
    pub prior_std: Option<[f32; N]>,
    /// Parameters that are known to be their `initial`, whatever their standard deviation would be;
    /// default none.
    ///
    /// Every other number is the same as if they were not in the model, but with a memory, which
    /// takes all parameters in turns.
    pub known: [bool; N],
    /// Time after the first sample, in s, without estimation while the trends settle; default 0,
    /// for a drive at rest at the first sample.
    ///
    /// In motion, with an initial state (`SERVO`): three time constants of the filter's pair,
    /// 4/bandwidth. Without one (`INTEGRATING`, `FULL`, `try_new`) the slow pole carries the motion
    /// before: until that is below the noise, `ln(output_range / output_noise) / (0.11 bandwidth)`.
    pub settling: f32,
    /// Standard deviations below which a constant is insignificant and withdrawn from the reading,
    /// fading out at twice as many; default 2, 0 always keeps it.
    #[doc(alias = "doubt")]
    pub offset_significance: f32,
    /// Whether every model is tested on later samples before it is used, as the loop does: rows
    /// are taken from the first sample on, and a model may be contradicted from its first rows on.
    pub(crate) supervised: bool,
}

impl<const M: usize, const N: usize, const I: usize> Config<M, N, I> {
    /// The defaults for a plant of this structure, bandwidth (rad/s) and size of signals.
    pub const fn new(
        structure: Structure<M, N, I>,
        bandwidth: f32,
        input_range: [f32; I],
        output_range: f32,
    ) -> Self {
        Self {
            structure,
            bandwidth,
            input_range,
            output_range,
            output_noise: output_range * 1e-3,
            holds: [Hold::Zero; I],
            delays: [0; I],
            delay_parts: [0.0; I],
            initial_input: [0.0; I],
            memory: None,
            follow_changes: false,
            friction_input: None,
            initial: [0.0; N],
            prior_std: None,
            known: [false; N],
            settling: 0.0,
            offset_significance: 2.0,
            supervised: false,
        }
    }

    /// Sets the delay of an input in samples, also between two of them; an input that does not
    /// exist is left out.
    ///
    /// Exact for the integral of a held input, and for that of a straight one up to an eighth of
    /// its second difference. A drive on whose highest derivative the input acts, as a lag, is off
    /// by the order of `(omega Delta)^2`, which the standard deviations hold.
    ///
    /// # Examples
    /// ```
    /// use trendid::{Config, Structure};
    /// let mut config = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [1.0], 50.0);
    /// config.set_delay(0, 3.25);
    /// assert_eq!((config.delays, config.delay_parts), ([3], [0.25]));
    /// ```
    pub fn set_delay(&mut self, input: usize, samples: f32) {
        let whole = samples as usize;
        if let (Some(delay), Some(part)) =
            (self.delays.get_mut(input), self.delay_parts.get_mut(input))
        {
            (*delay, *part) = (whole, samples - whole as f32);
        }
    }

    /// The same settings for another structure over the same inputs; `initial`, `prior_std` and
    /// `known`, which belong to the parameters of a structure, are those of [`Config::new`].
    ///
    /// # Examples
    /// ```
    /// use trendid::{Config, Structure};
    /// let mut small = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [1.0], 50.0);
    /// small.memory = Some(2.0);
    /// let large = small.with_structure(Structure::<3, 5, 1>::SERVO);
    /// assert_eq!((large.bandwidth, large.memory), (20.0, Some(2.0)));
    /// ```
    pub const fn with_structure<const P: usize, const Q: usize>(
        &self,
        structure: Structure<P, Q, I>,
    ) -> Config<P, Q, I> {
        let Self {
            structure: _,
            bandwidth,
            input_range,
            output_range,
            output_noise,
            holds,
            delays,
            delay_parts,
            initial_input,
            memory,
            follow_changes,
            friction_input,
            initial: _,
            prior_std: _,
            known: _,
            settling,
            offset_significance,
            supervised,
        } = *self;
        Config {
            output_noise,
            holds,
            delays,
            delay_parts,
            initial_input,
            memory,
            follow_changes,
            friction_input,
            settling,
            offset_significance,
            supervised,
            ..Config::new(structure, bandwidth, input_range, output_range)
        }
    }

    /// Checks every value; `capacity` is the length D of the delay lines.
    pub(crate) fn check(&self, sample_time: f32, capacity: usize) -> Result<(), ConfigError> {
        check_positive("sample_time", sample_time)?;
        check_positive("bandwidth", self.bandwidth)?;
        check_range("bandwidth", self.bandwidth, bandwidths(sample_time))?;
        check_positive("output_range", self.output_range)?;
        check_range("output_range", self.output_range, RANGE)?;
        check_positive("output_noise", self.output_noise)?;
        let noise = NOISE.map(|share| share * self.output_range);
        check_range("output_noise", self.output_noise, noise)?;
        for input in 0..I {
            let range = self.input_range[input];
            check_positive(("input_range", input), range)?;
            check_range(("input_range", input), range, RANGE)?;
            let reach = REACH * range;
            check_range(
                ("initial_input", input),
                self.initial_input[input],
                [-reach, reach],
            )?;
            let part = self.delay_parts[input];
            check_range(("delay_parts", input), part, [0.0, BELOW_ONE])?;
            // Between samples one more of them is remembered.
            let delay = self.delays[input] as f32 + if part > 0.0 { 1.0 } else { 0.0 };
            check_range(("delays", input), delay, [0.0, capacity as f32])?;
        }
        if let Some(memory) = self.memory {
            let limits = [shortest_memory::<N>(), LONGEST];
            check_range("memory", memory, limits.map(|n| n * sample_time))?;
        }
        if let Some(input) = self.friction_input {
            let last = I.saturating_sub(1) as f32;
            check_range("friction_input", input as f32, [0.0, last])?;
        }
        for (index, value) in self.initial.into_iter().enumerate() {
            check_finite(("initial", index), value)?;
        }
        if let Some(std) = self.prior_std {
            check_std(&std)?;
        }
        check_range("settling", self.settling, [0.0, SETTLING * sample_time])?;
        check_not_negative("offset_significance", self.offset_significance)?;
        Ok(())
    }
}

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

/// Bandwidth times sample time: below, f32 has no digits for the trends; above, they do not follow
/// the plant.
const ANGLE: [f32; 2] = [1e-4, 1.0];

/// The bandwidths in rad/s that a sample time allows. The limits themselves are among them, to
/// whichever side they and the sample time were rounded.
pub(crate) fn bandwidths(sample_time: f32) -> [f32; 2] {
    let [low, high] = ANGLE.map(|angle| angle / sample_time);
    [low * (1.0 - f32::EPSILON), high * (1.0 + f32::EPSILON)]
}

/// Typical sizes of signals: within, every scale and its square fit f32.
const RANGE: [f32; 2] = [1e-9, 1e9];

/// Noise over the typical movement: below 10^-7 f32 has none; noise beyond the movement is no
/// measurement.
pub(crate) const NOISE: [f32; 2] = [1e-7, 10.0];

/// Longest memory in samples: of a longer one `1 - lambda` has no digits in f32.
const LONGEST: f32 = 1_048_576.0;

/// Longest time before the first estimate, in samples.
const SETTLING: f32 = 16_777_216.0;

/// Shortest memory in samples: N (N - 1), from which on the bound of the covariance holds, and at
/// least 3.
const fn shortest_memory<const N: usize>() -> f32 {
    let n = N * N.saturating_sub(1);
    if n > 3 { n as f32 } else { 3.0 }
}

/// A prior standard deviation is a finite number >= 0.
pub(crate) fn check_std<const N: usize>(std: &[f32; N]) -> Result<(), ConfigError> {
    for (index, value) in std.iter().copied().enumerate() {
        check_not_negative(("prior_std", index), value)?;
    }
    Ok(())
}

/// A sample this many times its range away from zero is no measurement; it would also let sums
/// overflow.
pub(crate) const REACH: f32 = 1e6;

#[cfg(test)]
mod tests;
