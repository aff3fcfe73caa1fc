//! Instruments beside the recursion: estimates without the bias of noise, standard deviations
//! without a noise model.
//!
//! Known as: instrumental variables with a fixed auxiliary denominator (Young, Refined instrumental
//! variable methods, 1981; Garnier and Wang, Identification of Continuous-time Models from Sampled
//! Data, 2008), with a covariance by batch means of the scores (cluster-robust or sandwich
//! covariance).
//!
//! Least squares has the noise of y in its regressors and is biased by it; white noise is taken out
//! at the read-out, drift and colour are not. Instruments are functions of the inputs alone:
//!
//! ```text
//! x_cj = s^j / (A_f A_z) u_c                                   A_z fixed, stable, of order q = m - integrators
//! z    = (x_cj of all inputs ; the regressors that are not of y)                        R rows
//! per row        G += z [phi' psi]                             no auxiliary model runs: nothing can diverge     `sums`
//! at read-out    row of a_i := - sum_c sum_j b_cj (row of x_c,i-integrators+j)           `layout`
//!                theta = (Z'Phi)^-1 Z'psi                      b by least squares first, then repeated      `solve`
//!                V = M^-1 (sum_b s_b s_b') M^-T,  s_b = g_b - G_b theta,  M = sum G_b, corrected for few blocks       `spread`
//! ```
//!
//! The sums stand in a ring of up to 16 blocks of time (`blocks`), so that the scores s_b show how
//! much the estimate would vary, whatever the spectrum of the noise. The equations are linear in
//! the rows of the sums, so a better b counts for all past samples.
//!
//! Everything else, forgetting, held samples, gaps, delay, is the identifier's: only rows that its
//! recursion takes enter the sums, and where it finds a change of the drive
//! ([`Config::follow_changes`]) they begin anew.

mod auxiliary;
mod blocks;
mod found;
mod layout;
mod products;
mod reading;
mod solve;
mod spread;
mod sums;
mod weakness;

pub use found::{Found, Way};
pub use layout::rows;
pub use reading::Reading;

use crate::error::ConfigError;
use crate::identifier::{Config, Identifier, Outcome};
use crate::instruments::auxiliary::{Auxiliary, Lane};
use crate::instruments::blocks::Blocks;
use crate::instruments::layout::Layout;
use crate::instruments::sums::{Group, Instruments, group_of};
use crate::trends::TrendOperator;

/// An [`Identifier`] with instruments beside its recursion.
///
/// | symbol | const parameter | meaning |
/// |---|---|---|
/// | r | `R` | rows of the instruments, [`rows`] of the structure |
///
/// The other parameters are those of [`Identifier`], which runs inside and gives the same numbers
/// as alone.
///
/// Guarantees: as [`Identifier`]. Cost: see the table of instruction counts; 17 R (N + 1) floats of
/// memory. The filter stays as it is: [`Identifier::retune`] is not offered, because instruments
/// through two filters do not add up.
///
/// # Examples
/// ```
/// # let (mut y, mut v, mut a) = (0.0_f64, 0.0, 0.0);
/// # let mut drive = |u: f32| {
/// #     let now = y as f32;
/// #     for _ in 0..10 {
/// #         y += 1e-4 * v;
/// #         v += 1e-4 * a;
/// #         a += 1e-4 * (1e6 * f64::from(u) - 400.0 * v - 20.0 * a);
/// #     }
/// #     now
/// # };
/// use trendid::instruments::{self, Instrumented, Way};
/// use trendid::trends::{FilteredTrends, Scheme};
/// use trendid::{Config, Structure};
///
/// const ROWS: usize = instruments::rows(&Structure::<3, 5, 1>::SERVO);
/// let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0)?;
/// let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [1.0], 50.0);
/// let mut servo: Instrumented<_, 3, 5, 1, ROWS> = Instrumented::try_new(&config, trends)?;
/// for k in 0..2000 {
///     let u = if k % 300 < 150 { 0.4 } else { -0.4 };
///     let _ = servo.update(u, drive(u) + 0.2 * (k as f32).sin());
/// }
/// let found = servo.estimate();
/// assert_eq!(found.way, Way::Instruments);
/// assert!((found.estimate.physical().gain.unwrap() - 2500.0).abs() < 10.0);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Instrumented<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const R: usize,
    const D: usize = 0,
> {
    identifier: Identifier<T, M, N, I, D>,
    instruments: Instruments<M, N, I, R>,
}

impl<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const R: usize,
    const D: usize,
