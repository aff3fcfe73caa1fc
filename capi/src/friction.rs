//! The input of Coulomb friction: the sign of the velocity.

use trendid::inputs::Coulomb;

use crate::detail::Detail;
use crate::error::Error;
use crate::memory::{Inside, Object, make, object_mut, write};

/// Words of 8 bytes of a `trendid_friction`.
pub const FRICTION_WORDS: usize = 4;

/// The mean sign of the velocity from sample to sample, for the input of Coulomb friction: a drive
/// that turns in between has neither sign.
///
/// That input has the hold `TRENDID_HOLD_MEAN`.
#[repr(C)]
pub struct Friction {
    words: [u64; FRICTION_WORDS],
}

impl Inside for Coulomb {
    const MAGIC: u32 = 0xC0C0_C0C0;
}

/// Bytes of a `trendid_friction`, and how many of them this build uses.
pub(crate) const FRICTION_SIZES: [usize; 2] = [size_of::<Friction>(), size_of::<Object<Coulomb>>()];

/// Makes one of a drive at rest; velocities within `rest` of zero, in the unit of the velocity, are
/// zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_friction_init(
    memory: *mut Friction,
    rest: f32,
    detail: *mut Detail,
) -> Error {
    let fill = |friction: *mut Coulomb| {
        if !(rest >= 0.0 && rest.is_finite()) {
            return Err(Detail::out_of_range("rest", rest, [0.0, f32::MAX]));
        }
        // SAFETY: memory for it, by the contract of `make`.
        unsafe { friction.write(Coulomb::new(rest)) };
        Ok(())
    };
    // SAFETY: by the contract of the header; where it succeeds, all of it is written.
    unsafe { make(memory, fill, detail) }
}

/// Takes the velocity of a sample, NaN as zero; `sign` is the mean sign since the sample before,
/// within -1 and 1.
///
/// For the interrupt of the sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_friction_update(
    friction: *mut Friction,
    velocity: f32,
    sign: *mut f32,
) -> Error {
    // Before the velocity is taken: a sign that has no place would be lost.
    if let Err(error) = crate::memory::check(sign) {
        return error;
    }
    // SAFETY: by the contract of the header.
    let found = unsafe { object_mut(friction.cast::<Object<Coulomb>>()) };
    // SAFETY: by the contract of the header.
    let done = found.and_then(|friction| unsafe { write(sign, friction.update(velocity)) });
    crate::error::code(done)
}
