//! A structure over signals that can carry it.

use trendid::trends::Scheme;

use crate::dynamic::{INPUTS, PARAMETERS};
use crate::error::{Error, Weakness};
use crate::signals::{Input, Signals};

/// Samples that each parameter needs at least.
const SAMPLES_PER_PARAMETER: usize = 10;

/// Which coefficients a model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Structure {
    /// Order m, 1 to 4, the integrator included.
    pub order: usize,
    /// Whether a_0 is 0.
    pub integrator: bool,
    /// Zeros of the delayed inputs: b_0 .. b_zeros are estimated.
    pub zeros: usize,
    /// Whether there is a constant input.
    pub constant: bool,
}

impl Structure {
    /// Order m alone: without integrator, zeros and constant.
    pub const fn of_order(order: usize) -> Self {
        Self {
            order,
            integrator: false,
            zeros: 0,
            constant: false,
        }
    }
}

/// Options beside the structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Trends of Goodwin (4) or modified Tustin (8).
    pub scheme: Scheme,
    /// Memory \[s\]; none forgets nothing.
    pub memory: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            scheme: Scheme::Tustin,
            memory: None,
        }
    }
}

/// Signals with a structure; what remains open is the filter and the delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Problem<'a> {
    /// The signals.
    pub signals: &'a Signals<'a>,
    /// The structure.
    pub structure: Structure,
    /// Scheme and memory.
    pub options: Options,
}

impl<'a> Problem<'a> {
    /// A structure over signals that can carry it.
    ///
    /// # Errors
    /// The first thing that is wrong with the structure, then with the signals.
    pub fn new(
        signals: &'a Signals<'a>,
        structure: Structure,
        options: Options,
    ) -> Result<Self, Error> {
        let problem = Self {
            signals,
            structure,
            options,
        };
        problem.check_structure()?;
        signals.check()?;
        let shortest = 2.0 * signals.dt;
        match options.memory {
            Some(memory) if !(memory.is_finite() && memory > shortest) => {
                Err(Error::Memory { memory, shortest })
            }
            _ => Ok(problem),
        }
    }

    fn check_structure(&self) -> Result<(), Error> {
        let Structure { order, zeros, .. } = self.structure;
        if !(1..=4).contains(&order) {
            return Err(Error::Order(order));
        }
        if zeros >= order {
            return Err(Error::Zeros { zeros, order });
        }
        let inputs = self.signals.inputs.len();
        if !(1..=INPUTS).contains(&inputs) {
            return Err(Error::Inputs(inputs));
        }
        let parameters = self.parameter_names().len();
        if parameters > PARAMETERS {
            return Err(Error::Parameters(parameters));
        }
        let (found, needed) = (self.samples(), SAMPLES_PER_PARAMETER * parameters);
        if found < needed {
            return Err(Error::TooFewSamples {
                found,
                parameters,
                needed,
            });
        }
        Ok(())
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.signals.output.len()
    }

    /// Number of coefficients b_i of an input.
    pub fn terms(&self, input: &Input) -> usize {
        if input.delayed {
            self.structure.zeros + 1
        } else {
            1
        }
    }

    /// Names of the parameters in the order of theta.
    pub fn parameter_names(&self) -> Vec<String> {
        let first = usize::from(self.structure.integrator);
        let mut names: Vec<String> = (first..self.structure.order)
            .map(|i| format!("a{i}"))
            .collect();
        let several = self.signals.inputs.len() > 1;
        for input in &self.signals.inputs {
            names.extend((0..self.terms(input)).map(|i| match several {
                true => format!("b{i}[{}]", input.name),
                false => format!("b{i}"),
            }));
        }
        if self.structure.constant {
            names.push("constant".into());
        }
        names
    }

    /// The error of a structure that fails on these signals.
    pub fn cannot_carry(&self, weakness: Weakness) -> Error {
        Error::CannotCarry {
            order: self.structure.order,
            parameters: self.parameter_names().len(),
            weakness,
        }
    }

    /// The error of a structure no model of which can be simulated.
    pub(crate) fn cannot_simulate(&self) -> Error {
        let integrator = self.structure.integrator;
        self.cannot_carry(Weakness::NoSimulation { integrator })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trendid::trends::Hold;

    const STRUCTURE: Structure = Structure {
        integrator: true,
        zeros: 1,
        constant: true,
        ..Structure::of_order(2)
    };

    fn signals<'a>(u: &'a [f64], w: &'a [f64], y: &'a [f64]) -> Signals<'a> {
        let input = |name, samples, delayed| Input {
            name,
            samples,
            delayed,
            hold: Hold::Zero,
        };
        Signals {
            dt: 0.1,
            output: y,
            inputs: vec![input("u", u, true), input("w", w, false)],
            standstill: None,
        }
    }

    fn refusal(signals: &Signals, structure: Structure) -> Error {
        Problem::new(signals, structure, Options::default()).expect_err("an error")
    }

    #[test]
    fn zeros_belong_to_the_delayed_inputs() {
        let x: Vec<f64> = (0..60).map(|k| f64::from(k % 7)).collect();
        let signals = signals(&x, &x, &x);
        let problem = Problem::new(&signals, STRUCTURE, Options::default()).expect("a problem");
        let names = ["a1", "b0[u]", "b1[u]", "b0[w]", "constant"];
        assert_eq!(problem.parameter_names(), names);
    }

    #[test]
    fn unusable_signals_are_named_with_sample_and_value() {
        let x: Vec<f64> = (0..60).map(|k| f64::from(k % 7)).collect();
        let mut bad = x.clone();
        bad[7] = f64::INFINITY;
        assert_eq!(
            refusal(&signals(&x, &bad, &x), STRUCTURE).to_string(),
            "sample 7 of `w` is inf, not a finite number"
        );
        assert_eq!(
            refusal(&signals(&x, &x[1..], &x), STRUCTURE).to_string(),
            "`w` has 59 samples, the output 60"
        );
        assert_eq!(
            refusal(&signals(&x, &[2.0; 60], &x), STRUCTURE).to_string(),
            "the input `w` never changes over the 60 samples: nothing excites the plant"
        );
        let mut backwards = signals(&x, &x, &x);
        backwards.dt = -0.1;
        assert_eq!(refusal(&backwards, STRUCTURE), Error::SampleTime(-0.1));
        assert_eq!(
            refusal(&signals(&[], &[], &[]), STRUCTURE),
            Error::TooFewSamples {
                found: 0,
                parameters: 5,
                needed: 50
            }
        );
    }

    #[test]
    fn a_memory_is_longer_than_two_samples() {
        let x: Vec<f64> = (0..60).map(|k| f64::from(k % 7)).collect();
        let signals = signals(&x, &x, &x);
        for memory in [0.2, -1.0, f64::NAN] {
            let options = Options {
                memory: Some(memory),
                ..Options::default()
            };
            let refused = Problem::new(&signals, STRUCTURE, options);
            assert!(matches!(refused, Err(Error::Memory { .. })), "{memory}");
        }
        let (memory, shortest) = (f64::INFINITY, 0.2);
        let said = Error::Memory { memory, shortest }.to_string();
        assert_eq!(
            said,
            "a memory of inf s is no finite time: without one nothing is forgotten"
        );
    }
}
