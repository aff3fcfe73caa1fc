//! A structure in the next larger core: what is too much are coefficients known to be 0.
//!
//! The core leaves a known parameter out of everything but its arithmetic, so that every other
//! number has the same bits as in the core of the exact size. Added are b_i of inputs that do not
//! exist, whose signal is 0, and where there are not enough those of the other inputs above their
//! own. Where there is room below them only (four inputs, each with b_(m-1)) the standard
//! deviations of the read-out differ: it measures an input by its first coefficient. With a memory
//! the core takes the parameters in turns, known ones too: a round is longer then, and numbers
//! differ by what an observation of a nominal value counts.

use std::ops::Range;

use trendid::ConfigError;
use trendid::estimation::Terms;

use crate::dynamic::setup::{INPUTS, Setup};

/// Which parameters of a core are those of a structure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Padding {
    /// The b_i of the core.
    pub(super) inputs: [Terms; INPUTS],
    /// Where the parameters of the structure stand in those of the core.
    pub(super) places: Vec<usize>,
    size: usize,
}

/// Where coefficients are added to those of an input.
#[derive(Clone, Copy)]
enum Room {
    /// Above its highest power; all, where it has none.
    Above,
    Between,
    /// Below its lowest power.
    Below,
}

impl Room {
    fn powers(self, own: Terms, order: usize) -> Range<usize> {
        let end = numerators(own, order);
        let lowest = (0..end).find(|power| own.contains(*power)).unwrap_or(0);
        match self {
            Self::Above => end..order,
            Self::Between => lowest..end,
            Self::Below => 0..lowest,
        }
    }
}

/// One more than the highest power of a numerator.
pub(super) fn numerators(terms: Terms, order: usize) -> usize {
    (0..order)
        .rev()
        .find(|power| terms.contains(*power))
        .map_or(0, |power| power + 1)
}

fn with(terms: Terms, power: usize, order: usize) -> Terms {
    let powers: Vec<usize> = (0..order)
        .filter(|p| *p == power || terms.contains(*p))
        .collect();
    Terms::of(&powers)
}

impl Padding {
    /// The padding to so many parameters; `None` where there are more, or not enough that could be
    /// added.
    pub(super) fn to(setup: &Setup, size: usize) -> Option<Self> {
        let mut own = [Terms::NONE; INPUTS];
        for (own, terms) in own.iter_mut().zip(&setup.inputs) {
            *own = *terms;
        }
        let mut inputs = own;
        let mut missing = size.checked_sub(setup.parameters())?;
        for room in [Room::Above, Room::Between, Room::Below] {
            for input in (0..INPUTS).rev() {
                for power in room.powers(own[input], setup.order) {
                    if missing > 0 && !inputs[input].contains(power) {
                        inputs[input] = with(inputs[input], power, setup.order);
                        missing -= 1;
                    }
                }
            }
        }
        if missing > 0 {
            return None;
        }
        let mut places = Vec::new();
        let mut place = setup.output.count();
        places.extend(0..place);
        for (own, terms) in own.iter().zip(&inputs) {
            for power in (0..setup.order).filter(|power| terms.contains(*power)) {
                if own.contains(power) {
                    places.push(place);
                }
                place += 1;
            }
        }
        let others = usize::from(setup.constant) + usize::from(setup.initial_state);
        places.extend(place..place + others);
        Some(Self {
            inputs,
            places,
            size,
        })
    }

    /// Number of parameters of the core.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Those of the structure among values of the core.
    pub(super) fn of<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let values = self.places.iter().map(|place| values.get(*place));
        values.flatten().copied().collect()
    }

    /// The core's values from those of the structure, 0 for what was added.
    pub(super) fn filled<const N: usize>(&self, values: &[f32]) -> Result<[f32; N], ConfigError> {
        let (found, expected) = (values.len(), self.places.len());
        if found != expected {
            return Err(ConfigError::ParameterCount { found, expected });
        }
        let mut filled = [0.0; N];
        for (place, value) in self.places.iter().zip(values) {
            if let Some(slot) = filled.get_mut(*place) {
                *slot = *value;
            }
        }
        Ok(filled)
    }

    /// An error of the core under the structure's number of the parameter.
    pub(super) fn named(&self, mut error: ConfigError) -> ConfigError {
        if let ConfigError::NotFinite { setting, .. } | ConfigError::OutOfRange { setting, .. } =
            &mut error
            && let Some(index) = &mut setting.index
            && let Some(own) = self.places.iter().position(|place| place == index)
        {
            *index = own;
        }
        error
    }
}

#[cfg(test)]
mod tests;
