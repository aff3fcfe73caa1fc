//! The tests of a candidate that need no samples, and what is better.

use crate::servo::design::constants::{
    ACCELERATION_MAX, DAMPING_MAX, DAMPING_VARIANCE_RATIO, SIGN_SIGMA_SQUARED, VALVE_MAX,
};
use crate::servo::design::{ScreeningDesign, SupervisionDesign};
use crate::servo::model::Model;
use crate::servo::supervision::state::Reason;

/// No variance is known.
pub(crate) const UNKNOWN: [f32; 3] = [f32::INFINITY; 3];

/// A model with the variances of its parameters, as the identifier gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) model: Model,
    /// Relative variance of the velocity gain b0/a1.
    pub(crate) gain_variance: f32,
    /// Relative variance of the natural frequency.
    pub(crate) frequency_variance: f32,
    /// Relative variance of the damping.
    pub(crate) damping_variance: f32,
    /// Variances of a1, a2 and b0.
    pub(crate) variances: [f32; 3],
}

impl Candidate {
    /// A model without doubt.
    #[cfg(test)]
    pub(crate) const fn known(model: Model) -> Self {
        Self {
            model,
            gain_variance: 0.0,
            frequency_variance: 0.0,
            damping_variance: 0.0,
            variances: UNKNOWN,
        }
    }

    /// Whether the sign of b0 is certain.
    pub(crate) fn has_certain_sign(&self) -> bool {
        let (b0, [.., variance]) = (self.model.b0, self.variances);
        b0 * b0 > SIGN_SIGMA_SQUARED * variance
    }
}

impl ScreeningDesign {
    /// Whether a candidate is certain and may control; w0, C and xi by their squares, no roots.
    pub(crate) fn screen(&self, candidate: &Candidate) -> Result<(), Reason> {
        let model = &candidate.model;
        if model.b0 <= 0.0 && candidate.has_certain_sign() {
            return Err(Reason::WrongSign);
        }
        let limit = self.max_variance_adapting;
        let certain = candidate.gain_variance < limit
            && candidate.frequency_variance < limit
            && candidate.damping_variance < DAMPING_VARIANCE_RATIO * limit;
        if !certain || model.b0 <= 0.0 {
            return Err(Reason::Uncertain);
        }
        self.admits(model)
    }

    /// Whether a model may control: finite, of the right sign, stable and in range.
    pub(crate) fn admits(&self, model: &Model) -> Result<(), Reason> {
        if !model.is_finite() {
            return Err(Reason::NotFinite);
        }
        if model.b0 <= 0.0 {
            return Err(Reason::WrongSign);
        }
        if !(model.a1 > 0.0 && model.a2 > 0.0) {
            return Err(Reason::Unstable);
        }
        let square = self.frequency_squared;
        let frequency =
            model.a1 < self.factor_squared * square && model.a1 * self.factor_squared > square;
        let gain = model.b0 < self.max_gain * model.a1 && model.b0 > self.min_gain * model.a1;
        let damping = model.a2 * model.a2 < DAMPING_MAX * model.a1;
        let valve =
            model.dead_zone >= 0.0 && model.dead_zone < VALVE_MAX && model.offset.abs() < VALVE_MAX;
        let friction = model.friction >= 0.0 && model.friction <= ACCELERATION_MAX;
        if !(frequency && gain && damping && valve && friction) {
            return Err(Reason::OutOfRange);
        }
        Ok(())
    }
}

impl SupervisionDesign {
    /// Whether a sum of squared errors is clearly smaller than another one, of a motion with this
    /// sum of squares.
    pub(crate) fn is_better(&self, sse: f32, other: f32, moved: f32) -> bool {
        sse < self.replace_ratio * other && other - sse > self.min_improvement * moved
    }
}

#[cfg(test)]
mod tests;