> Instrumented<T, M, N, I, R, D>
{
    /// An identifier at rest with its instruments.
    ///
    /// # Errors
    /// As [`Identifier::try_new`]; [`ConfigError::ParameterCount`] where `R` is not [`rows`] of the
    /// structure, [`ConfigError::Unstable`] for trends without a filter (or with one whose poles
    /// are not found).
    pub fn try_new(config: &Config<M, N, I>, trends: T) -> Result<Self, ConfigError> {
        let found = rows(&config.structure);
        if found != R {
            return Err(ConfigError::ParameterCount { found, expected: R });
        }
        let identifier = Identifier::try_new(config, trends)?;
        let design = identifier.trends().design();
        let group = group_of(config.bandwidth * design.sample_time);
        let auxiliary = design.filter.and_then(|filter| {
            let integrators = config.structure.integrators();
            let time = group as f32 * design.sample_time;
            Auxiliary::new(&filter, integrators, config.bandwidth, time)
        });
        let auxiliary = auxiliary.ok_or(ConfigError::Unstable {
            setting: "filter".into(),
        })?;
        let forgetting = identifier.forgetting();
        let top = design.scale(config.bandwidth);
        Ok(Self {
            instruments: Instruments {
                layout: Layout::of(&config.structure),
                auxiliary,
                lanes: config
                    .input_range
                    .map(|range| Lane::new(range, top, config.bandwidth)),
                z: [0.0; R],
                blocks: Blocks::new(forgetting),
                forgetting,
                turn: 0,
                group: Group::new(group),
            },
            identifier,
        })
    }

    /// As [`Identifier::update_inputs`].
    #[inline]
    pub fn update_inputs(&mut self, u: [f32; I], y: f32) -> Outcome {
        self.identifier.update_seen(u, y, &mut self.instruments)
    }

    /// As [`Identifier::skip`].
    pub fn skip(&mut self, samples: u32) {
        self.identifier.skip_seen(samples, &mut self.instruments);
    }

    /// As [`Identifier::restart_trends`].
    pub fn restart_trends(&mut self) {
        self.identifier.restart_trends();
    }

    /// As [`Identifier::adapt`]; while the estimate is held no sums are taken.
    pub fn adapt(&mut self, on: bool) {
        self.identifier.adapt(on);
    }

    /// As [`Identifier::set_nominal`], with the estimate of the recursion.
    pub fn set_nominal(&mut self) {
        self.identifier.set_nominal();
    }

    /// As [`Identifier::warm_start`]; the sums begin anew, and until they have blocks again the
    /// estimate is that of the recursion.
    ///
    /// # Errors
    /// As [`Identifier::warm_start`].
    pub fn warm_start(&mut self, theta: [f32; N], std: [f32; N]) -> Result<(), ConfigError> {
        self.identifier.warm_start(theta, std)?;
        self.instruments.begin_sums();
        Ok(())
    }

    /// Back to what was constructed.
    pub fn reset(&mut self) {
        self.identifier.reset();
        let instruments = &mut self.instruments;
        for lane in &mut instruments.lanes {
            lane.reset();
        }
        instruments.z = [0.0; R];
        instruments.turn = 0;
        instruments.group.reset();
        instruments.blocks = Blocks::new(instruments.forgetting);
    }

    /// The identifier: least squares, predictions, noise.
    pub const fn identifier(&self) -> &Identifier<T, M, N, I, D> {
        &self.identifier
    }

    /// The model by instruments, or by the recursion, as [`Found::way`] states.
    ///
    /// Cost: see the table of instruction counts; [`Reading`] spreads it over samples.
    pub fn estimate(&self) -> Found<M, N, I> {
        let mut reading = Reading::new();
        loop {
            if let Some(found) = reading.step_of(&self.instruments, &self.identifier) {
                return found;
            }
        }
    }
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const R: usize, const D: usize>
    Instrumented<T, M, N, 1, R, D>
{
    /// Takes u(k), in force from now until the next sample, and y(k).
    #[inline]
    pub fn update(&mut self, u: f32, y: f32) -> Outcome {
        self.update_inputs([u], y)
    }
}

impl<const N: usize, const R: usize> Reading<N, R> {
    /// One step; the estimate with the last one, after which the next reading begins.
    ///
    /// The samples between two steps enter the next reading: the blocks wait up to 16 samples for a
    /// step, then go on, and the reading begins again.
    pub fn step<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize>(
        &mut self,
        of: &mut Instrumented<T, M, N, I, R, D>,
    ) -> Option<Found<M, N, I>> {
        of.instruments.blocks.hold(HELD);
        self.step_of(&of.instruments, &of.identifier)
    }
}

/// Rows for which the blocks are held from one step to the next.
const HELD: u32 = 16;
