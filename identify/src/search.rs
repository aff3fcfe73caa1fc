//! Freedom of a search over a record.

use std::f64::consts::PI;

use crate::error::Error;

/// A value that is given, or one to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice<T> {
    /// Taken as it is.
    Given(T),
    /// The best on the record.
    Auto,
}

/// Freedom of a search: a given pole or delay is left alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Freedom {
    /// The filter poles \[rad/s\]; `Given(None)` for raw trends.
    pub pole: Choice<Option<f64>>,
    /// The delay in samples.
    pub delay: Choice<usize>,
}

impl Freedom {
    /// Refuses filter poles that the sampling does not carry.
    ///
    /// # Errors
    /// [`Error::Filter`].
    pub fn check(&self, dt: f64) -> Result<(), Error> {
        let fastest = PI / dt;
        match self.pole {
            Choice::Given(Some(pole)) if pole >= fastest => Err(Error::Filter { pole, fastest }),
            _ => Ok(()),
        }
    }
}

impl Default for Freedom {
    /// The best filter without delay.
    fn default() -> Self {
        Self {
            pole: Choice::Auto,
            delay: Choice::Given(0),
        }
    }
}

/// Receives the progress of a search; `()` ignores it.
pub trait Progress: Sync {
    /// So many steps will follow.
    fn begin(&self, _steps: usize) {}
    /// One of them is done.
    fn step(&self) {}
}

impl Progress for () {}
