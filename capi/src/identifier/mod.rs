//! Identification sample by sample.

#[cfg(feature = "any")]
mod any;
mod body;
mod calls;
mod instrumented;
mod kind;
mod kinds;
mod outputs;
mod recursion;

#[cfg(feature = "any")]
pub use any::*;
pub(crate) use body::begin;
pub use calls::*;
pub use kinds::*;
pub(crate) use kinds::{INSTRUMENTED_SIZES, OfServo3, SIZES};
pub use outputs::*;

/// An identifier of any kind: the handle that the `_init` of its memory gives.
pub struct Identifier {
    _opaque: [u8; 0],
}
