//! One structure over one record: filter, delay, estimate and a fit on samples that nothing of it
//! has seen.

mod by_sums;
mod friction;
mod model;
mod once;
mod recursion;
#[cfg(test)]
mod tests;

use trendid::trends::Scheme;

pub(crate) use by_sums::{Behind, elsewhere, model as model_behind};
pub use model::{Friction, Identification, Way};
use once::once;
use recursion::recursion;

use crate::error::Error;
use crate::problem::Problem;
use crate::search::{Choice, Freedom, Progress};

/// Identifies the model of a problem, with a trace of about `trace_points` rows (0 for none).
///
/// Cost: two passes over the record for each of some 14 poles and of 7 delays or more, on all
/// processors, and half of that again for the fit held out.
///
/// # Errors
/// [`Error::Filter`]; [`Error::OneSine`]; [`Error::CannotCarry`] when the samples do not separate
/// the parameters or no model of the search can be simulated; a configuration that the core
/// refuses.
pub fn identify(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    progress: &dyn Progress,
) -> Result<Identification, Error> {
    freedom.check(problem.signals.dt)?;
    let recursive = problem.options.memory.is_some()
        || problem.options.scheme != Scheme::Tustin
        || freedom.pole == Choice::Given(None);
    if recursive {
        return recursion(problem, freedom, trace_points);
    }
    let found = once(problem, freedom, trace_points, progress);
    friction::held(problem, freedom, trace_points, found)
}
