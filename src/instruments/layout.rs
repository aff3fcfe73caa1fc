//! Where the instruments of a structure stand.

use crate::estimation::structure::Structure;
use crate::estimation::terms::{Parameter, index_of};

/// Rows of the instruments of a structure: the const parameter `R` of
/// [`Instrumented`](crate::instruments::Instrumented).
///
/// Behind m - nu = q poles, nu integrators aside, each input with the numerators up to b_k gives
/// q + k twice filtered rows; the regressors that are not of y follow.
///
/// # Examples
/// ```
/// use trendid::{Structure, instruments};
/// const R: usize = instruments::rows(&Structure::<3, 5, 1>::SERVO);
/// assert_eq!(R, 5); // u and its derivative twice filtered, the trend of u, the constant, the initial state
/// ```
pub const fn rows<const M: usize, const N: usize, const I: usize>(
    structure: &Structure<M, N, I>,
) -> usize {
    let poles = M - structure.integrators();
    let mut rows = N - structure.output().count();
    let inputs = structure.inputs();
    let mut c = 0;
    while c < I {
        rows += twice_filtered(poles, inputs[c].highest());
        c += 1;
    }
    rows
}

/// Twice filtered rows of an input with the numerators up to `highest`.
const fn twice_filtered(poles: usize, highest: Option<usize>) -> usize {
    match highest {
        Some(highest) if poles > 0 => poles + highest,
        _ => 0,
    }
}

/// Places of the instruments of a structure; without a check of `R`, see [`rows`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout<const M: usize, const N: usize, const I: usize> {
    pub(crate) parameters: [Parameter; N],
    /// nu.
    pub(crate) integrators: usize,
    /// Coefficients of y, the first entries of theta.
    pub(crate) outputs: usize,
    /// Twice filtered rows of each input.
    pub(crate) counts: [usize; I],
    /// All of them: the regressors that are not of y follow.
    pub(crate) twice: usize,
    /// Whether the last parameter is the initial state.
    pub(crate) initial_state: bool,
}

impl<const M: usize, const N: usize, const I: usize> Layout<M, N, I> {
    pub(crate) fn of(structure: &Structure<M, N, I>) -> Self {
        let integrators = structure.integrators();
        let counts = structure
            .inputs()
            .map(|terms| twice_filtered(M - integrators, terms.highest()));
        Self {
            parameters: structure.parameters(),
            integrators,
            outputs: structure.output().count(),
            counts,
            twice: counts.iter().sum(),
            initial_state: structure.initial_state(),
        }
    }

    /// Place of the constant among the parameters.
    pub(crate) fn constant(&self) -> Option<usize> {
        index_of(&self.parameters, Parameter::Constant)
    }

    /// Place of the first twice filtered row of an input.
    fn first_row(&self, input: usize) -> usize {
        self.counts.iter().take(input).sum()
    }

    /// The combination of rows that stands for parameter `index`: calls `add` with row and weight.
    ///
    /// ```text
    /// row of a_i := - sum_c sum_j b_cj (row of x_c,i-nu+j)          the others are rows themselves
    /// ```
    pub(crate) fn combine(&self, index: usize, theta: &[f32; N], mut add: impl FnMut(usize, f32)) {
        let Some(Parameter::Output { power }) = self.parameters.get(index) else {
            add(self.twice + index - self.outputs.min(index), 1.0);
            return;
        };
        for (parameter, value) in self.parameters.iter().zip(theta) {
            if let Parameter::Input { input, power: j } = parameter {
                add(
                    self.first_row(*input) + power - self.integrators + j,
                    -value,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::terms::Terms;

    #[test]
    fn rows_of_structures() {
        assert_eq!(rows(&Structure::<3, 3, 1>::INTEGRATING), 3);
        assert_eq!(rows(&Structure::<3, 6, 2>::SERVO), 8);
        // x_0 .. x_2 and three numerators: s^2 x comes with b_1, s^4 x with b_2.
        assert_eq!(rows(&Structure::<3, 6, 1>::FULL), 5 + 3);
        assert_eq!(rows(&Structure::<1, 2, 1>::FULL), 2);
        // Nothing but integrators: the regressor is its own instrument.
        assert_eq!(rows(&Structure::<1, 1, 1>::INTEGRATING), 1);
        let double =
            Structure::<3, 2, 1>::try_new(Terms::of(&[2]), [Terms::of(&[0])], false).unwrap();
        assert_eq!(rows(&double), 2);
    }

    #[test]
    fn a_coefficient_of_y_is_the_model_of_its_trend() {
        let layout = Layout::of(&Structure::<3, 6, 1>::FULL);
        let theta = [1.0, 2.0, 3.0, 10.0, 20.0, 30.0];
        let of = |index: usize| {
            let mut combined = [0.0; 8];
            layout.combine(index, &theta, |row, weight| combined[row] += weight);
            combined
        };
        assert_eq!(of(1), [0.0, -10.0, -20.0, -30.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(of(4), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        // Behind an integrator s y is what the numerators make of u.
        let servo = Layout::of(&Structure::<3, 3, 1>::INTEGRATING);
        let mut combined = [0.0; 3];
        servo.combine(0, &[400.0, 20.0, 5.0], |row, weight| {
            combined[row] += weight
        });
        assert_eq!(combined, [-5.0, 0.0, 0.0]);
    }
}
