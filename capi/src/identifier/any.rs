//! The identifier of any structure: the kind whose sizes are those of the structure, in one memory
//! for all.

use core::array::from_fn;

use trendid::estimation::Terms;
use trendid::{ConfigError, Structure as CoreStructure};

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::Identifier;
use crate::identifier::ORDER_MAX;
use crate::identifier::body::{Head, begin};
use crate::identifier::kind::Plain;
use crate::identifier::kinds::{ANY_DELAY_MAX, ANY_PARAMETERS_MAX, Any, of};
use crate::settings::{INPUTS_MAX, Settings, Structure};

/// Makes an identifier of this structure; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_any_init(
    memory: *mut Any,
    settings: *const Settings,
    structure: *const Structure,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    let read = unsafe { of(settings) }.and_then(|settings| {
        // SAFETY: by the contract of the header.
        let structure = unsafe { crate::memory::shared(structure) }?;
        structure.check()?;
        Ok((settings, structure))
    });
    match read {
        // SAFETY: by the contract of the header.
        Ok((settings, structure)) => unsafe {
            any(memory, settings, structure, identifier, detail)
        },
        // SAFETY: by the contract of the header.
        Err(refused) => unsafe { refuse(memory, refused, detail) },
    }
}

/// A refusal before the sizes are known: no object is left, as by every other one.
///
/// # Safety
/// As [`begin`].
unsafe fn refuse(memory: *mut Any, refused: Detail, detail: *mut Detail) -> Error {
    // SAFETY: by the contract of this function; nothing is made.
    unsafe { crate::memory::make::<Any, Head>(memory, |_| Err(refused), detail) }
}

/// A kind of these sizes; inputs that the structure does not have are not used.
fn sized<const M: usize, const N: usize>(
    kind: &mut Plain<M, N, INPUTS_MAX, ANY_DELAY_MAX>,
    settings: &Settings,
    structure: &Structure,
) -> Result<(), Detail> {
    let inputs = [Some(0), Some(1)];
    let given = usize::from(structure.inputs);
    kind.configure(settings, structure.sized()?, inputs, given, 0)
}

/// Makes the identifier whose sizes are those of the structure.
///
/// # Safety
/// As [`begin`].
unsafe fn any(
    memory: *mut Any,
    settings: &Settings,
    structure: &Structure,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    macro_rules! of_these_sizes {
        ($($m:literal: $($n:literal)+;)+) => {
            match (structure.order, structure.parameters()) {
                $($(($m, $n) => {
                    let kind = |kind: &mut _| sized::<$m, $n>(kind, settings, structure);
                    // SAFETY: by the contract of this function.
                    unsafe { begin(memory, kind, identifier, detail) }
                })+)+
                (_, found) => {
                    let expected = ANY_PARAMETERS_MAX;
                    let refused = ConfigError::ParameterCount { found, expected }.into();
                    // SAFETY: by the contract of this function.
                    unsafe { refuse(memory, refused, detail) }
                }
            }
        };
    }
    of_these_sizes! {
        1: 1 2 3 4 5;
        2: 1 2 3 4 5 6;
        3: 1 2 3 4 5 6;
        4: 1 2 3 4 5 6;
    }
}

/// The powers of the bits.
fn terms(bits: u8) -> Terms {
    let powers: [usize; 8] = from_fn(|power| power);
    let first = |power: usize| bits & (1 << power) != 0;
    // A list of eight places: a power that is absent repeats one that exists.
    match powers.into_iter().find(|power| first(*power)) {
        None => Terms::NONE,
        Some(some) => Terms::of(&powers.map(|power| if first(power) { power } else { some })),
    }
}

impl Structure {
    /// An error unless order and number of inputs are offered.
    pub(crate) fn check(&self) -> Result<(), Detail> {
        let within = |name, value: u8, most: usize| {
            if value >= 1 && usize::from(value) <= most {
                return Ok(());
            }
            Err(Detail::out_of_range(
                name,
                f32::from(value),
                [1.0, most as f32],
            ))
        };
        within("order", self.order, ORDER_MAX)?;
        within("inputs", self.inputs, INPUTS_MAX)
    }

    /// Number of parameters.
    pub(crate) fn parameters(&self) -> usize {
        let bits = |terms: &u8| terms.count_ones() as usize;
        let inputs: usize = self
            .input_terms
            .iter()
            .take(usize::from(self.inputs))
            .map(bits)
            .sum();
        bits(&self.output_terms)
            + inputs
            + usize::from(self.constant != 0)
            + usize::from(self.initial_state != 0)
    }

    /// The structure of the core with its sizes.
    pub(crate) fn sized<const M: usize, const N: usize>(
        &self,
    ) -> Result<CoreStructure<M, N, INPUTS_MAX>, Detail> {
        let mut inputs = self.input_terms.map(terms);
        for unused in inputs.iter_mut().skip(usize::from(self.inputs)) {
            *unused = Terms::NONE;
        }
        let output = terms(self.output_terms);
        let constant = self.constant != 0;
        Ok(if self.initial_state != 0 {
            CoreStructure::try_with_initial_state(output, inputs, constant)?
        } else {
            CoreStructure::try_new(output, inputs, constant)?
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_their_bits() {
        for bits in 0..=u8::MAX {
            let terms = terms(bits);
            for power in 0..8 {
                assert_eq!(terms.contains(power), bits & (1 << power) != 0);
            }
        }
    }
}
