//! The core sample by sample, with sizes that are known only at run time.

use numpy::ndarray::{Array1, Array2, ArrayView1, ArrayView2};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trendid::estimation::Terms;
use trendid::trends::{FilteredTrends, Hold};
use trendid::{ConfigError, Outcome};
use trendid_identify::dynamic::{DELAY, Filter, INPUTS, Setup, settings};

use crate::record::estimate;
use crate::refusal::{refused, unknown};
use crate::signals::scheme;

/// What a user knows of a drive.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Question {
    sample_time: f64,
    order: usize,
    integrator: bool,
    zeros: usize,
    constant: bool,
    initial_state: bool,
    /// Ranges of the inputs, one each.
    input_ranges: Vec<f32>,
    output_range: f32,
    bandwidth: f32,
    /// f_0 .. f_{m-1}; without, those for the bandwidth.
    filter: Option<Vec<f32>>,
    raw: bool,
    delay: usize,
    memory: Option<f32>,
    output_noise: Option<f32>,
    scheme: String,
    hold: String,
    reference: f64,
}

/// Outcomes as numbers: `WarmingUp`, `Refused`, `Held`, `Estimated`, `Replaced`.
const OUTCOMES: [&str; 5] = ["warming up", "refused", "held", "estimated", "replaced"];

/// The core with what turns positions into its numbers.
#[pyclass(module = "trendid._trendid")]
pub(crate) struct Recursion {
    core: Box<dyn trendid_identify::dynamic::Recursion>,
    setup: Setup,
    inputs: usize,
    parameters: usize,
    reference: f64,
}

/// The polynomial of the default filter.
fn default_filter(setup: &Setup, bandwidth: f32) -> Result<Vec<f32>, ConfigError> {
    macro_rules! of_order {
        ($($m:literal)+) => {
            match setup.order {
                $($m => Ok(FilteredTrends::<$m>::for_bandwidth(setup.scheme, setup.sample_time, bandwidth)?
                    .filter()
                    .to_vec()),)+
                order => Err(ConfigError::OutOfRange {
                    setting: "order".into(),
                    value: order as f32,
                    limits: [1.0, 4.0],
                }),
            }
        };
    }
    of_order!(1 2 3 4)
}

impl Question {
    fn setup(&self) -> PyResult<Setup> {
        let inputs = self.input_ranges.len();
        if !(1..=INPUTS).contains(&inputs) {
            return Err(refused(trendid_identify::Error::Inputs(inputs)));
        }
        if !(1..=4).contains(&self.order) {
            return Err(refused(trendid_identify::Error::Order(self.order)));
        }
        if self.zeros >= self.order {
            return Err(refused(trendid_identify::Error::Zeros {
                zeros: self.zeros,
                order: self.order,
            }));
        }
        if self.delay > DELAY {
            return Err(refused(format!(
                "delay is {} samples, expected 0 to {DELAY}",
                self.delay
            )));
        }
        let hold = match self.hold.as_str() {
            "zoh" => Hold::Zero,
            "foh" => Hold::First,
            other => return Err(unknown("hold", other, "'zoh' or 'foh'")),
        };
        let mut settings = settings(self.bandwidth, &self.input_ranges, self.output_range);
        settings.memory = self.memory;
        settings.delays = [self.delay; INPUTS];
        settings.holds = [hold; INPUTS];
        if let Some(noise) = self.output_noise {
            settings.output_noise = noise;
        }
        let mut setup = Setup {
            order: self.order,
            output: Terms::between(usize::from(self.integrator), self.order),
            inputs: vec![Terms::up_to(self.zeros + 1); inputs],
            constant: self.constant,
            initial_state: self.initial_state,
            sample_time: self.sample_time as f32,
            scheme: scheme(&self.scheme)?,
            filter: Filter::None,
            settings,
        };
        if !self.raw {
            let filter = match &self.filter {
                Some(filter) => filter.clone(),
                None => default_filter(&setup, self.bandwidth).map_err(refused)?,
            };
            setup.filter = Filter::Polynomial(filter);
        }
        Ok(setup)
    }
}

#[pymethods]
impl Recursion {
    #[new]
    fn new(question: Question) -> PyResult<Self> {
        let setup = question.setup()?;
        Ok(Self {
            core: setup.build().map_err(refused)?,
            inputs: setup.inputs.len(),
            parameters: setup.parameters(),
            reference: question.reference,
            setup,
        })
    }

