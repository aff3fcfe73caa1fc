//! Which parameters a model has.

use crate::error::{ConfigError, assert_order};
use crate::estimation::terms::{Parameter, Terms};

/// The structure of a model of order `M` with `N` parameters and `I` inputs.
///
/// Theta holds the parameters in this order, each as it stands in the transfer
/// function: the existing a_i with i ascending, then for each input its b_i with i
/// ascending, then the constant, then the initial state.
///
/// The *initial state* is the error of the position at which the trends begin: the first
/// sample is noisy, and a slow filter would carry its error for seconds. As a
/// parameter (in the unit of y, minus that error) it costs one more column. See Unbehauen
/// and Rao, Automatica 26 (1990), on initial conditions as parameters.
///
/// # Examples
/// The servo drive of the paper, `b0 / (s (s^2 + a2 s + a1))`, theta = (a1, a2, b0):
/// ```
/// use trendid::Structure;
/// let servo = Structure::<3, 3, 1>::INTEGRATING;
/// assert!(!servo.output().contains(0));
/// ```
/// A structure that contradicts its sizes does not compile. A number of parameters that is not `N`:
/// ```compile_fail,E0080
/// use trendid::Structure;
/// let servo = Structure::<3, 4, 1>::SERVO; // a1, a2, b0, constant and initial state are 5
/// ```
/// An order outside 1..=4:
/// ```compile_fail,E0080
/// use trendid::Structure;
/// let none = Structure::<0, 1, 1>::INTEGRATING;
/// ```
/// ```compile_fail,E0080
/// use trendid::Structure;
/// let fifth = Structure::<5, 10, 1>::FULL;
/// ```
/// No input:
/// ```compile_fail,E0080
/// use trendid::Structure;
/// let autonomous = Structure::<3, 3, 0>::FULL;
/// ```
/// The same as a constant:
/// ```compile_fail,E0080
/// use trendid::Structure;
/// const SERVO: Structure<3, 4, 1> = Structure::SERVO;
/// ```
/// Other terms are checked in the same way by [`structure!`](crate::structure), those known at run
/// time only by [`Structure::try_new`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Structure<const M: usize, const N: usize, const I: usize> {
    output: Terms,
    inputs: [Terms; I],
    constant: bool,
    initial_state: bool,
}

impl<const M: usize, const N: usize, const I: usize> Structure<M, N, I> {
    /// Every a_i except a_0, and b_0 of each input: a drive that integrates.
    pub const INTEGRATING: Self = Self::servo(false, false);

    /// As [`Structure::INTEGRATING`], with a constant input for the offset of the valve.
    pub const INTEGRATING_WITH_CONSTANT: Self = Self::servo(true, false);

    /// As [`Structure::INTEGRATING`], with the initial state.
    #[doc(alias = "integrating_with_start")]
    pub const INTEGRATING_WITH_INITIAL_STATE: Self = Self::servo(false, true);

    /// As [`Structure::INTEGRATING`], with a constant and the initial state: the structure to start
    /// with.
    pub const SERVO: Self = Self::servo(true, true);

    /// Every a_i and every b_i.
    pub const FULL: Self = {
        let all = Terms::up_to(M);
        Self::expect_valid(Self::try_new(all, [all; I], false))
    };

    /// Every a_i except a_0, and b_0 of each input.
    const fn servo(constant: bool, initial_state: bool) -> Self {
        let b0 = [Terms::of(&[0]); I];
        Self::expect_valid(Self::assemble(
            Terms::between(1, M),
            b0,
            constant,
            initial_state,
        ))
    }

    const fn expect_valid(structure: Result<Self, ConfigError>) -> Self {
        match structure {
            Ok(structure) => structure,
            Err(_) => panic!("the terms contradict the sizes M, N, I of the structure"),
        }
    }

    /// The structure with these terms of y and of each input, with or without a constant input 1.
    ///
    /// For terms that are known at run time only. An order outside 1..=4 does not compile.
    ///
    /// # Errors
    /// [`ConfigError::Term`], [`ConfigError::NoInput`], [`ConfigError::ParameterCount`].
    pub const fn try_new(
        output: Terms,
        inputs: [Terms; I],
        constant: bool,
    ) -> Result<Self, ConfigError> {
        Self::assemble(output, inputs, constant, false)
    }

    /// As [`Structure::try_new`], with the initial state as one more parameter.
    ///
    /// # Errors
    /// As [`Structure::try_new`].
    #[doc(alias = "try_with_start")]
    pub const fn try_with_initial_state(
        output: Terms,
        inputs: [Terms; I],
        constant: bool,
    ) -> Result<Self, ConfigError> {
        Self::assemble(output, inputs, constant, true)
    }

