//! Inputs as they come: integrating drives of order 2 and 3, with Coulomb friction or without.
//!
//! One after another because cbindgen reads types and functions as they stand and does not see
//! through a macro.

use trendid::Structure as CoreStructure;

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::Identifier;
use crate::identifier::body::begin;
use crate::identifier::kinds::{OfCoulomb2, OfCoulomb3, OfServo2, OfServo3, of, with_friction};
use crate::settings::Settings;

const COULOMB3: CoreStructure<3, 6, 2> = with_friction();

/// Words of 8 bytes of a `trendid_servo2`.
pub const SERVO2_WORDS: usize = 168;

/// Memory of an identifier of `b0 / (s (s + a1))`.
///
/// theta = (a1, b0, constant, initial state); inputs: u.
#[repr(C)]
pub struct Servo2 {
    words: [u64; SERVO2_WORDS],
}

/// Makes an identifier of the kind `trendid_servo2`; `detail`, if not NULL, says which setting was
/// refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_servo2_init(
    memory: *mut Servo2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfServo2| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, CoreStructure::<2, 4, 1>::SERVO, [Some(0)], 1, 1)
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_servo3`.
pub const SERVO3_WORDS: usize = 196;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1))`.
///
/// theta = (a1, a2, b0, constant, initial state); inputs: u.
#[repr(C)]
pub struct Servo3 {
    words: [u64; SERVO3_WORDS],
}

/// Makes an identifier of the kind `trendid_servo3`; `detail`, if not NULL, says which setting was
/// refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_servo3_init(
    memory: *mut Servo3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfServo3| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, CoreStructure::<3, 5, 1>::SERVO, [Some(0)], 1, 1)
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_coulomb2`.
pub const COULOMB2_WORDS: usize = 192;

/// Memory of an identifier of `b0 / (s (s + a1)) with Coulomb friction`.
///
/// theta = (a1, b0, b0 of the sign of v, constant, initial state); inputs: u, sign of v.
#[repr(C)]
pub struct Coulomb2 {
    words: [u64; COULOMB2_WORDS],
}

/// Makes an identifier of the kind `trendid_coulomb2`; `detail`, if not NULL, says which setting
/// was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_coulomb2_init(
    memory: *mut Coulomb2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfCoulomb2| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(
            settings,
            CoreStructure::<2, 5, 2>::SERVO,
            [Some(0), Some(1)],
            2,
            1,
        )
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_coulomb3`.
pub const COULOMB3_WORDS: usize = 228;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) with Coulomb friction`.
///
/// theta = (a1, a2, b0, b1 of the sign of v, constant, initial state); inputs: u, sign of v.
#[repr(C)]
pub struct Coulomb3 {
    words: [u64; COULOMB3_WORDS],
}

/// Makes an identifier of the kind `trendid_coulomb3`; `detail`, if not NULL, says which setting
/// was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_coulomb3_init(
    memory: *mut Coulomb3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfCoulomb3| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, COULOMB3, [Some(0), Some(1)], 2, 1)
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}