    /// One sample: number of the outcome, and the innovation.
    fn update(&mut self, u: Vec<f64>, y: f64) -> PyResult<(u8, Option<f32>)> {
        if u.len() != self.inputs {
            return Err(refused(format!(
                "{} inputs in a sample, expected {}",
                u.len(),
                self.inputs
            )));
        }
        let mut inputs = [0.0; INPUTS];
        for (slot, u) in inputs.iter_mut().zip(&u) {
            *slot = *u as f32;
        }
        let outcome = self
            .core
            .update(&inputs[..self.inputs], (y - self.reference) as f32);
        Ok((number(outcome), outcome.innovation()))
    }

    /// Many samples, with the parameters after every so-many-th: parameters, innovations, outcomes.
    #[allow(clippy::type_complexity, reason = "three arrays")]
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        u: PyReadonlyArray2<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
        every: usize,
    ) -> PyResult<(
        Bound<'py, PyArray2<f32>>,
        Bound<'py, PyArray1<f32>>,
        Bound<'py, PyArray1<u8>>,
    )> {
        let (u, y) = (u.as_array(), y.as_array());
        if u.ncols() != self.inputs || u.nrows() != y.len() {
            return Err(refused(format!(
                "u has the shape ({}, {}), expected ({}, {}): as many rows as y has samples, one column for each input",
                u.nrows(),
                u.ncols(),
                y.len(),
                self.inputs
            )));
        }
        let (theta, innovation, outcome) = py.detach(|| self.pass(u, y, every));
        Ok((
            theta.into_pyarray(py),
            innovation.into_pyarray(py),
            outcome.into_pyarray(py),
        ))
    }

    /// The model at this moment, by name.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = estimate(py, &self.core.estimate())?;
        let errors = self.core.prediction_error();
        values.set_item("ise", errors.ise())?;
        values.set_item("iae", errors.iae())?;
        Ok(values)
    }

    /// The parameters alone.
    fn theta<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let mut theta = vec![0.0; self.parameters];
        self.core.theta(&mut theta);
        theta.into_pyarray(py)
    }

    /// Lets the estimate move or holds it.
    fn adapt(&mut self, on: bool) {
        self.core.adapt(on);
    }

    /// Begins again from nothing.
    fn reset(&mut self) -> PyResult<()> {
        self.core = self.setup.build().map_err(refused)?;
        Ok(())
    }

    /// Begins again from parameters with their standard deviations.
    fn warm_start(&mut self, theta: Vec<f32>, std: Vec<f32>) -> PyResult<()> {
        self.core.warm_start(&theta, &std).map_err(refused)
    }

    /// Names of the outcomes by their numbers.
    #[classattr]
    fn outcomes() -> Vec<&'static str> {
        OUTCOMES.to_vec()
    }
}

impl Recursion {
    fn pass(
        &mut self,
        u: ArrayView2<'_, f64>,
        y: ArrayView1<'_, f64>,
        every: usize,
    ) -> (Array2<f32>, Array1<f32>, Array1<u8>) {
        let n = y.len();
        let rows = n.checked_div(every).unwrap_or(0);
        let mut theta = vec![0.0_f32; rows * self.parameters];
        let mut row = theta.chunks_exact_mut(self.parameters);
        let mut innovations = Array1::from_elem(n, f32::NAN);
        let mut outcomes = Array1::zeros(n);
        let mut inputs = [0.0_f32; INPUTS];
        for (k, y) in y.iter().enumerate() {
            for (slot, u) in inputs.iter_mut().zip(u.row(k)) {
                *slot = *u as f32;
            }
            let outcome = self
                .core
                .update(&inputs[..self.inputs], (y - self.reference) as f32);
            outcomes[k] = number(outcome);
            if let Some(innovation) = outcome.innovation() {
                innovations[k] = innovation;
            }
            if every > 0
                && (k + 1).is_multiple_of(every)
                && let Some(row) = row.next()
            {
                self.core.theta(row);
            }
        }
        let shape = (rows, self.parameters);
        // The lengths agree: rows * parameters numbers.
        let theta = Array2::from_shape_vec(shape, theta).unwrap_or_default();
        (theta, innovations, outcomes)
    }
}

/// The number of an outcome among [`OUTCOMES`].
fn number(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::WarmingUp { .. } => 0,
        Outcome::Held { .. } => 2,
        Outcome::Estimated { .. } => 3,
        Outcome::Replaced { .. } => 4,
        _ => 1,
    }
}
