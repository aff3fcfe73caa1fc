//! Many structures compared.

use numpy::ToPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trendid_identify::poor_input::PoorInput;
use trendid_identify::structure_choice::{Candidate, Range, select as compare};
use trendid_identify::{Options, Structure};

use crate::refusal::refused;
use crate::signals::{Arrays, freedom, scheme};

/// What is compared.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Question {
    max_order: usize,
    integrator: bool,
    constant: bool,
    delay: Option<usize>,
    pole: Option<f64>,
    scheme: String,
}

/// Compares; gives everything by name.
#[pyfunction]
pub(crate) fn select<'py>(
    py: Python<'py>,
    signals: Arrays<'py>,
    question: Question,
) -> PyResult<Bound<'py, PyDict>> {
    let owned = signals.owned()?;
    let range = Range {
        max_order: question.max_order,
        integrating: question.integrator,
        constant: question.constant,
    };
    let options = Options {
        scheme: scheme(&question.scheme)?,
        memory: None,
    };
    let freedom = freedom(question.pole, question.delay);
    let signals = owned.signals();
    let selection = py
        .detach(|| compare(&signals, range, options, freedom, &()))
        .map_err(refused)?;
    let values = PyDict::new(py);
    let candidates = selection.candidates.iter().map(|c| candidate(py, c));
    values.set_item("candidates", candidates.collect::<PyResult<Vec<_>>>()?)?;
    let dropped = selection.dropped.iter().map(|d| {
        let one = structure(py, d.structure)?;
        one.set_item("reason", d.reason.to_string())?;
        Ok(one)
    });
    values.set_item("dropped", dropped.collect::<PyResult<Vec<_>>>()?)?;
    values.set_item("recommended", selection.recommended)?;
    values.set_item("smallest", selection.smallest)?;
    values.set_item("alike", selection.alike)?;
    values.set_item("poor_input", selection.poor_input.map(PoorInput::name))?;
    Ok(values)
}

fn structure(py: Python<'_>, s: Structure) -> PyResult<Bound<'_, PyDict>> {
    let values = PyDict::new(py);
    values.set_item("order", s.order)?;
    values.set_item("integrator", s.integrator)?;
    values.set_item("zeros", s.zeros)?;
    values.set_item("constant", s.constant)?;
    Ok(values)
}

fn candidate<'py>(py: Python<'py>, c: &Candidate) -> PyResult<Bound<'py, PyDict>> {
    let values = structure(py, c.structure)?;
    values.set_item("delay", c.delay)?;
    values.set_item("model_delay", c.model_delay)?;
    values.set_item("delay_sigma", c.delay_sigma)?;
    values.set_item("delay_at_end", c.delay_at_end)?;
    values.set_item("filter_pole", c.pole)?;
    values.set_item("parameters", c.names.clone())?;
    let e = &c.found.estimate;
    values.set_item("theta", e.theta.to_pyarray(py))?;
    values.set_item("sigma", e.sigma.to_pyarray(py))?;
    values.set_item("fit", c.fit_x0c)?;
    Ok(values)
}
