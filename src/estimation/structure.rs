//! Which parameters a model has.

use crate::error::ConfigError;

/// A set of powers of s: which a_i, or which b_i of one input, exist.
///
/// # Examples
/// ```
/// use trendid::Terms;
/// assert_eq!(Terms::up_to(2), Terms::of(&[0, 1]));
/// assert!(Terms::of(&[1, 2]).contains(1) && !Terms::of(&[1, 2]).contains(0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Terms(u8);

impl Terms {
    /// No term at all.
    pub const NONE: Self = Self(0);

    /// The powers listed, each 0..=7; larger ones are refused by [`Structure::try_new`].
    pub const fn of(powers: &[usize]) -> Self {
        let mut bits = 0;
        let mut i = 0;
        while i < powers.len() {
            bits |= 1 << if powers[i] < 8 { powers[i] } else { 7 };
            i += 1;
        }
        Self(bits)
    }

    /// Powers 0 to `count - 1`.
    pub const fn up_to(count: usize) -> Self {
        Self::between(0, count)
    }

    /// Powers `first` to `end - 1`.
    pub const fn between(first: usize, end: usize) -> Self {
        let mut bits = 0;
        let mut i = first;
        while i < end && i < 8 {
            bits |= 1 << i;
            i += 1;
        }
        Self(bits)
    }

    /// Whether the power is in the set.
    pub const fn contains(self, power: usize) -> bool {
        power < 8 && self.0 & (1 << power) != 0
    }

    /// How many powers are in the set.
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    const fn highest(self) -> usize {
        7 - self.0.leading_zeros() as usize
    }
}

/// The structure of a model of order `M` with `N` parameters and `I` inputs.
///
/// Theta holds the parameters in this order, each as it stands in the transfer
/// function: the existing a_i with i ascending, then for each input its b_i with i
/// ascending, then the constant, then the start.
///
/// The *start* is the error of the position that the trends begin with: the first
/// sample is noisy, and a slow filter would carry its error for seconds. As a
/// parameter (in the unit of y, minus that error) it costs one more column.
///
/// # Examples
/// The servo drive of the paper, `b0 / (s (s^2 + a2 s + a1))`, theta = (a1, a2, b0):
/// ```
/// use trendid::Structure;
/// const SERVO: Structure<3, 3, 1> = Structure::integrating();
/// assert!(!SERVO.output().contains(0));
/// ```
/// A structure that contradicts its sizes does not compile as a constant:
/// ```compile_fail
/// use trendid::{Structure, Terms};
/// const WRONG: Structure<3, 4, 1> = Structure::new(Terms::of(&[1, 2]), [Terms::of(&[0])], false);
/// # let _ = WRONG;
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Structure<const M: usize, const N: usize, const I: usize> {
    output: Terms,
    inputs: [Terms; I],
    constant: bool,
    start: bool,
}

impl<const M: usize, const N: usize, const I: usize> Structure<M, N, I> {
    /// The structure with these terms; for constants.
    ///
    /// # Panics
    /// Where [`Structure::try_new`] gives an error; in a constant that is a compile error.
    #[track_caller]
    pub const fn new(output: Terms, inputs: [Terms; I], constant: bool) -> Self {
        Self::sound(Self::try_new(output, inputs, constant))
    }

    #[track_caller]
    const fn sound(structure: Result<Self, ConfigError>) -> Self {
        match structure {
            Ok(structure) => structure,
            Err(_) => panic!("the terms contradict the sizes M, N, I of the structure"),
        }
    }

    /// The structure with these terms of y and of each input, and maybe a constant input 1.
    ///
    /// # Errors
    /// [`ConfigError::Order`], [`ConfigError::Term`], [`ConfigError::NoInput`],
    /// [`ConfigError::ParameterCount`].
    pub const fn try_new(
        output: Terms,
        inputs: [Terms; I],
        constant: bool,
    ) -> Result<Self, ConfigError> {
        Self::assemble(output, inputs, constant, false)
    }

    /// As [`Structure::try_new`], with the start as one more parameter.
    ///
    /// # Errors
    /// As [`Structure::try_new`].
    pub const fn try_with_start(
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
        start: bool,
    ) -> Result<Self, ConfigError> {
        if M == 0 || M > 4 {
            return Err(ConfigError::Order(M));
        }
        let mut found = output.count() + constant as usize + start as usize;
        if output.count() > 0 && output.highest() >= M {
            return Err(ConfigError::Term {
                power: output.highest(),
                order: M,
            });
        }
        let mut numerators = 0;
        let mut i = 0;
        while i < I {
            if inputs[i].count() > 0 && inputs[i].highest() >= M {
                return Err(ConfigError::Term {
                    power: inputs[i].highest(),
                    order: M,
                });
            }
            numerators += inputs[i].count();
            i += 1;
        }
        if numerators == 0 {
            return Err(ConfigError::NoInput);
        }
        found += numerators;
        if found != N {
            return Err(ConfigError::ParameterCount { found, expected: N });
        }
        Ok(Self {
            output,
            inputs,
            constant,
            start,
        })
    }

    /// All a_i but a_0, and b_0 of each input: a drive that integrates.
    pub const fn integrating() -> Self {
        Self::new(Terms::between(1, M), [Terms::of(&[0]); I], false)
    }

