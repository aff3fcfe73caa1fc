//! Standard deviations of least squares without a noise model.
//!
//! Known as: batch means of the scores; cluster-robust or sandwich covariance over blocks of time
//! (Liang and Zeger, Biometrika 73 (1986)).
//!
//! ```text
//! s_b = sum over the rows of block b of phi (psi - phi' theta)          from the recursion alone     `snapshots`
//! V   = G (sum_b s_b s_b') G' K/(K-3)                                   K blocks     `estimate`
//! G   = (P^-1 - w M)^-1                 change of the estimate per score, with the bias of noise taken out
//! ```
//!
//! The estimate is that of the [`Identifier`], to the last bit: only its standard deviations are
//! others. Those of [`Identifier::estimate`] come from a model of the noise, white and an excess;
//! these from how much the scores of blocks differ, whatever the spectrum of the residual. Of the
//! bias by noise of y that is not white both hold what drift would make; not to have it is what
//! [`instruments`](crate::instruments) are for.

mod estimate;
mod snapshots;

pub use estimate::Batches;

use crate::batches::snapshots::Snapshots;
use crate::error::ConfigError;
use crate::identifier::{Config, Identifier, Outcome};
use crate::trends::TrendOperator;

/// An [`Identifier`] that also keeps what it was at up to 16 times.
///
/// The const parameters are those of [`Identifier`], which runs inside and gives the same numbers
/// as alone.
///
/// Guarantees: as [`Identifier`]. Cost: see the table of instruction counts; 17 (N + 1) (N + 1)
/// floats of memory. The filter stays as it is: [`Identifier::retune`] is not offered, because
/// scores behind two filters do not add up.
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
/// use trendid::batches::Batched;
/// use trendid::trends::{FilteredTrends, Scheme};
/// use trendid::{Config, Structure};
///
/// let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0)?;
/// let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [1.0], 50.0);
/// let mut servo: Batched<_, 3, 5> = Batched::try_new(&config, trends)?;
/// for k in 0..2000 {
///     let u = if k % 300 < 150 { 0.4 } else { -0.4 };
///     let _ = servo.update(u, drive(u) + 0.2 * (k as f32).sin());
/// }
/// let found = servo.estimate();
/// assert!(found.by_blocks && found.effective_blocks <= 17.0);
/// assert_eq!(found.estimate.theta(), servo.identifier().estimate().theta());
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Batched<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize = 1,
    const D: usize = 0,
> {
    identifier: Identifier<T, M, N, I, D>,
    snapshots: Snapshots<N>,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Batched<T, M, N, I, D>
{
    /// An identifier at rest.
    ///
    /// # Errors
    /// As [`Identifier::try_new`].
    pub fn try_new(config: &Config<M, N, I>, trends: T) -> Result<Self, ConfigError> {
        let identifier = Identifier::try_new(config, trends)?;
        Ok(Self {
            snapshots: Snapshots::new(identifier.estimator(), identifier.forgetting()),
            identifier,
        })
    }

    /// As [`Identifier::update_inputs`].
    #[inline]
    pub fn update_inputs(&mut self, u: [f32; I], y: f32) -> Outcome {
        self.identifier.update_seen(u, y, &mut self.snapshots)
    }

    /// As [`Identifier::skip`].
    pub fn skip(&mut self, samples: u32) {
        self.identifier.skip_seen(samples, &mut self.snapshots);
    }

    /// As [`Identifier::restart_trends`].
    pub fn restart_trends(&mut self) {
        self.identifier.restart_trends();
    }

    /// As [`Identifier::adapt`]; while the estimate is held no block goes on.
    pub fn adapt(&mut self, on: bool) {
        self.identifier.adapt(on);
    }

    /// As [`Identifier::set_nominal`].
    pub fn set_nominal(&mut self) {
        self.identifier.set_nominal();
    }

    /// As [`Identifier::warm_start`]; the blocks begin anew.
    ///
    /// # Errors
    /// As [`Identifier::warm_start`].
    pub fn warm_start(&mut self, theta: [f32; N], std: [f32; N]) -> Result<(), ConfigError> {
        self.identifier.warm_start(theta, std)?;
        self.begin();
        Ok(())
    }

    /// Back to what was constructed.
    pub fn reset(&mut self) {
        self.identifier.reset();
        self.begin();
    }

    fn begin(&mut self) {
        self.snapshots = Snapshots::new(self.identifier.estimator(), self.identifier.forgetting());
    }

    /// The identifier: the same estimate, predictions, noise.
    pub const fn identifier(&self) -> &Identifier<T, M, N, I, D> {
        &self.identifier
    }
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const D: usize> Batched<T, M, N, 1, D> {
    /// Takes u(k), in force from now until the next sample, and y(k).
    #[inline]
    pub fn update(&mut self, u: f32, y: f32) -> Outcome {
        self.update_inputs([u], y)
    }
}
