//! The core behind sizes that are known only at run time.
//!
//! The core fixes its sizes at compile time. A program that reads records does not know
//! them, so this file instantiates the core for every order with some numbers of parameters
//! (`padding` fills up to the next one) and hides the choice behind a trait object. It
//! computes nothing itself.

mod padding;
mod setup;
mod sized;

pub use setup::{DELAY, Filter, INPUTS, PARAMETERS, Settings, Setup, settings};
pub use sized::Recursion;

use trendid::ConfigError;

use crate::dynamic::padding::Padding;
use crate::dynamic::sized::sized;

/// The cores that are instantiated, by order and number of parameters.
macro_rules! sizes {
    ($($order:literal: $($parameters:literal)+;)+) => {
        /// Numbers of parameters, by order.
        const SIZES: [&[usize]; 4] = [$(&[$($parameters),+]),+];

        fn of_size(setup: &Setup, padding: Padding) -> Result<Box<dyn Recursion>, ConfigError> {
            match (setup.order, padding.size()) {
                $($(($order, $parameters) => sized::<$order, $parameters>(setup, padding),)+)+
                (_, found) => Err(ConfigError::ParameterCount { found, expected: PARAMETERS }),
            }
        }
    };
}

// Each costs a second of a processor in a build. The servo's own numbers stand for themselves, and
// those without room for padding: b_0 of four inputs of order 1, eight b_i of order 2.
sizes! {
    1: 2 4 5 6 7;
    2: 3 4 6 8 9 10;
    3: 3 4 5 6 8 10;
    4: 5 6 8 10;
}

impl Setup {
    /// Builds the core for this setup: that of its number of parameters or of the next larger one
    /// that there is, with the surplus known to be 0. Without a memory the numbers are the same;
    /// with one they differ by what an observation of a nominal value counts, and the shortest
    /// memory is that of the larger core.
    ///
    /// # Errors
    /// The core's own [`ConfigError`]; more inputs or parameters than offered are
    /// reported as a parameter count.
    pub fn build(&self) -> Result<Box<dyn Recursion>, ConfigError> {
        if self.inputs.len() > INPUTS {
            return Err(ConfigError::ParameterCount {
                found: self.inputs.len(),
                expected: INPUTS,
            });
        }
        if self.inputs.iter().all(|terms| terms.count() == 0) {
            return Err(ConfigError::NoInput);
        }
        of_size(self, self.padding()?)
    }

    /// To the smallest core that has room.
    fn padding(&self) -> Result<Padding, ConfigError> {
        let sizes = self.order.checked_sub(1).and_then(|order| SIZES.get(order));
        let sizes = sizes.ok_or(ConfigError::OutOfRange {
            setting: "order".into(),
            value: self.order as f32,
            limits: [1.0, 4.0],
        })?;
        let (found, expected) = (self.parameters(), PARAMETERS);
        let padding = sizes.iter().find_map(|size| Padding::to(self, *size));
        padding.ok_or(ConfigError::ParameterCount { found, expected })
    }
}
