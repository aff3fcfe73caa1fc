//! A loop that is being built for what was found.

use crate::math::sqrt;
use crate::servo::commissioning::Found;
use crate::servo::config::Config;
use crate::servo::design::Design;
use crate::servo::design::constants::{DELAY_MAX, ROUGH_RATIO};
use crate::servo::model::Model;
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

/// The settings with what was found in the place of what was stated.
pub(crate) fn tuned(config: &Config, found: &Found) -> Config {
    let w = ROUGH_RATIO * sqrt(found.model.a1);
    let mut tuned = config.clone();
    tuned.bandwidth = Some(w);
    tuned.delay = found.delay.min(DELAY_MAX as f32 * config.sample_time);
    tuned.controller.dead_volume = Some(found.dead_volume);
    tuned.noise = Some(config.noise_beside(found.noise));
    tuned
}
