//! An identified model: parameters, their covariance and their meaning.

use crate::estimation::structure::Structure;
use crate::estimation::terms::{Parameter, index_of};
use crate::math::deviation;
use crate::math::matrix::Matrix;
use crate::model::physical::{Physical, second_order_std};
use crate::model::transfer_function::TransferFunction;

/// Parameters and covariance of a model, in the user's units: one reading of an identifier.
///
/// | method | shape | unit |
/// |---|---|---|
/// | [`theta`](Self::theta), [`std`](Self::std) | `N`, in the order of [`Structure`] | a_i: s^(i-m); b_i: y per u per s^(m-i) |
/// | [`covariance`](Self::covariance) | `N` by `N` | products of those |
/// | [`physical_std`](Self::physical_std) | gain, omega0, damping | y (or y/s) per u, rad/s, 1 |
///
/// Guarantees: a standard deviation is never NaN. It is infinite where nothing is known or f32
/// cannot hold the variance, and 0 only for a parameter that was given as known.
///
/// # Examples
/// ```
/// use trendid::{Config, Identifier, Structure};
/// use trendid::estimation::Parameter;
/// use trendid::trends::{FilteredTrends, Scheme};
/// let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0)?;
/// let config = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [1.0], 50.0);
/// let mut identifier: Identifier<_, 3, 3> = Identifier::try_new(&config, trends)?;
/// identifier.warm_start([400.0, 20.0, 1e6], [4.0, 0.2, 1e4])?;
/// let estimate = identifier.estimate();
/// assert_eq!(estimate.physical().omega0, Some(20.0));
/// assert!((estimate.std()[0] - 4.0).abs() < 1e-3);
/// assert_eq!(estimate.parameter(Parameter::Output { power: 2 }), Some(20.0));
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate<const M: usize, const N: usize, const I: usize> {
    pub(crate) structure: Structure<M, N, I>,
    pub(crate) theta: [f32; N],
    pub(crate) covariance: Matrix<N>,
}

impl<const M: usize, const N: usize, const I: usize> Estimate<M, N, I> {
    /// The parameters.
    pub const fn theta(&self) -> [f32; N] {
        self.theta
    }

    /// The parameter with this meaning; `None` where the structure does not have it.
    pub fn parameter(&self, which: Parameter) -> Option<f32> {
        let index = index_of(&self.structure.parameters(), which)?;
        self.theta.get(index).copied()
    }

    /// Standard deviation of each parameter.
    pub fn std(&self) -> [f32; N] {
        core::array::from_fn(|j| deviation(self.covariance[j][j]))
    }

    /// Covariance of the parameters.
    pub const fn covariance(&self) -> [[f32; N]; N] {
        self.covariance
    }

    /// Adds the square of a bias that is not known; where it may be anything the deviation is
    /// infinite.
    pub(crate) fn consider(&mut self, bias: &[f32; N]) {
        for i in 0..N {
            for j in 0..N {
                let square = bias[i] * bias[j];
                if square.is_finite() {
                    self.covariance[i][j] += square;
                } else if i == j {
                    self.covariance[i][i] = f32::INFINITY;
                }
            }
        }
    }

    /// The structure of the model.
    pub const fn structure(&self) -> &Structure<M, N, I> {
        &self.structure
    }

    /// The model that the parameters stand for.
    pub fn transfer_function(&self) -> TransferFunction<M, I> {
        let mut transfer = TransferFunction {
            a: [0.0; M],
            b: [[0.0; M]; I],
            constant: 0.0,
        };
        for (parameter, value) in self.structure.parameters().into_iter().zip(self.theta) {
            let slot = match parameter {
                Parameter::Output { power } => transfer.a.get_mut(power),
                Parameter::Input { input, power } => transfer
                    .b
                    .get_mut(input)
                    .and_then(|input| input.get_mut(power)),
                Parameter::Constant => Some(&mut transfer.constant),
                Parameter::InitialState => None,
            };
            if let Some(slot) = slot {
                *slot = value;
            }
        }
        transfer
    }

    /// The physical reading from the first input to y.
    pub fn physical(&self) -> Physical<M> {
        Physical::of(&self.transfer_function(), 0)
    }

    /// Standard deviations of gain, omega0 and damping of the first input, to first order.
    ///
    /// `None` unless two poles stand behind the integrators, a_nu is positive and b_0 is in the
    /// model.
    pub fn physical_std(&self) -> Option<[f32; 3]> {
        let nu = self.structure.integrators();
        if M != nu + 2 {
            return None;
        }
        let parameters = self.structure.parameters();
        let at = [
            index_of(&parameters, Parameter::Input { input: 0, power: 0 })?,
            index_of(&parameters, Parameter::Output { power: nu })?,
            index_of(&parameters, Parameter::Output { power: nu + 1 })?,
        ];
        let mut values = [0.0; 3];
        let mut covariance = [[0.0; 3]; 3];
        for i in 0..3 {
            values[i] = *self.theta.get(at[i])?;
            for j in 0..3 {
                covariance[i][j] = *self.covariance.get(at[i])?.get(at[j])?;
            }
        }
        second_order_std(values, &covariance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn servo(variance: f32) -> Estimate<3, 3, 1> {
        Estimate {
            structure: Structure::INTEGRATING,
            theta: [400.0, 20.0, 1e6],
            covariance: [[variance, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 1e8]],
        }
    }

    #[test]
    fn what_is_no_variance_is_an_infinite_deviation() {
        for variance in [f32::NAN, -1e-9, f32::INFINITY] {
            let estimate = servo(variance);
            assert_eq!(estimate.std(), [f32::INFINITY, 0.2, 1e4]);
            let [_, omega0, _] = estimate.physical_std().unwrap();
            assert_eq!(omega0, f32::INFINITY);
        }
        assert_eq!(servo(0.0).std()[0], 0.0);
    }

    #[test]
    fn deviations_of_the_physical_reading() {
        // omega0 = sqrt(a1): 16 / (2 20); gain = b0/a1 and damping = a2/(2 omega0) with both their
        // parts.
        let [gain, omega0, damping] = servo(256.0).physical_std().unwrap();
        assert!((omega0 - 0.4).abs() < 1e-6);
        assert!((gain - 103.077_64).abs() < 1e-3, "{gain}");
        assert!((damping - 0.011_180_34).abs() < 1e-7, "{damping}");
    }

    #[test]
    fn parameters_by_their_meaning() {
        let estimate = servo(1.0);
        let b0 = Parameter::Input { input: 0, power: 0 };
        assert_eq!(estimate.parameter(b0), Some(1e6));
        assert_eq!(estimate.parameter(Parameter::Constant), None);
        assert_eq!(estimate.transfer_function().a, [0.0, 400.0, 20.0]);
    }
}