    const fn assemble(
        output: Terms,
        inputs: [Terms; I],
        constant: bool,
        initial_state: bool,
    ) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        if let Some(power) = output.highest()
            && power >= M
        {
            return Err(ConfigError::Term { power, order: M });
        }
        let mut numerators = 0;
        let mut i = 0;
        while i < I {
            if let Some(power) = inputs[i].highest()
                && power >= M
            {
                return Err(ConfigError::Term { power, order: M });
            }
            numerators += inputs[i].count();
            i += 1;
        }
        if numerators == 0 {
            return Err(ConfigError::NoInput);
        }
        let found = output.count() + numerators + constant as usize + initial_state as usize;
        if found != N {
            return Err(ConfigError::ParameterCount { found, expected: N });
        }
        Ok(Self {
            output,
            inputs,
            constant,
            initial_state,
        })
    }

    /// Which a_i exist.
    pub const fn output(&self) -> Terms {
        self.output
    }

    /// Which b_i of each input exist.
    pub const fn inputs(&self) -> [Terms; I] {
        self.inputs
    }

    /// Whether there is a constant input.
    pub const fn constant(&self) -> bool {
        self.constant
    }

    /// Whether the initial state is a parameter.
    #[doc(alias = "start")]
    pub const fn initial_state(&self) -> bool {
        self.initial_state
    }

    /// a_0 .. a_{m-1} of theta, absent ones 0.
    pub(crate) fn denominator(&self, theta: &[f32; N]) -> [f32; M] {
        let mut a = [0.0; M];
        for (parameter, value) in self.parameters().into_iter().zip(theta) {
            if let Parameter::Output { power } = parameter
                && let Some(slot) = a.get_mut(power)
            {
                *slot = *value;
            }
        }
        a
    }

    /// Number of integrators: how many of a_0, a_1, .. are absent before the first that exists.
    pub const fn integrators(&self) -> usize {
        let mut count = 0;
        while count < M && !self.output.contains(count) {
            count += 1;
        }
        count
    }

    /// Whether theta has a b_i beyond b_0 of an input; one that is known to be 0 is none.
    pub(crate) fn zeros(&self, theta: &[f32; N]) -> bool {
        let beyond = |terms: &Terms| terms.highest() > Some(0);
        self.inputs.iter().any(beyond)
            && (self.parameters().into_iter().zip(theta)).any(|(parameter, value)| {
                matches!(parameter, Parameter::Input { power, .. } if power > 0) && *value != 0.0
            })
    }

    /// The meaning of each entry of theta.
    #[doc(alias = "columns")]
    pub const fn parameters(&self) -> [Parameter; N] {
        let mut parameters = [Parameter::InitialState; N];
        let mut n = 0;
        let mut power = 0;
        while power < M {
            if self.output.contains(power) && n < N {
                parameters[n] = Parameter::Output { power };
                n += 1;
            }
            power += 1;
        }
        let mut input = 0;
        while input < I {
            let mut power = 0;
            while power < M {
                if self.inputs[input].contains(power) && n < N {
                    parameters[n] = Parameter::Input { input, power };
                    n += 1;
                }
                power += 1;
            }
            input += 1;
        }
        if self.constant && n < N {
            parameters[n] = Parameter::Constant;
        }
        parameters
    }
}

/// The [`Structure`] with these terms of y, of each input, and with or without a constant input 1.
///
/// # Examples
/// ```
/// use trendid::estimation::Terms;
/// use trendid::{Structure, structure};
/// let double: Structure<3, 2, 1> = structure!(Terms::of(&[2]), [Terms::of(&[0])], false);
/// assert_eq!(double.integrators(), 2);
/// ```
/// Terms that contradict the sizes do not compile, in a `let` as in a constant. Another number of
/// parameters:
/// ```compile_fail,E0080
/// use trendid::estimation::Terms;
/// use trendid::{Structure, structure};
/// let wrong: Structure<3, 4, 1> = structure!(Terms::of(&[1, 2]), [Terms::of(&[0])], false);
/// ```
/// ```compile_fail,E0080
/// use trendid::estimation::Terms;
/// use trendid::{Structure, structure};
/// const WRONG: Structure<3, 4, 1> = structure!(Terms::of(&[1, 2]), [Terms::of(&[0])], false);
/// ```
/// A power of the order, in y and in an input:
/// ```compile_fail,E0080
/// use trendid::estimation::Terms;
/// use trendid::{Structure, structure};
/// let power: Structure<2, 2, 1> = structure!(Terms::of(&[2]), [Terms::of(&[0])], false);
/// ```
/// ```compile_fail,E0080
/// use trendid::estimation::Terms;
/// use trendid::{Structure, structure};
/// let power: Structure<2, 2, 1> = structure!(Terms::of(&[1]), [Terms::of(&[2])], false);
/// ```
/// Inputs without any term:
/// ```compile_fail,E0080
/// use trendid::estimation::Terms;
/// use trendid::{Structure, structure};
/// let autonomous: Structure<2, 2, 1> = structure!(Terms::up_to(2), [Terms::NONE], false);
/// ```
#[macro_export]
macro_rules! structure {
    ($output:expr, $inputs:expr, $constant:expr) => {
        const {
            match $crate::Structure::try_new($output, $inputs, $constant) {
                Ok(structure) => structure,
                Err(_) => panic!("the terms contradict the sizes M, N, I of the structure"),
            }
        }
    };
}

#[cfg(test)]
mod tests;
