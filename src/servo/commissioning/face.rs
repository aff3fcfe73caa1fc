//! What the commissioning is given and what it gives.

use crate::servo::model::Model;
use crate::servo::motion::Travel;
use crate::servo::supervision::state::Reason;

/// What the commissioning needs to know.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommissioningDesign {
    pub(crate) sample_time: f32,
    pub(crate) travel: Travel,
    /// Resolution of the sensor in travels.
    pub(crate) resolution: f32,
    /// Largest command.
    pub(crate) amplitude: f32,
    /// Natural frequency in rad/s, if it is known.
    pub(crate) frequency: Option<f32>,
    /// Delay of the valve in s with which the fits begin, among others.
    pub(crate) delay: f32,
    /// Dead volume of a chamber over that of the stroke, if it is known.
    pub(crate) dead_volume: Option<f32>,
    /// Time in s of random levels before the first fit.
    pub(crate) excite_time: f32,
    /// Longest time in s.
    pub(crate) time_limit: f32,
}

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    pub(crate) model: Model,
    /// Delay of the valve in s.
    pub(crate) delay: f32,
    /// Sign of the valve.
    pub(crate) sign: f32,
    /// Standard deviation of the position, in units of y.
    pub(crate) noise: f32,
    /// Dead volume of a chamber over that of the stroke; infinite where the stiffness is the same
    /// everywhere.
    pub(crate) dead_volume: f32,
    /// Share by which it is slower upwards, and faster downwards.
    pub(crate) imbalance: f32,
}

/// What one sample of the commissioning led to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Progress {
    /// This command is next.
    Command(f32),
    /// A model was accepted; this command is next until it is taken.
    Found(Found, f32),
    /// There is none, for this reason.
    Failed(Reason),
}
