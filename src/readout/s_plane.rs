//! From the parameters of the trends to those of the s plane, and back.
//!
//! Trends without a plane of their own ([`Design::to_s_plane`]) leave the estimate as it is.

use crate::estimation::structure::Structure;
use crate::estimation::terms::Parameter;
use crate::math::matrix::Matrix;
use crate::math::polynomial::largest_rate;
use crate::math::pow;
use crate::readout::estimate::Estimate;
use crate::trends::Design;

/// Step of a difference quotient, relative to the power of the largest rate that a coefficient
/// stands for.
const STEP: f32 = 0.01;

/// The plane to go to.
#[derive(Clone, Copy)]
enum To {
    S,
    Trends,
}

/// Theta with its denominator and numerators replaced by those of another plane; where that is one
/// factor away known values are kept.
#[inline(never)]
fn replaced<const M: usize, const N: usize, const I: usize>(
    theta: &[f32; N],
    structure: &Structure<M, N, I>,
    design: &Design<M>,
    known: &[bool; N],
    to: To,
) -> [f32; N] {
    if design.is_of_s_plane() {
        return *theta;
    }
    let columns = structure.parameters();
    let a = structure.denominator(theta);
    let (integrators, zeros) = (structure.integrators(), structure.zeros(theta));
    let image = match to {
        To::S => design.to_s_plane(&a, integrators, zeros),
        To::Trends => design.to_trend_plane(&a, integrators, zeros),
    };
    let mut theta = *theta;
    if let Some(image) = image {
        for ((column, value), known) in columns.iter().zip(&mut theta).zip(known) {
            match *column {
                _ if *known && !design.curves() => {}
                Parameter::Output { power } => *value = image.a.get(power).copied().unwrap_or(0.0),
                Parameter::Input { .. } | Parameter::Constant => *value *= image.numerator,
                Parameter::InitialState => {}
            }
        }
    }
    theta
}

/// Parameters of the trends as parameters of the s plane, in the user's units.
///
/// Where there is none (a pole beyond the sampling) they stay as they are. A term that is not in
/// the structure stays 0; it would be of the size of `(omega Delta)^2`. So would be what `known`
/// values are bent by: they stay what they were told to be.
pub(crate) fn theta_in_s_plane<const M: usize, const N: usize, const I: usize>(
    theta: &[f32; N],
    structure: &Structure<M, N, I>,
    design: &Design<M>,
    known: &[bool; N],
) -> [f32; N] {
    replaced(theta, structure, design, known, To::S)
}

/// The way back from [`theta_in_s_plane`].
pub(crate) fn theta_in_trend_plane<const M: usize, const N: usize, const I: usize>(
    theta: &[f32; N],
    structure: &Structure<M, N, I>,
    design: &Design<M>,
    known: &[bool; N],
) -> [f32; N] {
    replaced(theta, structure, design, known, To::Trends)
}

/// The estimate in the s plane, the covariance through the slope of the map; one factor of all
/// coefficients is within a few percent of 1, and leaves it as it is.
pub(crate) fn estimate_in_s_plane<const M: usize, const N: usize, const I: usize>(
    found: Estimate<M, N, I>,
    design: &Design<M>,
    known: &[bool; N],
) -> Estimate<M, N, I> {
    let structure = found.structure;
    let theta = theta_in_s_plane(&found.theta, &structure, design, known);
    if theta == found.theta {
        return found;
    }
    if !design.curves() {
        return Estimate { theta, ..found };
    }
    let slope = slope(&found.theta, &structure, design);
    let mut covariance = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            for k in 0..N {
                for l in 0..N {
                    covariance[i][j] += slope[i][k] * found.covariance[k][l] * slope[j][l];
                }
            }
        }
    }
    Estimate {
        structure,
        theta,
        covariance,
    }
}

/// Column j: how theta of the s plane follows the parameter j of the trends. Only the denominator
/// is not linear.
fn slope<const M: usize, const N: usize, const I: usize>(
    theta: &[f32; N],
    structure: &Structure<M, N, I>,
    design: &Design<M>,
) -> Matrix<N> {
    let mut slope = [[0.0; N]; N];
    let parameters = structure.parameters();
    let rate = largest_rate(&structure.denominator(theta));
    for (j, parameter) in parameters.into_iter().enumerate() {
        let size = match parameter {
            Parameter::Output { power } => STEP * pow(rate, (M - power) as f32),
            _ => theta[j].abs(),
        };
        let step = if size > 0.0 { size } else { 1.0 };
        let (mut up, mut down) = (*theta, *theta);
        up[j] += step;
        down[j] -= step;
        let (up, down) = (
            theta_in_s_plane(&up, structure, design, &[false; N]),
            theta_in_s_plane(&down, structure, design, &[false; N]),
        );
        for i in 0..N {
            slope[i][j] = (up[i] - down[i]) / (2.0 * step);
        }
    }
    slope
}
