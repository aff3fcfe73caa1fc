//! What a pass over a record is set to, and where its regressors and instruments stand.

use crate::problem::Problem;

/// Filter and delay of a pass, all as values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Setting {
    /// f_0 .. f_{m-1} of the filter of the trends, in the s plane.
    pub(super) filter: Vec<f64>,
    /// The denominator whose numerators the inputs get.
    pub(super) model: Vec<f64>,
    /// The auxiliary denominator `A_z` behind the integrators; empty without instruments.
    pub(super) auxiliary: Vec<f64>,
    /// Delay of the delayed inputs in samples.
    pub(super) delay: f64,
    /// Numerators of all inputs in the plane of the trends, where the delay is one more unknown.
    pub(super) later: Option<Vec<f64>>,
}

impl Setting {
    /// The first sample whose delayed inputs are in a record of so many samples; a quarter of the
    /// record at most is given up for them.
    pub(super) fn begin(&self, samples: usize) -> usize {
        let last = match self.later {
            Some(_) => self.delay.floor() as usize + 1,
            None => self.delay.ceil() as usize,
        };
        last.min(samples / 4)
    }
}

/// Places of the regressors and of the instruments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Order m.
    pub(super) order: usize,
    /// 1 behind an integrator, else 0.
    pub(super) first: usize,
    /// Coefficients of each input.
    pub(super) terms: Vec<usize>,
    /// Whether there is a constant.
    pub(super) constant: bool,
    /// Whether the delay is an unknown.
    pub(super) later: bool,
}

impl Layout {
    pub(super) fn of(problem: &Problem) -> Self {
        let inputs = problem.signals.inputs.iter();
        Self {
            order: problem.structure.order,
            first: usize::from(problem.structure.integrator),
            terms: inputs.map(|input| problem.terms(input)).collect(),
            constant: problem.structure.constant,
            later: false,
        }
    }

    /// Coefficients a_i that are estimated: q.
    pub(super) fn outputs(&self) -> usize {
        self.order - self.first
    }

    /// Parameters of the model.
    pub(super) fn parameters(&self) -> usize {
        self.outputs() + self.terms.iter().sum::<usize>() + usize::from(self.constant)
    }

    /// The parameters, and the delay where it is an unknown.
    pub(super) fn unknowns(&self) -> usize {
        self.parameters() + usize::from(self.later)
    }

    /// Columns of the equation: the unknowns, then the m coefficients of the initial state.
    pub(super) fn columns(&self) -> usize {
        self.unknowns() + self.order
    }

    /// Twice filtered rows of an input.
    pub(super) fn twice_filtered(&self, input: usize) -> usize {
        match self.outputs() {
            0 => 0,
            q => q + self.terms[input] - 1,
        }
    }

    /// Place of the first twice filtered row of an input.
    pub(super) fn row(&self, input: usize) -> usize {
        (0..input).map(|c| self.twice_filtered(c)).sum()
    }

    /// The instrument of an a_i: the twice filtered rows `at` combined by numerators.
    pub(super) fn combined(&self, i: usize, numerators: &[f64], at: impl Fn(usize) -> f64) -> f64 {
        let mut sum = 0.0;
        let mut place = 0;
        for (c, terms) in self.terms.iter().enumerate() {
            for j in 0..*terms {
                sum -= numerators[place + j] * at(self.row(c) + i + j);
            }
            place += terms;
        }
        sum
    }

    /// All twice filtered rows.
    pub(super) fn auxiliary_rows(&self) -> usize {
        self.row(self.terms.len())
    }
}
