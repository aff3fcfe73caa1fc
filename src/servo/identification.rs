//! The identifier of the loop, its inputs, and the candidates that it gives.

pub(crate) mod mean_stiffness;

use crate::estimation::structure::Structure;
use crate::estimation::terms::Terms;
use crate::identifier::{Config, Identifier};
use crate::servo::control::controller::Controller;
use crate::servo::design::IdentificationDesign;
use crate::servo::design::constants::TIED_STD;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::supervision::screening::Candidate;
use crate::trends::Scheme;
use crate::trends::design::Plane;
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
///
/// Read as they are found: what trapezoids bend, 0.2 of `(omega Delta)^2`, is less than the windows
/// of free simulation can tell, and a sample has no time for the way back.
pub(crate) fn trends(
    design: &IdentificationDesign,
    sample_time: f32,
) -> Result<FilteredTrends<3>, Error> {
    let rates = [design.trends_rate; 3];
    let trends = FilteredTrends::try_new(Scheme::Tustin, sample_time, rates)?;
    Ok(trends.with_plane(Plane::S))
}

/// The settings of an identifier for this axis.
fn settings(design: &IdentificationDesign) -> Config<3, 6, 3> {
    let (bandwidth, length) = (design.bandwidth, design.output_range);
    // Friction comes in as an acceleration: that of the range of the output, at the bandwidth.
    let acceleration = length * bandwidth * bandwidth;
    let inputs = [design.input_range, 1.0, acceleration];
    let mut config = Config::new(STRUCTURE, bandwidth, inputs, length);
    config.output_noise = design.output_noise;
    config.memory = Some(design.memory);
    config.supervised = true;
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

/// Identifies on from `model`, at this stiffness over that in the middle, with `share` of a1, a2,
/// b0 and friction as standard deviation.
///
/// Dead zone and offset stay as they are: they enter by the inputs. In closed loop, on slow motion,
/// six parameters cannot be told apart.
pub(crate) fn reopen(identifier: &mut LoopIdentifier, model: &Model, share: f32, stiffness: f32) {
    let Model { a1, a2, b0, .. } = *model;
    let (a1, b0) = (stiffness * a1, stiffness * b0);
    let theta = [a1, a2, b0, 0.0, -1.0, 0.0];
    let std = [share * a1, share * a2, share * b0, 0.0, share, 0.0];
    // The model was verified, so every number is finite and this cannot be refused.
    let _ = identifier.warm_start(theta, std);
}

/// a1, a2, b0 and friction of what belongs to theta.
fn four<T>([a1, a2, b0, _, friction, _]: [T; 6]) -> [T; 4] {
    [a1, a2, b0, friction]
}

/// What the recursion says of a1, a2, b0 and friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Looked {
    theta: [f32; 4],
    covariance: [[f32; 4]; 4],
    /// 1; infinity before the noise is known, without which nothing is certain.
    known: f32,
}

/// The present estimate.
pub(crate) fn look(identifier: &LoopIdentifier) -> Looked {
    let (theta, covariance) = identifier.read_out().recursion_of_trends();
    Looked {
        theta: four(theta),
        covariance: four(covariance).map(four),
        known: match identifier.noise_std() {
            Some(_) => 1.0,
            None => f32::INFINITY,
        },
    }
}

/// An estimate at this stiffness as a model of the middle, with its relative variances, to first
/// order and as the recursion has them; valve and delay are those of the model in use.
///
/// ```text
/// x = a1, a2, b0, friction over those of the model in use,   x2 - x1 ~ N(0, (0.5 x1)^2),   x4 - x1 ~ N(0, (0.35 x1)^2)
/// ```
///
/// What changes a drive in motion is its load, its valve, its supply. A load divides everything by
/// the mass: damping over stiffness, a2/a1, and the deflection at which friction holds the axis,
/// friction/a1, stay. That both are known to a part is two more observations of the estimate. A
/// sine shows two numbers; with them it shows the load and the gain. Where the samples know better
/// they count for next to nothing. Without the correction for noise bias of [`Identifier::theta`],
/// which costs more than a sample has; windows of free simulation compare the model with the axis
/// in any case.
///
/// The friction itself follows a1: a friction that stayed as an acceleration would be three times
/// too large under three times the mass, and a loop that stops by friction would hunt. What the
/// samples say of it, between two reversals, is too little for that.
pub(crate) fn candidate(looked: &Looked, used: &Model, stiffness: f32) -> Candidate {
    let Looked {
        theta: mut x,
        covariance: mut p,
        known,
    } = *looked;
    // The model in use was verified: its numbers are above 0.
    let scales = [stiffness * used.a1, used.a2, stiffness * used.b0, -1.0];
    for ((x, row), scale) in x.iter_mut().zip(&mut p).zip(scales) {
        *x /= scale;
        for (value, other) in row.iter_mut().zip(scales) {
            *value *= known / (scale * other);
        }
    }
    let [damping, friction] = TIED_STD;
    tie::<1>(&mut x, &mut p, damping);
    tie::<3>(&mut x, &mut p, friction);
    let [a1, a2, b0, _] = x;
    let model = Model {
        a1: a1 * used.a1,
        a2: a2 * used.a2,
        b0: b0 * used.b0,
        friction: a1 * used.friction,
        ..*used
    };
    let r11 = p[0][0] / (a1 * a1);
    let r22 = p[1][1] / (a2 * a2);
    let r12 = p[0][1] / (a1 * a2);
    let rbb = p[2][2] / (b0 * b0);
    let rb1 = p[0][2] / (a1 * b0);
    Candidate {
        model,
        gain_variance: rbb + r11 - 2.0 * rb1,
        frequency_variance: 0.25 * r11,
        damping_variance: r22 + 0.25 * r11 - r12,
        variances: [
            p[0][0] * used.a1 * used.a1,
            p[1][1] * used.a2 * used.a2,
            p[2][2] * used.b0 * used.b0,
        ],
    }
}

/// The observation x_K = x_0, with a standard deviation relative to x_0.
fn tie<const K: usize>(x: &mut [f32; 4], p: &mut [[f32; 4]; 4], relative_std: f32) {
    let std = relative_std * x[0];
    let gain = p.map(|row| row[K] - row[0]);
    let variance = gain[K] - gain[0] + std * std;
    if !(variance > 0.0 && variance < f32::INFINITY) {
        return;
    }
    let error = (x[0] - x[K]) / variance;
    for ((x, row), own) in x.iter_mut().zip(p).zip(gain) {
        *x += own * error;
        for (value, other) in row.iter_mut().zip(gain) {
            *value -= own * other / variance;
        }
    }
}

#[cfg(test)]
mod tests;
