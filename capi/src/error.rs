//! What a function answers.

use core::ffi::{CStr, c_char};

/// What a function answers; 0 is success. Otherwise nothing was done, and an `_init` leaves no
/// object.
#[must_use]
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error {
    /// Done.
    Ok = 0,
    /// A pointer is NULL.
    Null = 1,
    /// A pointer is not aligned for its type.
    Misaligned = 2,
    /// The object was never initialised, or its memory was overwritten.
    NotInitialised = 3,
    /// The number of inputs, parameters or bytes is not that of the object.
    Length = 4,
    /// A setting or an argument is NaN or infinite.
    NotFinite = 5,
    /// A setting is not above zero.
    NotPositive = 6,
    /// A setting is outside its limits.
    OutOfRange = 7,
    /// A filter has a pole that is not stable.
    Unstable = 8,
    /// A filter has a pole too fast for the sample time.
    TooFast = 9,
    /// The structure has more parameters or inputs than the object holds.
    ParameterCount = 10,
    /// The structure has a term a_i or b_i with i not below the order.
    Term = 11,
    /// No input of the structure has a term.
    NoInput = 12,
    /// The unit of the position is too small for the accelerations of the axis: use mm, not um.
    Unit = 13,
    /// The model may not control the axis; the reason is beside.
    ModelRefused = 14,
    /// There is no value yet: too few samples, or no verified model.
    NotYet = 15,
    /// The record is erased memory.
    RecordEmpty = 16,
    /// The record does not pass its CRC.
    RecordDamaged = 17,
    /// The record has another version.
    RecordVersion = 18,
    /// The record belongs to another machine.
    RecordPlant = 19,
    /// The record was made under another sample time, delay or travel.
    RecordSettings = 20,
    /// The object has no dead zone.
    NoDeadZone = 21,
    /// An error that this version of the interface does not name.
    Other = 22,
    /// A motion was requested while the controller does not have the axis, or has not seen it yet.
    NotControlling = 23,
    /// The kind of the object does not offer this call.
    NotOffered = 24,
}

impl Error {
    /// One sentence.
    pub(crate) const fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::Null => c"a pointer is NULL",
            Self::Misaligned => c"a pointer is not aligned for its type",
            Self::NotInitialised => c"the object was never initialised, or its memory was overwritten",
            Self::Length => c"the number of inputs, parameters or bytes is not that of the object",
            Self::NotFinite => c"a value is not finite",
            Self::NotPositive => c"a value is not a finite number above 0",
            Self::OutOfRange => c"a value is outside its limits",
            Self::Unstable => c"the filter has a pole that is not stable",
            Self::TooFast => c"the filter has a pole too fast for the sample time",
            Self::ParameterCount => c"the structure has more parameters or inputs than the object holds",
            Self::Term => c"the structure has a term with a power that is not below its order",
            Self::NoInput => c"no input of the structure has a term",
            Self::Unit => c"the unit of the position is too small for the accelerations of the axis: mm, not um",
            Self::ModelRefused => c"the model may not control the axis",
            Self::NotYet => c"there is no value yet",
            Self::RecordEmpty => c"the record is erased memory",
            Self::RecordDamaged => c"the record does not pass its CRC",
            Self::RecordVersion => c"the record has another version",
            Self::RecordPlant => c"the record belongs to another machine",
            Self::RecordSettings => c"the record was made under another sample time, delay or travel",
            Self::NoDeadZone => c"the object has no dead zone",
            Self::NotControlling => c"the axis is not under control",
            Self::NotOffered => c"the kind of the object does not offer this call",
            Self::Other => c"an error that this version of the interface does not name",
        }
    }
}

/// Every code, by its number.
const ALL: [Error; 25] = [
    Error::Ok,
    Error::Null,
    Error::Misaligned,
    Error::NotInitialised,
    Error::Length,
    Error::NotFinite,
    Error::NotPositive,
    Error::OutOfRange,
    Error::Unstable,
    Error::TooFast,
    Error::ParameterCount,
    Error::Term,
    Error::NoInput,
    Error::Unit,
    Error::ModelRefused,
    Error::NotYet,
    Error::RecordEmpty,
    Error::RecordDamaged,
    Error::RecordVersion,
    Error::RecordPlant,
    Error::RecordSettings,
    Error::NoDeadZone,
    Error::Other,
    Error::NotControlling,
    Error::NotOffered,
];

/// One sentence on a code, in static memory; of another number that it is none.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_error_text(error: i32) -> *const c_char {
    let known = ALL.iter().find(|known| **known as i32 == error);
    known
        .map_or(c"not an error code of this library", |known| known.text())
        .as_ptr()
}

/// The code of a result.
pub(crate) fn code(result: Result<(), Error>) -> Error {
    match result {
        Ok(()) => Error::Ok,
        Err(error) => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_its_own_sentence() {
        for (number, error) in ALL.into_iter().enumerate() {
            assert_eq!(error as usize, number);
            let others = ALL.into_iter().filter(|other| other.text() == error.text());
            assert_eq!(others.count(), 1, "{error:?}");
            // SAFETY: a text in static memory that ends with 0.
            let text = unsafe { CStr::from_ptr(trendid_error_text(number as i32)) };
            assert_eq!(text, error.text());
        }
        for none in [-1, ALL.len() as i32, i32::MAX] {
            // SAFETY: as above.
            let text = unsafe { CStr::from_ptr(trendid_error_text(none)) };
            assert_eq!(text, c"not an error code of this library");
        }
    }
}
