//! One pass over a record: products of instruments and regressors, summed block by block.

use trendid::trends::{Form, Hold};

use crate::error::Error;
use crate::instruments::lanes::{Design, Lane, design};
use crate::instruments::later::Later;
use crate::problem::Problem;
use crate::signals::Signals;

/// Blocks of equal length that a record is divided into.
pub(crate) const BLOCKS: usize = 16;

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
    fn begin(&self, samples: usize) -> usize {
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
    fn twice_filtered(&self, input: usize) -> usize {
        match self.outputs() {
            0 => 0,
            q => q + self.terms[input] - 1,
        }
    }

    /// Place of the first twice filtered row of an input.
    pub(super) fn row(&self, input: usize) -> usize {
        (0..input).map(|c| self.twice_filtered(c)).sum()
    }

    /// All twice filtered rows.
    pub(super) fn auxiliary_rows(&self) -> usize {
        self.row(self.terms.len())
    }
}

/// The sums of a pass, in blocks.
///
/// Rows: the twice filtered inputs, then the regressors themselves. Columns: the regressors, then
/// the left-hand side.
pub(crate) struct Sums {
    pub(super) layout: Layout,
    pub(super) design: Box<dyn Design>,
    /// What is subtracted from the output: positions are large against their increments, so their
    /// reference goes before f32. Only an integrator or a constant takes it up.
    pub(super) reference: f64,
    /// Row after row, one matrix for each block.
    pub(super) blocks: Vec<Vec<f64>>,
}

/// The filters of one input.
struct InputLanes {
    samples: Vec<f32>,
    trends: Box<dyn Lane>,
    /// `s^i / A_z`, and `s^j / (A_f A_z)` behind it.
    auxiliary: Option<(Box<dyn Lane>, Box<dyn Lane>)>,
    /// What a later input would make.
    later: Option<Later>,
}

impl InputLanes {
    /// The trends of sample `k` into the regressors of this input.
    fn regressors(&mut self, k: usize, phi: &mut [f64]) {
        let trends = self.trends.input(self.samples[k]);
        phi.copy_from_slice(&trends[..phi.len()]);
    }

    /// The first `rows` of `s^j / (A_f A_z)` of sample `k` into `z`, with f_0 .. f_{m-1} of the
    /// filter; their number, which is 0 without an auxiliary denominator.
    fn twice_filtered(&mut self, k: usize, rows: usize, filter: &[f64], z: &mut [f64]) -> usize {
        let Some((once, twice)) = &mut self.auxiliary else {
            return 0;
        };
        let m = filter.len();
        let once = once.input(self.samples[k]);
        // s^j for j <= m from the chain; above, s^m = A_f - sum f_i s^i.
        let chain = twice.output(once[0] as f32);
        let x = &mut z[..rows];
        for j in 0..rows {
            x[j] = if j <= m {
                chain[j]
            } else {
                let fed = (0..m).map(|i| filter[i] * x[i + j - m]);
                once[j - m] - fed.sum::<f64>()
            };
        }
        rows
    }
}

/// What acts of an input `delay` samples late; before the record it had its first value.
fn delayed(signals: &Signals, samples: &[f64], delay: f64) -> Vec<f32> {
    let whole = delay.floor() as usize;
    let part = delay - delay.floor();
    let at = |k: usize, d: usize| samples[k.saturating_sub(d)];
    (0..samples.len())
        .map(|k| {
            let u = at(k, whole);
            signals.acting(k, u + part * (at(k, whole + 1) - u)) as f32
        })
        .collect()
}

impl Sums {
    /// The sums of a record.
    ///
    /// # Errors
    /// The core's refusal of the filter.
    pub(super) fn of(problem: &Problem, setting: &Setting) -> Result<Self, Error> {
        let signals = problem.signals;
        let layout = Layout {
            later: setting.later.is_some(),
            ..Layout::of(problem)
        };
        let dt = signals.dt;
        let begin = setting.begin(signals.output.len());
        let design = design(dt, &setting.filter, Some(&setting.model))
            .or_else(|_| self::design(dt, &setting.filter, None))?;
        let mut inputs = Vec::new();
        let mut place = 0;
        for (input, terms) in signals.inputs.iter().zip(&layout.terms) {
            let delay = if input.delayed { setting.delay } else { 0.0 };
            let auxiliary = match setting.auxiliary.len() {
                0 => None,
                _ => Some((
                    self::design(dt, &setting.auxiliary, None)?.of_input(input.hold),
                    design.of_output(Form::Position, 0.0),
                )),
            };
            inputs.push(InputLanes {
                samples: delayed(signals, input.samples, delay),
                trends: design.of_input(input.hold),
                auxiliary,
                later: setting.later.as_ref().filter(|_| input.delayed).map(|b| {
                    Later::of((signals, input), delay, &b[place..place + terms], &*design)
                }),
            });
            place += terms;
        }
        let mut sums = Self {
            blocks: vec![
                vec![
                    0.0;
                    (layout.auxiliary_rows() + layout.columns()) * (layout.columns() + 1)
                ];
                BLOCKS
            ],
            reference: match layout.constant || layout.first > 0 {
                true => signals.output[begin],
                false => 0.0,
            },
            layout,
            design,
        };
        sums.run(problem, begin, &mut inputs);
        Ok(sums)
    }

    /// All products from the sample `begin` on.
    fn run(&mut self, problem: &Problem, begin: usize, inputs: &mut [InputLanes]) {
        let layout = self.layout.clone();
        let (m, q, first) = (layout.order, layout.outputs(), layout.first);
        let (columns, auxiliary) = (layout.columns(), layout.auxiliary_rows());
        let samples = problem.signals.output;
        let form = match first {
            0 => Form::Position,
            _ => Form::Increment,
        };
        let reference = self.reference;
        let mut output = self.design.of_output(form, 0.0);
        let mut constant = self.design.of_input(Hold::Zero);
        let mut start = self.design.of_output(Form::Position, 0.0);
        let filter = self.design.filter();
        let mut z = vec![0.0; auxiliary];
        let mut phi = vec![0.0; columns + 1];
        for (k, y) in samples.iter().enumerate().skip(begin) {
            let trends = output.output((y - reference) as f32);
            for i in 0..q {
                phi[i] = -trends[first + i];
            }
            phi[columns] = trends[m];
            let (mut place, mut row) = (q, 0);
            for (input, terms) in inputs.iter_mut().zip(&layout.terms) {
                input.regressors(k, &mut phi[place..place + terms]);
                place += terms;
                row += input.twice_filtered(k, q + terms - 1, &filter, &mut z[row..]);
            }
            if layout.constant {
                let acts = problem.signals.acts(k);
                phi[place] = constant.input(f32::from(u8::from(acts)))[0];
                place += 1;
            }
            if layout.later {
                let later = inputs.iter_mut().filter_map(|input| input.later.as_mut());
                phi[place] = later.map(|later| later.at(k)).sum();
                place += 1;
            }
            let impulse = if k == begin { 1.0 } else { 0.0 };
            let trends = start.output(impulse);
            phi[place..place + m].copy_from_slice(&trends[..m]);
            // What holds a drive at rest, and what stopped it, is in no equation.
            if k == begin || !problem.signals.acts(k) {
                continue;
            }
            let sums = &mut self.blocks[k * BLOCKS / samples.len()];
            let rows = sums.chunks_exact_mut(columns + 1);
            for (row, weight) in rows.zip(z.iter().chain(&phi[..columns])) {
                for (sum, value) in row.iter_mut().zip(&phi) {
                    *sum += weight * value;
                }
            }
        }
    }
}
