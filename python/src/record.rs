//! One structure over a record.

use numpy::{PyArray1, PyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trendid_identify::derived::Quantity;
use trendid_identify::poor_input::PoorInput;
use trendid_identify::tune::Model;
use trendid_identify::{
    Estimate, Friction, Identification, Options, Problem, Structure, Trace, Way, identify as find,
};

use crate::refusal::refused;
use crate::signals::{Arrays, freedom, scheme};

/// What is asked beside the signals.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Question {
    order: usize,
    integrator: bool,
    zeros: usize,
    constant: bool,
    delay: Option<usize>,
    pole: Option<f64>,
    memory: Option<f64>,
    scheme: String,
    trace: usize,
}

/// Identifies; gives everything by name.
#[pyfunction]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    signals: Arrays<'py>,
    question: Question,
) -> PyResult<Bound<'py, PyDict>> {
    let owned = signals.owned()?;
    let structure = Structure {
        order: question.order,
        integrator: question.integrator,
        zeros: question.zeros,
        constant: question.constant,
    };
    let options = Options {
        scheme: scheme(&question.scheme)?,
        memory: question.memory,
    };
    let freedom = freedom(question.pole, question.delay);
    let signals = owned.signals();
    let problem = Problem::new(&signals, structure, options).map_err(refused)?;
    let found = py
        .detach(|| find(&problem, freedom, question.trace, &()))
        .map_err(refused)?;
    let values = estimate(py, &found.estimate)?;
    values.set_item("parameters", problem.parameter_names())?;
    let removed = match found.friction {
        Friction::HeldAtRest => 0.0,
        _ => owned.standstill_s(),
    };
    values.set_item("standstill_s", removed)?;
    describe(&values, &found)?;
    derived(&values, &problem, &found.estimate)?;
    let around = Model::around(&problem, &found).into_iter();
    let around: Vec<_> = around.map(|model| (model.a, model.b)).collect();
    values.set_item("around", around)?;
    trace(&values, &found.trace)?;
    Ok(values)
}

/// A model with its covariance, by name.
pub(crate) fn estimate<'py>(py: Python<'py>, e: &Estimate) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    values.set_item("theta", e.theta.to_pyarray(py))?;
    values.set_item("sigma", e.sigma.to_pyarray(py))?;
    values.set_item("covariance", PyArray2::from_vec2(py, &e.covariance)?)?;
    values.set_item("a", e.a.to_pyarray(py))?;
    let b: Vec<_> = e.b.iter().map(|b| b.to_pyarray(py)).collect();
    values.set_item("b", b)?;
    values.set_item("constant", e.constant)?;
    let r = &e.reading;
    values.set_item("gain", r.gain)?;
    values.set_item("omega0", r.omega0)?;
    values.set_item("damping", r.damping)?;
    values.set_item("reading_sigma", e.reading_sigma)?;
    values.set_item("poles", r.poles.clone())?;
    values.set_item("stable", r.stable)?;
    Ok(values)
}

/// How the model was found, and what it is worth.
fn describe(values: &Bound<'_, PyDict>, found: &Identification) -> PyResult<()> {
    let py = values.py();
    let way = match found.way {
        Way::Instruments => "instruments",
        Way::OutputError => "output error",
        Way::WeakInstruments => "least squares",
        Way::Recursion => "recursion",
    };
    values.set_item("method", way)?;
    values.set_item("delay", found.delay)?;
    values.set_item("delay_sigma", found.delay_sigma())?;
    values.set_item("delay_at_end", found.delay_at_end)?;
    values.set_item("poor_input", found.poor_input.map(PoorInput::name))?;
    values.set_item("filter_pole", found.pole)?;
    let filter = found.own_filter.as_ref().map(|f| f.to_pyarray(py));
    values.set_item("filter", filter)?;
    values.set_item("effective_blocks", found.effective_blocks)?;
    let least_squares = found.least_squares.as_ref();
    let least_squares = least_squares.map(|e| (e.theta.to_pyarray(py), e.sigma.to_pyarray(py)));
    values.set_item("least_squares", least_squares)?;
    let run = found.free_run.as_ref();
    values.set_item("fit", run.map(|run| (run.fit_x0, run.fit_x0c)))?;
    values.set_item("simulated", run.map(|run| run.y.to_pyarray(py)))?;
    values.set_item("held_out", found.held_out)?;
    values.set_item("ise", found.errors.ise)?;
    values.set_item("iae", found.errors.iae)?;
    values.set_item("predicted", found.errors.samples)
}

/// What follows from the parameters.
fn derived(values: &Bound<'_, PyDict>, problem: &Problem<'_>, e: &Estimate) -> PyResult<()> {
    let pair = |q: Quantity| (q.value, q.sigma);
    let inputs = 0..problem.signals.inputs.len();
    let gains: Vec<_> = inputs.map(|i| pair(problem.gain(e, i))).collect();
    values.set_item("gains", gains)?;
    let times: Vec<_> = problem.time_constants(e).into_iter().map(pair).collect();
    values.set_item("time_constants", times)?;
    let poles = problem.poles(e).into_iter();
    let poles: Vec<_> = poles.map(|(re, im)| (pair(re), pair(im))).collect();
    values.set_item("pole_sigmas", poles)?;
    let balance = problem.force_balance(e).into_iter();
    let balance: Vec<_> = balance.map(|(name, q)| (name, pair(q))).collect();
    values.set_item("force_balance", balance)
}

/// The course of the parameters: sample numbers, parameters, standard deviations.
fn trace(values: &Bound<'_, PyDict>, trace: &Trace) -> PyResult<()> {
    let py = values.py();
    let samples: Vec<u64> = trace.rows.iter().map(|row| row.0 as u64).collect();
    let theta: Vec<Vec<f64>> = trace.rows.iter().map(|row| row.1.clone()).collect();
    let sigma: Vec<Vec<f64>> = trace.rows.iter().map(|row| row.2.clone()).collect();
    values.set_item("trace_samples", PyArray1::from_vec(py, samples))?;
    values.set_item("trace_theta", PyArray2::from_vec2(py, &theta)?)?;
    values.set_item("trace_sigma", PyArray2::from_vec2(py, &sigma)?)
}
