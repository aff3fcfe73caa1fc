//! Arrays as signals that outlive the hold of the interpreter.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use trendid_identify::derived::COULOMB;
use trendid_identify::{Choice, Freedom, Hold, Input, Scheme, Signals, coulomb_input, standstill};

use crate::refusal::{refused, unknown};

/// Signals in the roles of a model.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Arrays<'py> {
    dt: f64,
    output: PyReadonlyArray1<'py, f64>,
    inputs: Vec<(String, PyReadonlyArray1<'py, f64>)>,
    /// `zoh` or `foh`.
    hold: String,
    /// Whether sgn(v) is an input.
    coulomb: bool,
    /// v, where it was measured.
    velocity: Option<PyReadonlyArray1<'py, f64>>,
}

/// The same, owned.
pub(crate) struct Owned {
    dt: f64,
    output: Vec<f64>,
    inputs: Vec<(String, Vec<f64>, bool, Hold)>,
    standstill: Option<Vec<bool>>,
}

impl Arrays<'_> {
    /// Copies, with sgn(v) and without the inputs at standstill where that is asked for.
    pub(crate) fn owned(&self) -> PyResult<Owned> {
        let hold = match self.hold.as_str() {
            "zoh" => Hold::Zero,
            "foh" => Hold::First,
            other => return Err(unknown("hold", other, "'zoh' or 'foh'")),
        };
        let copy = |array: &PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
        let output = copy(&self.output);
        let mut inputs: Vec<_> = self
            .inputs
            .iter()
            .map(|(name, samples)| (name.clone(), copy(samples), true, hold))
            .collect();
        let mut still = None;
        if self.coulomb {
            let v = match &self.velocity {
                Some(v) => copy(v),
                None => coulomb_input::velocity(&output, self.dt).map_err(refused)?,
            };
            inputs.push((COULOMB.into(), coulomb_input::signs(&v), false, Hold::Zero));
            still = standstill::standstill(&output);
        }
        Ok(Owned {
            dt: self.dt,
            output,
            inputs,
            standstill: still,
        })
    }
}

impl Owned {
    /// As the library takes them.
    pub(crate) fn signals(&self) -> Signals<'_> {
        let inputs = self
            .inputs
            .iter()
            .map(|(name, samples, delayed, hold)| Input {
                name,
                samples,
                delayed: *delayed,
                hold: *hold,
            });
        Signals {
            dt: self.dt,
            output: &self.output,
            inputs: inputs.collect(),
            standstill: self.standstill.as_deref(),
        }
    }

    /// Seconds of standstill that are left out.
    pub(crate) fn standstill_s(&self) -> f64 {
        let still = self.standstill.iter().flatten();
        still.filter(|still| **still).count() as f64 * self.dt
    }
}

/// What a search may choose: `None` is its to find; a pole of 0 stands for raw trends.
pub(crate) fn freedom(pole: Option<f64>, delay: Option<usize>) -> Freedom {
    Freedom {
        pole: match pole {
            None => Choice::Auto,
            Some(0.0) => Choice::Given(None),
            Some(pole) => Choice::Given(Some(pole)),
        },
        delay: delay.map_or(Choice::Auto, Choice::Given),
    }
}

/// The scheme of a name.
pub(crate) fn scheme(name: &str) -> PyResult<Scheme> {
    match name {
        "tustin" => Ok(Scheme::Tustin),
        "goodwin" => Ok(Scheme::Goodwin),
        other => Err(unknown("scheme", other, "'tustin' or 'goodwin'")),
    }
}
