//! What a pass over a record filters: regressors and twice filtered inputs, sample by sample.

use trendid::trends::{Form, Hold};

use crate::error::Error;
use crate::instruments::lanes::{Design, Lane, design};
use crate::instruments::later::Later;
use crate::instruments::layout::{Layout, Setting};
use crate::instruments::within::Within;
use crate::problem::Problem;
use crate::signals::Signals;

/// The filters of one input.
struct InputLanes {
    samples: Vec<f32>,
    trends: Box<dyn Lane>,
    /// What changes within a sample.
    within: Option<Within>,
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
        if let Some(within) = &mut self.within {
            within.add(k, phi);
        }
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

/// A pass that has not begun.
pub(super) struct Pass {
    pub(super) layout: Layout,
    pub(super) design: Box<dyn Design>,
    /// What is subtracted from the output.
    pub(super) reference: f64,
    /// The first sample whose delayed inputs are in the record.
    begin: usize,
    inputs: Vec<InputLanes>,
}

impl Pass {
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
                within: Within::of((signals, input), delay, &setting.model, &*design),
                auxiliary,
                later: setting.later.as_ref().filter(|_| input.delayed).map(|b| {
                    Later::of((signals, input), delay, &b[place..place + terms], &*design)
                }),
            });
            place += terms;
        }
        Ok(Self {
            reference: match layout.constant || layout.first > 0 {
                true => signals.output[begin],
                false => 0.0,
            },
            layout,
            design,
            begin,
            inputs,
        })
    }

    /// The form of the output in the equations.
    pub(super) fn form(&self) -> Form {
        match self.layout.first {
            0 => Form::Position,
            _ => Form::Increment,
        }
    }

    /// Gives every sample that has an equation with its twice filtered inputs, and its regressors
    /// with the left-hand side behind them.
    pub(super) fn run(&mut self, problem: &Problem, mut each: impl FnMut(usize, &[f64], &[f64])) {
        let layout = &self.layout;
        let (m, q, first) = (layout.order, layout.outputs(), layout.first);
        let (columns, auxiliary) = (layout.columns(), layout.auxiliary_rows());
        let (begin, reference) = (self.begin, self.reference);
        let mut output = self.design.of_output(self.form(), 0.0);
        let mut constant = self.design.of_input(Hold::Zero);
        let mut start = self.design.of_output(Form::Position, 0.0);
        let filter = self.design.filter();
        let inputs = &mut self.inputs;
        let mut z = vec![0.0; auxiliary];
        let mut phi = vec![0.0; columns + 1];
        let samples = problem.signals.output;
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
            each(k, &z, &phi);
        }
    }
}
