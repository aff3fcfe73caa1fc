//! The no_std core run sample by sample over recorded signals.

use trendid::{Hold as CoreHold, Outcome, Scheme, Terms};
use trendid_identify::{InputSetup, Reading, Recursion, Setup};

use crate::freerun::{FreeRun, Hold, Model};
use crate::output::Refusal;
use crate::tuning::{FASTEST, Tuning};

/// Settling of the trends before the first estimate, in time constants of the filter.
const SETTLING: f64 = 6.0;

/// Numerators that differ by less than this from those without a hold are not worth another pass.
const NEGLIGIBLE: f64 = 1e-5;

/// Passes at most until the numerators are those of the estimate.
const PASSES: usize = 8;

/// Movement of a parameter between two passes, in standard deviations, that ends them.
const SETTLED: f64 = 1e-3;

/// An input column with what the model knows about it.
#[derive(Debug, Clone)]
pub struct Input {
    pub name: String,
    pub samples: Vec<f64>,
    /// Number of its b_i: zeros + 1.
    pub terms: usize,
    /// Whether the delay of the plant acts on it.
    pub delayed: bool,
    pub hold: Hold,
}

/// Signals and structure; what remains open is the filter and the delay.
#[derive(Debug, Clone)]
pub struct Problem {
    pub inputs: Vec<Input>,
    pub y: Vec<f64>,
    pub dt: f64,
    pub order: usize,
    pub integrator: bool,
    pub constant: bool,
    pub scheme: Scheme,
    /// Memory in s; none forgets nothing.
    pub memory: Option<f64>,
}

/// The model at one moment of a run.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Parameters in the order a_i, b_i of each input, constant.
    pub theta: Vec<f64>,
    pub sigma: Vec<f64>,
    /// Correlation of the parameters.
    pub correlation: Vec<Vec<f64>>,
    pub a: Vec<f64>,
    pub b: Vec<Vec<f64>>,
    pub constant: f64,
    pub reading: Reading,
    pub physical_std: Option<[f32; 3]>,
}

impl Estimate {
    /// The largest distance of a pole from zero, in rad/s.
    pub fn fastest(&self) -> f64 {
        let poles = self.reading.poles.iter().flatten();
        poles.fold(0.0, |m, (re, im)| m.max(f64::from(re.hypot(*im))))
    }

    /// The largest difference of a parameter from another estimate's, in standard deviations.
    fn distance(&self, other: &Self) -> f64 {
        let moved = self.theta.iter().zip(&other.theta).zip(&self.sigma);
        moved.fold(0.0, |m, ((x, y), sigma)| m.max((x - y).abs() / sigma))
    }
}

/// The indices of (11), summed here in f64: over a long record the first
/// errors would swallow the last ones in f32.
#[derive(Debug, Clone, Copy, Default)]
pub struct Index {
    pub iq: f64,
    pub iv: f64,
    pub samples: usize,
}

/// One pass over the record.
#[derive(Debug, Clone)]
pub struct Run {
    /// The estimate before the second half.
    pub half: Estimate,
    /// The estimate after the last sample.
    pub end: Estimate,
    /// One-step prediction errors: of the held samples where the estimate was
    /// held, else of all that were predicted.
    pub index: Index,
}

/// The course of the parameters over a run.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Sample number, parameters, standard deviations.
    pub rows: Vec<(usize, Vec<f64>, Vec<f64>)>,
}

impl Problem {
    /// Names of the parameters in the order of theta.
    pub fn parameter_names(&self) -> Vec<String> {
        let first = usize::from(self.integrator);
        let mut names: Vec<String> = (first..self.order).map(|i| format!("a{i}")).collect();
        let several = self.inputs.len() > 1;
        for input in &self.inputs {
            for i in 0..input.terms {
                names.push(if several {
                    format!("b{i}[{}]", input.name)
                } else {
                    format!("b{i}")
                });
            }
        }
        if self.constant {
            names.push("constant".into());
        }
        names
    }

    /// Samples that a run needs at least: ten for each parameter.
    pub fn samples_needed(&self) -> usize {
        10 * self.parameter_names().len()
    }

    /// Refuses signals that carry no information whatever the structure.
    ///
    /// # Errors
    ///
    /// The column that never moves.
    pub fn check_excitation(&self) -> Result<(), Refusal> {
        let moves = |x: &[f64]| x.iter().any(|v| *v != x[0]);
        for input in &self.inputs {
            if !moves(&input.samples) {
                return Err(Refusal::new(format!(
                    "the input `{}` never changes over the {} samples: nothing excites the plant",
                    input.name,
                    self.y.len()
                )));
            }
        }
        if !moves(&self.y) {
            return Err(Refusal::new(format!(
                "the output never changes over the {} samples: there is nothing to identify",
                self.y.len()
            )));
        }
        Ok(())
    }

    fn setup(&self, tuning: Tuning, model: Option<&[f64]>) -> Setup {
        let output_range = spread(&self.y) as f32;
        let settling = tuning.slowest().map_or(0.0, |rate| SETTLING / rate);
        Setup {
            order: self.order,
            output: Terms::between(usize::from(self.integrator), self.order),
            inputs: self
                .inputs
                .iter()
                .map(|input| InputSetup {
                    terms: Terms::up_to(input.terms),
                    hold: match input.hold {
                        Hold::Zoh => CoreHold::Zero,
                        Hold::Foh => CoreHold::First,
                    },
                    delay: if input.delayed { tuning.delay } else { 0 },
                    range: spread(&input.samples) as f32,
                    rest: if self.integrator {
                        0.0
                    } else {
                        input.samples[0] as f32
                    },
                })
                .collect(),
            constant: self.constant,
            start: false,
            sample_time: self.dt as f32,
            scheme: self.scheme,
            filter: tuning.filter(self.scheme, self.order, self.dt, model),
            // Raw trends have no filter; their normalisation takes a decade below the sampling rate.
            bandwidth: tuning.fastest().unwrap_or(0.1 / self.dt) as f32,
            output_range,
            output_noise: 1e-4 * output_range,
            memory: self.memory.map(|m| m as f32),
            settling: settling.min(0.2 * self.y.len() as f64 * self.dt) as f32,
            pull: 0.0,
        }
    }

