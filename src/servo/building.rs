//! A loop that is being built for what was found.

use crate::math::{larger, smaller, sqrt};
use crate::servo::commissioning::Found;
use crate::servo::config::Config;
use crate::servo::design::Design;
use crate::servo::design::constants::{DELAY_MAX, ROUGH_RATIO};
use crate::servo::model::Model;
use crate::servo::motion::MotionLimits;
use crate::trends::filtered::FilteredTrends;

/// A loop that is being built.
#[derive(Debug, Clone)]
pub(crate) struct Building {
    pub(crate) model: Model,
    pub(crate) design: Design,
    /// What the identifier is built with next.
    pub(crate) trends: Option<FilteredTrends<3>>,
    pub(crate) next: Part,
}

/// The part that comes next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Part {
    Trends,
    Identifier,
    Noise,
    Estimate,
    Controller,
    Supervision,
    Monitors,
}

impl Part {
    /// The one after this.
    pub(crate) const fn following(self) -> Self {
        match self {
            Self::Trends => Self::Identifier,
            Self::Identifier => Self::Noise,
            Self::Noise => Self::Estimate,
            Self::Estimate => Self::Controller,
            Self::Controller => Self::Supervision,
            Self::Supervision | Self::Monitors => Self::Monitors,
        }
    }
}

/// Share of the flow at the largest command that a reference asks for at most, and that it asks for
/// by its velocity.
const FLOW_SHARE: f32 = 0.9;
const VELOCITY_SHARE: f32 = 0.6;
/// Share of the largest command that counts as flow at least, whatever dead zone and offset are.
const FLOW_LEAST: f32 = 0.1;

/// Limits of motion that a drive of this model carries out, as far as they were not stated: a
/// velocity that it does not reach is followed by no controller.
///
/// A reference of the velocity v asks for the flow `v + (a2/a1) v' + v''/a1`. With the limits V, A
/// and a jerk of `w A`, `w^2 = a1`, it is largest at the end of the rise of the acceleration or at
/// the begin of its fall:
///
/// ```text
/// A/(2 w) + (a2 + w) A/a1        V - A/(2 w) + a2 A/a1
/// ```
pub(crate) fn carried_out(config: &Config, limits: MotionLimits, model: &Model) -> MotionLimits {
    if config.motion.is_some() {
        return limits;
    }
    let lost = model.dead_zone + model.offset.abs();
    let command = larger(config.range - lost, FLOW_LEAST * config.range);
    let flow = command * model.b0 / model.a1;
    let w = sqrt(model.a1);
    let rises = FLOW_SHARE * flow * model.a1 / (model.a2 + 1.5 * w);
    let mut acceleration = smaller(limits.acceleration, rises);
    if model.a2 > 0.5 * w {
        let falls = (FLOW_SHARE - VELOCITY_SHARE) * flow * model.a1 / (model.a2 - 0.5 * w);
        acceleration = smaller(acceleration, falls);
    }
    MotionLimits {
        velocity: smaller(limits.velocity, VELOCITY_SHARE * flow),
        acceleration,
        jerk: smaller(limits.jerk, w * acceleration),
    }
}

/// The bandwidth in rad/s that stands for a model in the settings.
pub(crate) fn rough(model: &Model) -> f32 {
    ROUGH_RATIO * sqrt(model.a1)
}

/// The settings with what was found in the place of what was stated.
pub(crate) fn tuned(config: &Config, found: &Found) -> Config {
    let mut tuned = config.clone();
    tuned.bandwidth = Some(rough(&found.model));
    tuned.delay = found.delay.min(DELAY_MAX as f32 * config.sample_time);
    tuned.controller.dead_volume = Some(found.dead_volume);
    tuned.controller.imbalance = found.imbalance;
    tuned.noise = Some(config.noise_beside(found.noise));
    tuned
}
