//! The error that no residual shows: of trends in place of derivatives, and of f32.

use crate::estimation::terms::Parameter;
use crate::math::larger;
use crate::math::matrix::Matrix;
use crate::readout::residual_spectrum::natural_frequency;
use crate::readout::source::ReadOut;
use crate::trends::Scheme;

/// Error of trends in place of derivatives, relative to a parameter, in units of
/// `(omega_n Delta)^2`.
///
/// Measured without noise at 1 and 5 ms: 0.17 to 0.24 of every a_i and b_i of servos with damping
/// 0.2 to 1, -0.08 of a lag, 0.1 to 0.22 of an oscillator. All parameters of a model share it to a
/// tenth, so a gain `b_0/a_nu` hardly has it, unless friction turns with the velocity
/// (`ReadOut::common`). Times what the trends leave of it (`Design::discretisation_share`).
pub(super) const DISCRETE: f32 = 0.2;

/// Error of differences in place of derivatives, Goodwin's, relative to a parameter, for each power
/// of s and in units of `omega_n Delta`.
///
/// A pole p is found as `(e^(p Delta) - 1)/Delta`, off by half of p Delta of itself, and a
/// coefficient is a product of up to m of them. Of a lightly damped pair the damping is off by
/// `omega_n Delta/(4 xi)` of itself, which is more.
const FORWARD: f32 = 0.5;

/// Error of a held input that changes within a sample, whose mean over it stands for it, relative
/// to a parameter, in units of `p (1 - p) (omega_n Delta)^2` at the part p of a sample.
///
/// Measured of a lag without noise: 0.73, with exact trends, from omega Delta of 0.05 to 0.5.
const BETWEEN: f32 = 0.8;

/// Error of f32, relative to a parameter.
pub(super) const ARITHMETIC: f32 = 2e-5;

/// Whether trends in place of derivatives bend a parameter: a constant as b_0, with which it
/// stands.
const fn errs_by_the_trends(parameter: Parameter) -> bool {
    !matches!(parameter, Parameter::InitialState)
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// Error relative to a parameter that no residual shows and all parameters share.
    pub(super) fn floor(&self, natural: f32, denominator: &[f32; M], theta: &[f32; N]) -> f32 {
        let angle = natural * self.design.sample_time;
        let zeros = self.structure.zeros(theta);
        let share = self.design.discretisation_share(denominator, zeros);
        // Of what acts on the highest derivative alone, which nothing smooths.
        let acts = |parameter: &Parameter| match *parameter {
            Parameter::Input { power, .. } => power + 1 == M,
            _ => false,
        };
        let between = match self.structure.parameters().iter().any(acts) {
            true => {
                let parts = self.delay_parts.iter().map(|part| part * (1.0 - part));
                BETWEEN * parts.fold(0.0, larger) * angle * angle
            }
            false => 0.0,
        };
        ARITHMETIC
            + between
            + match self.design.scheme {
                Scheme::Goodwin if self.design.is_of_s_plane() => FORWARD * M as f32 * angle,
                _ => DISCRETE * share * angle * angle,
            }
    }

    /// Adds the `floor` of each parameter, the error that no residual shows; everything in the
    /// user's units.
    pub(super) fn add_floor(
        &self,
        floor: &[f32; N],
        covariance: &mut Matrix<N>,
        known: impl Fn(usize) -> bool,
    ) {
        for i in 0..N {
            for j in 0..N {
                if !known(i) && !known(j) {
                    covariance[i][j] += self.common(i == j) * floor[i] * floor[j];
                }
            }
        }
    }

    /// The error of each parameter that no residual shows, in the user's units.
    pub(super) fn floor_of(&self, theta: &[f32; N]) -> [f32; N] {
        let denominator = self.structure.denominator(theta);
        let natural = natural_frequency(&denominator, self.bandwidth);
        self.of_each(self.floor(natural, &denominator, theta), theta)
    }

    /// The error of each parameter by the one that all share, in the user's units.
    pub(super) fn of_each(&self, floor: f32, theta: &[f32; N]) -> [f32; N] {
        let parameters = self.structure.parameters();
        core::array::from_fn(|i| match errs_by_the_trends(parameters[i]) {
            true => floor * theta[i],
            false => 0.0,
        })
    }

    /// Share of the [`DISCRETE`] errors of two parameters that is common to both.
    ///
    /// Every parameter has a tenth of its own. Where friction turns with the velocity nothing is
    /// common: when within the sample it turned is known to about `omega Delta/4`, in a share
    /// `omega Delta/pi` of the samples, an error of the same order that moves the gain, the damping
    /// and the friction each in its own way.
    pub(super) const fn common(&self, same: bool) -> f32 {
        match (same, self.turns) {
            (true, _) => 1.01,
            (false, false) => 1.0,
            (false, true) => 0.0,
        }
    }
}
