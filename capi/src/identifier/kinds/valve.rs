//! A first input through a valve whose dead zone is found: drives of order 2 and 3, with Coulomb
//! friction or without.
//!
//! One after another, as those of `plain`.

use trendid::Structure as CoreStructure;

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::Identifier;
use crate::identifier::body::begin;
use crate::identifier::kinds::{
    OfValve2, OfValve3, OfValveCoulomb2, OfValveCoulomb3, of, with_friction,
};
use crate::settings::Settings;

const VALVE_COULOMB3: CoreStructure<3, 7, 3> = with_friction();

/// Words of 8 bytes of a `trendid_valve2`.
pub const VALVE2_WORDS: usize = 216;

/// Memory of an identifier of `b0 / (s (s + a1)) behind a valve with a dead zone`.
///
/// theta = (a1, b0, b0 of the sign of u, constant, initial state); inputs: u.
#[repr(C)]
pub struct Valve2 {
    words: [u64; VALVE2_WORDS],
}

/// Makes an identifier of the kind `trendid_valve2`; `detail`, if not NULL, says which setting was
/// refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve2_init(
    memory: *mut Valve2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfValve2| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, CoreStructure::<2, 5, 2>::SERVO, [Some(0), None])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve3`.
pub const VALVE3_WORDS: usize = 248;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) behind a valve with a dead zone`.
///
/// theta = (a1, a2, b0, b0 of the sign of u, constant, initial state); inputs: u.
#[repr(C)]
pub struct Valve3 {
    words: [u64; VALVE3_WORDS],
}

/// Makes an identifier of the kind `trendid_valve3`; `detail`, if not NULL, says which setting was
/// refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve3_init(
    memory: *mut Valve3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfValve3| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, CoreStructure::<3, 6, 2>::SERVO, [Some(0), None])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve_coulomb2`.
pub const VALVE_COULOMB2_WORDS: usize = 244;

/// Memory of an identifier of
/// `b0 / (s (s + a1)) with Coulomb friction, behind a valve with a dead zone`.
///
/// theta = (a1, b0, b0 of the sign of u, b0 of the sign of v, constant, initial state); inputs: u,
/// sign of v.
#[repr(C)]
pub struct ValveCoulomb2 {
    words: [u64; VALVE_COULOMB2_WORDS],
}

/// Makes an identifier of the kind `trendid_valve_coulomb2`; `detail`, if not NULL, says which
/// setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve_coulomb2_init(
    memory: *mut ValveCoulomb2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfValveCoulomb2| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(
            settings,
            CoreStructure::<2, 6, 3>::SERVO,
            [Some(0), None, Some(1)],
        )
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve_coulomb3`.
pub const VALVE_COULOMB3_WORDS: usize = 276;

/// Memory of an identifier of
/// `b0 / (s (s^2 + a2 s + a1)) with Coulomb friction, behind a valve with a dead zone`.
///
/// theta = (a1, a2, b0, b0 of the sign of u, b1 of the sign of v, constant, initial state); inputs:
/// u, sign of v.
#[repr(C)]
pub struct ValveCoulomb3 {
    words: [u64; VALVE_COULOMB3_WORDS],
}

/// Makes an identifier of the kind `trendid_valve_coulomb3`; `detail`, if not NULL, says which
/// setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve_coulomb3_init(
    memory: *mut ValveCoulomb3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfValveCoulomb3| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, VALVE_COULOMB3, [Some(0), None, Some(1)])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}
