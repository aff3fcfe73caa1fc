//! Gains for a loop from a model.

use numpy::{IntoPyArray, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trendid_identify::tune::{Gains, Goal, Margins, Model, TunedLoop, tune as find};

use crate::refusal::refused;

/// A model by its coefficients: a_0 .. a_{m-1}, b_0 ..
type Coefficients = (Vec<f64>, Vec<f64>);

/// Gains for `model` with a delay \[s\] that hold for `around` too; gives everything by name.
#[pyfunction]
pub(crate) fn tune<'py>(
    py: Python<'py>,
    model: Coefficients,
    around: Vec<Coefficients>,
    delay: f64,
    sample_time: f64,
    bandwidth: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let of = |(a, b): Coefficients| Model { a, b, delay };
    let model = of(model);
    let around: Vec<Model> = around.into_iter().map(of).collect();
    let goal = Goal {
        sample_time,
        bandwidth,
    };
    let tuned = py.detach(|| find(&model, &around, goal)).map_err(refused)?;
    let values = PyDict::new(py);
    let loops = tuned.loops.iter().map(|found| {
        let one = found_loop(py, found, sample_time)?;
        let step = found.step(&tuned.plant, 15.0 / found.bandwidth);
        let column = |of: fn(&trendid_identify::tune::Sample) -> f64| {
            let values: Vec<f64> = step.iter().map(of).collect();
            values.into_pyarray(py)
        };
        one.set_item(
            "step",
            (
                column(|s| s.time),
                column(|s| s.output),
                column(|s| s.command),
            ),
        )?;
        Ok(one)
    });
    values.set_item("loops", loops.collect::<PyResult<Vec<_>>>()?)?;
    values.set_item("refused", tuned.refused)?;
    values.set_item("feedforward", tuned.feedforward.to_pyarray(py))?;
    Ok(values)
}

fn found_loop<'py>(
    py: Python<'py>,
    found: &TunedLoop,
    sample_time: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    values.set_item("kind", found.gains.name())?;
    values.set_item("bandwidth", found.bandwidth)?;
    let gains = PyDict::new(py);
    match &found.gains {
        Gains::Cascade(c) => {
            for (name, value) in [("kv", c.kv), ("kp", c.kp), ("ti", c.ti), ("tf", c.tf)] {
                gains.set_item(name, value)?;
            }
        }
        Gains::Pid(c) => {
            for (name, value) in [("kp", c.kp), ("ti", c.ti), ("td", c.td), ("tf", c.tf)] {
                gains.set_item(name, value)?;
            }
            let (b, a) = c.difference_equation(sample_time);
            gains.set_item("b", b)?;
            gains.set_item("a", a)?;
        }
        Gains::StateFeedback(c) => {
            gains.set_item("k", c.k.clone())?;
            gains.set_item("k_input", c.k_input)?;
            gains.set_item("n", c.n)?;
            gains.set_item("l", c.l.clone())?;
            gains.set_item("derivatives", c.derivatives)?;
        }
    }
    values.set_item("gains", gains)?;
    values.set_item("margins", margins(py, &found.margins)?)?;
    let worst = found.worst.as_ref();
    values.set_item("worst", worst.map(|worst| margins(py, worst)).transpose()?)?;
    Ok(values)
}

fn margins<'py>(py: Python<'py>, margins: &Margins) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    values.set_item("gain", margins.gain)?;
    values.set_item("phase_deg", margins.phase_deg)?;
    values.set_item("delay_s", margins.delay)?;
    values.set_item("max_sensitivity", margins.max_sensitivity)?;
    values.set_item("crossover", margins.crossover)?;
    values.set_item("stable", margins.stable)?;
    Ok(values)
}
