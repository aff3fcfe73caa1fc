//! The native part of the Python package `trendid`: arrays in, arrays out, no choice of its own.
//!
//! | module | Python | what it does |
//! |---|---|---|
//! | [`refusal`] | `Refusal` | errors of the libraries as exceptions |
//! | [`signals`] | - | arrays as checked signals |
//! | [`record`] | `identify` | one structure over a record |
//! | [`selection`] | `select` | many structures compared |
//! | [`tuning`] | `tune` | gains for a loop |
//! | [`recursion`] | `Identifier` | sample by sample |
//! | [`axis`] | `ServoLoop`, `simulate_axis` | the pneumatic axis, in a loop or alone |
//!
//! What users call is in `trendid/*.py`; there are the documentation and the defaults.

use pyo3::prelude::*;

mod axis;
mod record;
mod recursion;
mod refusal;
mod selection;
mod signals;
mod tuning;

/// The native part of the package `trendid`.
#[pymodule]
fn _trendid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Refusal", module.py().get_type::<refusal::Refusal>())?;
    module.add_class::<recursion::Recursion>()?;
    module.add_class::<axis::AxisLoop>()?;
    module.add_function(wrap_pyfunction!(record::identify, module)?)?;
    module.add_function(wrap_pyfunction!(selection::select, module)?)?;
    module.add_function(wrap_pyfunction!(tuning::tune, module)?)?;
    module.add_function(wrap_pyfunction!(axis::simulate_axis, module)?)
}
