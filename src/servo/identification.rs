//! The identifier of the loop, its inputs, and the candidates that it gives.

use crate::estimation::structure::Structure;
use crate::estimation::terms::Terms;
use crate::identifier::{Config, Identifier};
use crate::servo::control::controller::Controller;
use crate::servo::design::IdentificationDesign;
use crate::servo::design::constants::FRICTION_SIGMA_SQUARED;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::supervision::screening::Candidate;
use crate::trends::Scheme;
use crate::trends::filtered::FilteredTrends;

/// The identifier of the loop: order 3, theta = (a1, a2, b0 of u, b0 of sgn u, b1 of sgn v,
/// constant).
#[doc(alias = "ServoIdentifier")]
pub type LoopIdentifier = Identifier<FilteredTrends<3>, 3, 6, 3>;

/// The third input is sgn v times s: Coulomb friction acts on the acceleration, one integration
/// behind the valve.
const STRUCTURE: Structure<3, 6, 3> = crate::structure!(
    Terms::of(&[1, 2]),
    [Terms::of(&[0]), Terms::of(&[0]), Terms::of(&[1])],
    true
);

/// The trends of an identifier for this axis.
pub(crate) fn trends(
    design: &IdentificationDesign,
    sample_time: f32,
) -> Result<FilteredTrends<3>, Error> {
    let rates = [design.trends_rate; 3];
    Ok(FilteredTrends::try_new(Scheme::Tustin, sample_time, rates)?)
}

/// The settings of an identifier for this axis.
fn settings(design: &IdentificationDesign) -> Config<3, 6, 3> {
    let mut config = Config::new(
        STRUCTURE,
        design.bandwidth,
        [design.input_range, 1.0, 1.0],
        design.output_range,
    );
    config.output_noise = design.output_noise;
    config.memory = Some(design.memory);
    config
}

/// An identifier for this axis.
pub(crate) fn identifier(
    design: &IdentificationDesign,
    sample_time: f32,
) -> Result<LoopIdentifier, Error> {
    let trends = trends(design, sample_time)?;
    Ok(Identifier::try_new(&settings(design), trends)?)
}

/// Other settings for an identifier, which must know its noise and be reset in later samples.
pub(crate) fn replan(
    identifier: &mut LoopIdentifier,
    design: &IdentificationDesign,
    trends: FilteredTrends<3>,
) -> Result<(), Error> {
    Ok(identifier.replan(&settings(design), trends)?)
}

/// What follows from the noise, after other settings. Refuses nothing: the settings state no prior.
pub(crate) fn expect_noise(
    identifier: &mut LoopIdentifier,
    design: &IdentificationDesign,
) -> Result<(), Error> {
    Ok(identifier.expect_noise(&settings(design))?)
}

/// The inputs in control: valve, delay and friction are those of the controller.
pub(crate) fn inputs_of_known(controller: &Controller) -> [f32; 3] {
    [controller.flow_in_force(), 0.0, controller.friction_force()]
}

/// Identifies on from `model` with `share` of a1, a2 and b0 as standard deviation.
///
/// Dead zone, offset and friction stay as they are: they enter by the inputs. In closed loop, on
/// slow motion, six parameters cannot be told apart; three can.
pub(crate) fn reopen(identifier: &mut LoopIdentifier, model: &Model, share: f32) {
    let Model { a1, a2, b0, .. } = *model;
    let theta = [a1, a2, b0, 0.0, -1.0, 0.0];
    let std = [share * a1, share * a2, share * b0, 0.0, 0.0, 0.0];
    // The model was verified, so every number is finite and this cannot be refused.
    let _ = identifier.warm_start(theta, std);
}

/// The present estimate with its relative variances, to first order and as the recursion has them.
///
/// Without the correction for noise bias of [`Identifier::theta`], which costs more than a sample
/// has; the validation compares the model with the axis in any case.
///
/// In control the valve is that of `controller`, and so is the deflection `friction / a1` at which
/// friction holds the axis against its stiffness: with a1 = stiffness/mass and friction =
/// force/mass the mass cancels. What changes a1 in motion is mostly the mass; a friction that
/// stayed as an acceleration would be three times too large under three times the mass, and a loop
/// that stops by friction would hunt. Where the stiffness changes instead, as with the supply,
/// friction is wrong by as much as the stiffness.
pub(crate) fn candidate(identifier: &LoopIdentifier, controller: Option<&Controller>) -> Candidate {
    let found = identifier.recursion();
    let mut theta = found.theta();
    let covariance = found.covariance();
    // Nothing is certain before the noise is known.
    let known = match identifier.noise_std() {
        Some(_) => 1.0,
        None => f32::INFINITY,
    };
    let p = |i: usize, j: usize| known * covariance[i][j];
    let [a1, a2, b0, _, friction, _] = theta;
    if friction * friction < FRICTION_SIGMA_SQUARED * p(4, 4) {
        // A wrong friction would make the observer stick without cause.
        theta[4] = 0.0;
    }
    let mut model = Model::from_parameters(&theta);
    if let Some(controller) = controller {
        let used = controller.model();
        model = Model {
            dead_zone: used.dead_zone,
            offset: used.offset,
            // The model in use was verified: its a1 is above 0.
            friction: used.friction * model.a1 / used.a1,
            ..model
        };
    }
    let variances = [p(0, 0), p(1, 1), p(2, 2)];
    let r11 = variances[0] / (a1 * a1);
    let r22 = variances[1] / (a2 * a2);
    let r12 = p(0, 1) / (a1 * a2);
    let rbb = variances[2] / (b0 * b0);
    let rb1 = p(0, 2) / (a1 * b0);
    Candidate {
        model,
        gain_variance: rbb + r11 - 2.0 * rb1,
        frequency_variance: 0.25 * r11,
        damping_variance: r22 + 0.25 * r11 - r12,
        variances,
    }
}

#[cfg(test)]
mod tests;
