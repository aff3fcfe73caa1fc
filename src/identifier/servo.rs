//! The common cases in one statement each: a servo behind the default filter.

use crate::error::{ConfigError, check_positive, check_range};
use crate::estimation::structure::Structure;
use crate::identifier::Identifier;
use crate::identifier::config::{Config, bandwidths};
use crate::identifier::inputs::{DeadZone, Valved};
use crate::trends::filter::settling_time;
use crate::trends::filtered::FilteredTrends;
use crate::trends::{Design, Scheme, TrendOperator};

/// A servo: `b0 / (s (s^2 + a2 s + a1))`, the offset of its valve and its initial position, behind
/// the default filter.
///
/// theta = (a1, a2, b0, constant, initial state), the structure [`Structure::SERVO`]. `D` is the
/// longest delay in samples.
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
/// let mut servo = trendid::Servo::new(0.001, 20.0, 1.0, 50.0)?; // 1 ms, about 20 rad/s, commands of 1, strokes of 50 mm
/// for k in 0..1000 {
///     let u = if k % 300 < 150 { 0.4 } else { -0.4 };
///     let _ = servo.update(u, drive(u));
/// }
/// let found = servo.estimate().physical();
/// assert!((found.gain.unwrap() - 2500.0).abs() < 10.0); // mm/s per unit of u
/// assert!((found.omega0.unwrap() - 20.0).abs() < 0.2 && (found.damping.unwrap() - 0.5).abs() < 0.01);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
pub type Servo<const D: usize = 0> = Identifier<FilteredTrends<3>, 3, 5, 1, D>;

/// As [`Servo`] behind a valve that has a [`DeadZone`].
///
/// theta = (a1, a2, b0, b0 of the sign, constant, initial state).
///
/// # Examples
/// ```
/// # let (mut y, mut v, mut a) = (0.0_f64, 0.0, 0.0);
/// # let mut drive = |u: f32| {
/// #     let now = y as f32;
/// #     let flow = f64::from(u.signum() * (u.abs() - 0.03).max(0.0));
/// #     for _ in 0..10 {
/// #         y += 1e-4 * v;
/// #         v += 1e-4 * a;
/// #         a += 1e-4 * (1e6 * flow - 400.0 * v - 20.0 * a);
/// #     }
/// #     now
/// # };
/// // A width of up to 0.045, below every command; corrected every 300 samples.
/// let valve = trendid::inputs::DeadZone::new(0.0, 0.045, 300);
/// let mut servo = trendid::ValveServo::new(0.001, 20.0, 0.2, 50.0, 0.7, valve)?; // a memory of 0.7 s
/// for k in 0..4000 {
///     let u = [0.2, -0.1, 0.05, -0.15][k / 150 % 4];
///     let _ = servo.update(u, drive(u));
/// }
/// assert!((servo.dead_zone().delta() - 0.03).abs() < 5e-4);
/// let found = servo.estimate();
/// assert!((found.physical().gain.unwrap() - 2500.0).abs() < 25.0);
/// assert!(found.physical_std().unwrap()[0] < 25.0);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
pub type ValveServo<const D: usize = 0> = Valved<FilteredTrends<3>, 3, 6, 2, D>;

/// Trends and configuration of a servo, to be changed where something else is known.
fn servo<const N: usize, const I: usize>(
    sample_time: f32,
    bandwidth: f32,
    input_range: [f32; I],
    output_range: f32,
) -> Result<(Config<3, N, I>, FilteredTrends<3>), ConfigError> {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, sample_time, bandwidth)?;
    let config = Config::new(Structure::SERVO, bandwidth, input_range, output_range);
    Ok((config, trends))
}

impl Servo {
    /// A servo sampled every `sample_time` (s), of rough `bandwidth` (rad/s), with the typical
    /// sizes of u and y.
    ///
    /// # Errors
    /// The value that cannot work, as a [`ConfigError`] that names it.
    pub fn new(
        sample_time: f32,
        bandwidth: f32,
        input_range: f32,
        output_range: f32,
    ) -> Result<Self, ConfigError> {
        Servo::with_delay(sample_time, bandwidth, input_range, output_range, 0)
    }
}

impl<const D: usize> Servo<D> {
    /// As [`Servo::new`] with a command that acts `delay` samples late, at most `D`.
    ///
    /// # Errors
    /// As [`Servo::new`].
    pub fn with_delay(
        sample_time: f32,
        bandwidth: f32,
        input_range: f32,
        output_range: f32,
        delay: usize,
    ) -> Result<Self, ConfigError> {
        let (mut config, trends) = servo(sample_time, bandwidth, [input_range], output_range)?;
        config.delays = [delay];
        Identifier::try_new(&config, trends)
    }
}

impl ValveServo {
    /// As [`Servo::new`], forgetting with `memory` (s), about two blocks of the dead zone.
    ///
    /// # Errors
    /// As [`Servo::new`].
    pub fn new(
        sample_time: f32,
        bandwidth: f32,
        input_range: f32,
        output_range: f32,
        memory: f32,
        dead_zone: DeadZone,
    ) -> Result<Self, ConfigError> {
        let (mut config, trends) = servo(sample_time, bandwidth, [input_range, 1.0], output_range)?;
        config.memory = Some(memory);
        Self::try_new(&config, trends, dead_zone)
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize>
    Identifier<FilteredTrends<M>, M, N, I, D>
{
    /// Goes on with the default filter for a plant of the bandwidth `omega0` (rad/s), as
    /// [`Identifier::retune`]. Times and sizes that follow from the bandwidth of the settings stay
    /// theirs.
    ///
    /// The estimate is held for three time constants of the filter's pair; in a structure without
    /// an initial state for those of the slow pole, as [`Identifier::retune`] says.
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
    /// let mut servo = trendid::Servo::new(0.001, 60.0, 1.0, 50.0)?; // three times too fast
    /// for k in 0..2000 {
    ///     let u = if k % 300 < 150 { 0.4 } else { -0.4 };
    ///     let _ = servo.update(u, drive(u));
    ///     if k == 700 {
    ///         servo.retune_to(servo.estimate().physical().omega0.unwrap())?;
    ///     }
    /// }
    /// assert!((servo.trends().filter()[0] / 1064.8 - 1.0).abs() < 0.1); // the filter for 20 rad/s
    /// assert!((servo.estimate().physical().omega0.unwrap() - 20.0).abs() < 0.2);
    /// # Ok::<(), trendid::ConfigError>(())
    /// ```
    /// # Errors
    /// [`ConfigError::NotPositive`] and [`ConfigError::OutOfRange`] for `omega0`, as the bandwidth
    /// of [`Config`], and [`ConfigError::Unstable`] where the filter is not stable at this sample
    /// time; nothing is changed then.
    pub fn retune_to(&mut self, omega0: f32) -> Result<(), ConfigError> {
        let Design {
            scheme,
            sample_time,
            ..
        } = *self.trends().design();
        check_positive("omega0", omega0)?;
        check_range("omega0", omega0, bandwidths(sample_time))?;
        let trends = FilteredTrends::for_bandwidth(scheme, sample_time, omega0)?;
        self.retune(trends, settling_time(omega0))
    }
}
