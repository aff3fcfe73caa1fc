//! Settings of an axis.

use crate::math::smaller;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::motion::{MotionLimits, Travel};

/// Settings of an axis: its data, and overrides of the defaults.
///
/// A setting that is `None` follows from the others when the loop is built, so nothing that follows
/// goes stale.
///
/// # Examples
/// ```
/// use trendid::servo::{Config, Travel};
/// let mut config = Config::new(0.001, 20.0, Travel { min: 0.0, max: 400.0 });
/// config.controller.bandwidth = Some(30.0); // not more, whatever the margins allow
/// assert!(config.resolve().is_ok());
/// config.range = 2.0;
/// let refused = config.resolve().unwrap_err();
/// assert_eq!(refused.to_string(), "range = 2 is not within 0..=1");
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "LoopConfig")]
pub struct Config {
    /// Sample time in s.
    pub sample_time: f32,
    /// Rough bandwidth of the plant in rad/s, if known: the commissioning then searches there
    /// first. Its result replaces it.
    pub bandwidth: Option<f32>,
    /// Travel of the axis.
    pub travel: Travel,
    /// Whether a positive command moves the axis towards smaller positions, if known. A
    /// commissioning must confirm a sign that was stated or found before: otherwise it ends with
    /// [`Reason::WrongSign`](crate::servo::Reason::WrongSign).
    pub reversed: Option<bool>,
    /// Standard deviation of the position noise, in units of y; default the one found by the
    /// commissioning, before it 2.5e-5 of the travel.
    pub noise: Option<f32>,
    /// Largest command, within 0..=1; default 1.
    pub range: f32,
    /// Largest rate of the command per s; default 400.
    pub rate: f32,
    /// Delay of the valve in s, at most 40 samples; default 2 ms, or that. It is rounded to
    /// samples. What the commissioning finds replaces it.
    pub delay: f32,
    /// Memory of the identifier in s; default 1.5.
    pub memory: f32,
    /// Least standard deviation of the fast part of the command with which the model follows the
    /// drive; default 0.1.
    #[doc(alias = "rich")]
    pub min_excitation: f32,
    /// Whether the model follows the drive after the commissioning; default true.
    pub adaptive: bool,
    /// Limits of moves; default 2 travels per s, what the bandwidth allows, and, once a model is
    /// known, what the drive carries out: 0.6 of its speed at full command, dead zone and offset
    /// taken off. Stated ones hold as they are.
    pub motion: Option<MotionLimits>,
    /// Requested dynamics.
    pub controller: ControllerSettings,
    /// The commissioning.
    pub excitation: ExcitationSettings,
    /// Conditions that a model must satisfy.
    pub supervision: SupervisionSettings,
}

/// Requested dynamics of the closed loop. Its bandwidth follows from the verified model, delay,
/// noise and sample time.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "ControllerConfig")]
pub struct ControllerSettings {
    /// Largest bandwidth in rad/s; default none but what the margins allow.
    pub bandwidth: Option<f32>,
    /// Half width of the flow over which the inverse of the dead zone changes sign; default 0.01.
    pub blend: f32,
    /// Least position error within which the valve rests at standstill, in units of y; default one
    /// code and two standard deviations of the noise. Hunting widens it.
    pub rest_window: Option<f32>,
    /// Dead volume of a chamber over that of the stroke: how much stiffer the axis gets towards
    /// its ends, and what a load takes from the flow of the valve. Infinite for a drive that is
    /// as stiff everywhere. Default: what a commissioning finds, until then 0.06, a cylinder. To
    /// be stated with a model that is installed: a stiff drive that is taken for a cylinder is
    /// controlled too fast near its ends, and may swing there.
    pub dead_volume: Option<f32>,
    /// Share by which the axis is slower towards larger y, and faster towards smaller ones, than in
    /// the mean of both, within -0.5..=0.5; default 0. What a commissioning finds replaces it; to
    /// be stated with a model that is installed. A rod that leaves the share r of the area makes
    /// `(1 - sqrt(r)) / (1 + sqrt(r))` with oil and `(1 - r) / (1 + r)` with air, negative where
    /// the axis extends towards larger y.
    pub imbalance: f32,
    /// Time in which the offset of a bumpless change of gains fades, in s; default 10 ms, what a
    /// valve takes.
    pub transition: f32,
}

/// How the axis is moved to identify it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "ExcitationConfig")]
pub struct ExcitationSettings {
    /// Largest command, within 0..=1; default 0.5.
    pub amplitude: f32,
}

