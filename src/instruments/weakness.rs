//! Whether an estimate by instruments is too uncertain to have a variance.

use crate::estimation::terms::Parameter;
use crate::math::matrix::Matrix;
use crate::math::polynomial::largest_rate;
use crate::math::{deviation, raised};

/// A standard deviation beyond this share of what it belongs to shows weak instruments: ratios of
/// sums as uncertain as that have no variance to first order.
const WEAK: f32 = 1.0 / 3.0;

/// Whether an a_i of a model of order `M` is not known to a third of its power of the largest rate,
/// or of the first input no b_i to a third; all normalised.
pub(crate) fn is_weak<const M: usize, const N: usize>(
    parameters: &[Parameter; N],
    theta: &[f32; N],
    covariance: &Matrix<N>,
) -> bool {
    let mut a = [0.0; M];
    for (parameter, value) in parameters.iter().zip(theta) {
        if let Parameter::Output { power } = parameter
            && let Some(slot) = a.get_mut(*power)
        {
            *slot = *value;
        }
    }
    let rate = largest_rate(&a);
    let (mut weak, mut acts) = (false, false);
    for j in 0..N {
        let sigma = deviation(covariance[j][j]);
        match parameters[j] {
            Parameter::Output { power } => {
                weak |= !(sigma <= WEAK * raised(rate, M - power.min(M)));
            }
            // Only the first input must act: friction or a ramp may be absent.
            Parameter::Input { input: 0, .. } => acts |= sigma <= WEAK * theta[j].abs(),
            Parameter::Input { .. } | Parameter::Constant | Parameter::InitialState => {}
        }
    }
    weak || !acts
}