    /// Runs the core over all samples. With a trace, every so-many-th state is
    /// kept in it.
    ///
    /// # Errors
    ///
    /// A configuration that the core refuses.
    pub fn run(
        &self,
        tuning: Tuning,
        mut trace: Option<(&mut Trace, usize)>,
    ) -> Result<Run, Refusal> {
        self.settle(
            tuning,
            |run| &run.end,
            |model| {
                let trace = trace.as_mut().map(|(trace, every)| (&mut **trace, *every));
                self.pass(tuning, model, trace, false)
            },
        )
    }

    /// Estimates with the first half and predicts the second with the
    /// parameters held.
    ///
    /// # Errors
    ///
    /// A configuration that the core refuses.
    pub fn run_held(&self, tuning: Tuning) -> Result<Run, Refusal> {
        self.settle(
            tuning,
            |run| &run.half,
            |model| self.pass(tuning, model, None, true),
        )
    }

    /// Passes until the numerators of the inputs are those of the estimate.
    ///
    /// At fast sampling they are so from the first.
    fn settle(
        &self,
        tuning: Tuning,
        of: impl Fn(&Run) -> &Estimate,
        mut pass: impl FnMut(Option<&[f64]>) -> Result<Run, Refusal>,
    ) -> Result<Run, Refusal> {
        let mut run = pass(None)?;
        for _ in 1..PASSES {
            let now = of(&run);
            let fastest = now.fastest().max(tuning.fastest().unwrap_or(0.0)) * self.dt;
            if !(fastest * fastest / 12.0 > NEGLIGIBLE) || fastest > FASTEST {
                break;
            }
            let a = now.a.clone();
            let next = pass(Some(&a))?;
            let moved = now.distance(of(&next));
            run = next;
            if !(moved > SETTLED) {
                break;
            }
        }
        Ok(run)
    }

    fn pass(
        &self,
        tuning: Tuning,
        model: Option<&[f64]>,
        mut trace: Option<(&mut Trace, usize)>,
        hold: bool,
    ) -> Result<Run, Refusal> {
        if let Some((trace, _)) = &mut trace {
            trace.rows.clear();
        }
        let mut core = self.setup(tuning, model).build()?;
        // Positions are large against their increments: the reference goes before f32 (integrator only).
        let reference = if self.integrator { self.y[0] } else { 0.0 };
        let mut u = vec![0.0_f32; self.inputs.len()];
        let middle = self.y.len() / 2;
        let mut half = None;
        let mut index = Index::default();
        for (k, y) in self.y.iter().enumerate() {
            if k == middle {
                half = Some(self.estimate(core.as_ref()));
                core.adapt(!hold);
            }
            for (u, input) in u.iter_mut().zip(&self.inputs) {
                *u = input.samples[k] as f32;
            }
            let outcome = core.update(&u, (y - reference) as f32);
            if let Outcome::Refused(_) = outcome {
                return Err(Refusal::new(format!(
                    "sample {k} is out of all proportion to the rest of the record"
                )));
            }
            if let Some(error) = outcome.innovation()
                && (k >= middle || !hold)
            {
                let error = f64::from(error);
                index.iq += error * error;
                index.iv += error.abs();
                index.samples += 1;
            }
            if let Some((trace, every)) = &mut trace
                && k % *every == 0
                && matches!(outcome, Outcome::Estimated { .. })
            {
                trace.rows.push((k, wide(&core.theta()), wide(&core.std())));
            }
        }
        let end = self.estimate(core.as_ref());
        Ok(Run {
            half: half.unwrap_or_else(|| end.clone()),
            end,
            index,
        })
    }

    fn estimate(&self, core: &dyn Recursion) -> Estimate {
        let theta = wide(&core.theta());
        let sigma = wide(&core.std());
        let n = theta.len();
        let covariance = core.covariance();
        let relative = |i: usize, j: usize| f64::from(covariance[i][j]) / (sigma[i] * sigma[j]);
        let correlation = (0..n)
            .map(|i| (0..n).map(|j| relative(i, j)).collect())
            .collect();
        Estimate {
            correlation,
            a: wide(&core.a()),
            b: (0..self.inputs.len())
                .map(|c| wide(&core.b(c)[..self.inputs[c].terms]))
                .collect(),
            constant: f64::from(core.constant()),
            reading: core.physical(0),
            physical_std: core.physical_std(),
            theta,
            sigma,
        }
    }

    /// Simulates an estimate on the inputs alone over `range` of the record.
    pub fn free_run(
        &self,
        estimate: &Estimate,
        delay: usize,
        range: std::ops::Range<usize>,
    ) -> Option<FreeRun> {
        let model = Model {
            a: estimate.a.clone(),
            b: estimate.b.clone(),
            delay: self
                .inputs
                .iter()
                .map(|i| if i.delayed { delay } else { 0 })
                .collect(),
            hold: self.inputs.iter().map(|i| i.hold).collect(),
            constant: estimate.constant,
        };
        let u: Vec<&[f64]> = self.inputs.iter().map(|i| i.samples.as_slice()).collect();
        model.free_run(&u, &self.y, range, self.dt)
    }
}

fn wide(x: &[f32]) -> Vec<f64> {
    x.iter().copied().map(f64::from).collect()
}

/// Root mean square about the mean; for signals that move.
pub fn spread(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}