/// Bounds that a model must keep.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "SupervisorConfig")]
pub struct SupervisionSettings {
    /// Factor about the rough bandwidth within which the natural frequency must lie; default 4.
    #[doc(alias = "spread")]
    pub frequency_factor: f32,
    /// Largest velocity gain, units of y per s and unit of u; default 50 travels.
    pub max_gain: Option<f32>,
    /// Largest relative standard deviation of gain and natural frequency while the model follows
    /// the drive; damping may have four times as much. The comparison with the model in use
    /// decides; default 0.2.
    pub max_relative_std_adapting: f32,
    /// Least R^2 of a free simulation, `1 - SSE/SST`, while the model follows the drive;
    /// default 0.95.
    pub min_r_squared_adapting: f32,
    /// A model replaces another, and a change of all parameters one of a single number, when its
    /// squared error is below this share of the other's, and
    /// [`min_improvement`](Self::min_improvement) holds; default 0.7.
    #[doc(alias = "better")]
    pub replace_ratio: f32,
    /// Least difference of the two squared errors, as a share of the movement, at which a model
    /// replaces another: there is something to gain; default 0.1.
    #[doc(alias = "worth")]
    pub min_improvement: f32,
    /// Least time of excitation before a model is considered, in s; default 0.3.
    #[doc(alias = "excite")]
    pub excite_time: f32,
    /// Time of a window of free simulation, in s; default half a period of the plant.
    #[doc(alias = "window")]
    pub validation_time: Option<f32>,
    /// Longest commissioning, in s; default 6.
    pub time_limit: f32,
    /// Velocity below which the axis does not count as moving, units of y per s; default 0.05
    /// travels per s.
    pub min_speed: Option<f32>,
    /// Movement below this within the time of excitation is none, units of y; default 2e-3 of the
    /// travel.
    #[doc(alias = "still")]
    pub min_travel: Option<f32>,
    /// Rise of the innovation's variance that counts as a change of the drive; default 5.
    #[doc(alias = "change")]
    pub alarm_ratio: f32,
    /// Tracking error up to which a model in use stays in use, units of y; default 5e-3 of the
    /// travel, in a slow motion what its reference moves within half of 1/bandwidth, but not below
    /// 1e-3 of the travel.
    #[doc(alias = "tolerable")]
    pub error_deadband: Option<f32>,
}

/// Bandwidth before it is known: per sample, because who samples an axis does so some 300 times in
/// a period of it, 2 pi/0.02; and at most in rad/s, because beyond 2 kHz the sample time tells of
/// the computer and not of the axis.
const PROVISIONAL_STEP: f32 = 0.02;
const PROVISIONAL_MOST: f32 = 40.0;

impl Config {
    /// The defaults for a `sample_time` (s) and a plant of a rough `bandwidth` (rad/s) on a
    /// `travel`.
    pub const fn new(sample_time: f32, bandwidth: f32, travel: Travel) -> Self {
        Self {
            bandwidth: Some(bandwidth),
            ..Self::minimal(sample_time, travel)
        }
    }

    /// The bandwidth that was stated, or one that serves until the commissioning has found it.
    pub(crate) fn rough_bandwidth(&self) -> f32 {
        self.bandwidth.unwrap_or(smaller(
            PROVISIONAL_STEP / self.sample_time,
            PROVISIONAL_MOST,
        ))
    }

    /// The defaults for a plant of which nothing is known but `sample_time` (s) and `travel`.
    pub const fn minimal(sample_time: f32, travel: Travel) -> Self {
        Self {
            sample_time,
            bandwidth: None,
            travel,
            reversed: None,
            noise: None,
            range: 1.0,
            rate: 400.0,
            delay: smaller(2e-3, DELAY_MAX as f32 * sample_time),
            memory: 1.5,
            min_excitation: 0.1,
            adaptive: true,
            motion: None,
            controller: ControllerSettings {
                bandwidth: None,
                blend: 0.01,
                rest_window: None,
                dead_volume: None,
                imbalance: 0.0,
                transition: 0.01,
            },
            excitation: ExcitationSettings { amplitude: 0.5 },
            supervision: SupervisionSettings {
                frequency_factor: 4.0,
                max_gain: None,
                max_relative_std_adapting: 0.2,
                min_r_squared_adapting: 0.95,
                replace_ratio: 0.7,
                min_improvement: 0.1,
                excite_time: 0.3,
                validation_time: None,
                time_limit: 6.0,
                min_speed: None,
                min_travel: None,
                alarm_ratio: 5.0,
                error_deadband: None,
            },
        }
    }
}