    /// As [`Structure::integrating`], with a constant input for the offset of the valve.
    pub const fn integrating_with_constant() -> Self {
        Self::new(Terms::between(1, M), [Terms::of(&[0]); I], true)
    }

    /// As [`Structure::integrating`], with the start.
    pub const fn integrating_with_start() -> Self {
        let b0 = [Terms::of(&[0]); I];
        Self::sound(Self::try_with_start(Terms::between(1, M), b0, false))
    }

    /// As [`Structure::integrating`], with a constant and the start: the structure to take where nothing is known against it.
    pub const fn servo() -> Self {
        let b0 = [Terms::of(&[0]); I];
        Self::sound(Self::try_with_start(Terms::between(1, M), b0, true))
    }

    /// Every a_i and every b_i.
    pub const fn full() -> Self {
        Self::new(Terms::up_to(M), [Terms::up_to(M); I], false)
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

    /// Whether the start is a parameter.
    pub const fn start(&self) -> bool {
        self.start
    }

    /// Number of integrators: how many of a_0, a_1, .. are absent before the first that exists.
    pub const fn integrators(&self) -> usize {
        let mut count = 0;
        while count < M && !self.output.contains(count) {
            count += 1;
        }
        count
    }

    /// What stands at each place of theta.
    pub const fn columns(&self) -> [Column; N] {
        let mut columns = [Column::Start; N];
        let mut n = 0;
        let mut power = 0;
        while power < M {
            if self.output.contains(power) && n < N {
                columns[n] = Column::Output { power };
                n += 1;
            }
            power += 1;
        }
        let mut input = 0;
        while input < I {
            let mut power = 0;
            while power < M {
                if self.inputs[input].contains(power) && n < N {
                    columns[n] = Column::Input { input, power };
                    n += 1;
                }
                power += 1;
            }
            input += 1;
        }
        if self.constant && n < N {
            columns[n] = Column::Constant;
        }
        columns
    }
}

/// What one place of theta means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Column {
    /// The parameter a_power.
    Output {
        /// The power of s.
        power: usize,
    },
    /// The parameter b_power of an input.
    Input {
        /// Which input.
        input: usize,
        /// The power of s.
        power: usize,
    },
    /// The constant: what a constant input 1 contributes.
    Constant,
    /// The start: minus the error of the position the trends began with.
    Start,
}

/// The place of a column in theta.
pub(crate) fn place<const N: usize>(columns: &[Column; N], wanted: Column) -> Option<usize> {
    columns.iter().position(|column| *column == wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn theta_holds_a_then_b_of_each_input_then_constant_then_start() {
        let structure = Structure::<3, 7, 2>::try_with_start(
            Terms::of(&[2, 1]),
            [Terms::of(&[2, 0]), Terms::of(&[1])],
            true,
        )
        .unwrap();
        let input = |input, power| Column::Input { input, power };
        assert_eq!(
            structure.columns(),
            [
                Column::Output { power: 1 },
                Column::Output { power: 2 },
                input(0, 0),
                input(0, 2),
                input(1, 1),
                Column::Constant,
                Column::Start,
            ]
        );
        assert_eq!(structure.integrators(), 1);
    }

    #[test]
    fn integrators_are_the_absent_lowest_terms() {
        let count = |terms| {
            let b = [Terms::of(&[0])];
            match Structure::<3, 2, 1>::try_new(terms, b, false) {
                Ok(structure) => structure.integrators(),
                Err(error) => panic!("{error}"),
            }
        };
        assert_eq!(count(Terms::of(&[0])), 0);
        assert_eq!(count(Terms::of(&[1])), 1);
        assert_eq!(count(Terms::of(&[2])), 2);
        let none = Structure::<2, 1, 1>::new(Terms::NONE, [Terms::of(&[0])], false);
        assert_eq!(none.integrators(), 2);
    }

    #[test]
    fn contradictions_are_named() {
        let one = [Terms::of(&[0])];
        assert_eq!(
            Structure::<0, 1, 1>::try_new(Terms::NONE, one, false),
            Err(ConfigError::Order(0))
        );
        assert_eq!(
            Structure::<5, 1, 1>::try_new(Terms::NONE, one, false),
            Err(ConfigError::Order(5))
        );
        assert_eq!(
            Structure::<2, 2, 1>::try_new(Terms::of(&[2]), one, false),
            Err(ConfigError::Term { power: 2, order: 2 })
        );
        assert_eq!(
            Structure::<2, 2, 1>::try_new(Terms::of(&[0]), [Terms::of(&[3])], false),
            Err(ConfigError::Term { power: 3, order: 2 })
        );
        assert_eq!(
            Structure::<2, 1, 1>::try_new(Terms::of(&[0]), [Terms::NONE], false),
            Err(ConfigError::NoInput)
        );
        assert_eq!(
            Structure::<2, 5, 1>::try_new(Terms::up_to(2), one, true),
            Err(ConfigError::ParameterCount {
                found: 4,
                expected: 5
            })
        );
    }

    #[test]
    fn terms_as_sets() {
        assert_eq!(Terms::between(1, 4), Terms::of(&[3, 1, 2]));
        assert_eq!(Terms::up_to(3).count(), 3);
        assert_eq!(Terms::NONE.count(), 0);
        assert!(!Terms::up_to(3).contains(3) && !Terms::up_to(3).contains(99));
        // Nothing above the seventh power: it is kept as one, and refused by every structure.
        assert!(Terms::of(&[40]).contains(7));
    }
}
