//! The kinds of memory, and how an identifier begins in each.
//!
//! Long because cbindgen reads types and functions as they stand and does not see through a macro.

use trendid::Structure as CoreStructure;
use trendid::estimation::Terms;
use trendid::inputs::DeadZone;

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::Identifier;
use crate::identifier::body::{Body, begin};
use crate::identifier::kind::{Plain, Valve};
use crate::identifier::recursion::Filtered;
use crate::memory::Object;
use crate::settings::{INPUTS_MAX, Settings};

/// Longest delay of an input in samples.
pub const DELAY_MAX: usize = 7;

/// Longest delay of an input of a `trendid_any` in samples.
pub const ANY_DELAY_MAX: usize = 64;

/// Most parameters of a `trendid_any`.
pub const ANY_PARAMETERS_MAX: usize = 6;

/// Order 3 with Coulomb friction as the last input: it acts on the acceleration, one integration behind the valve.
const fn with_friction<const N: usize, const I: usize>() -> CoreStructure<3, N, I> {
    let mut inputs = [Terms::of(&[0]); I];
    inputs[I - 1] = Terms::of(&[1]);
    match CoreStructure::try_with_initial_state(Terms::between(1, 3), inputs, true) {
        Ok(structure) => structure,
        Err(_) => panic!("the sizes contradict the terms"),
    }
}

const COULOMB3: CoreStructure<3, 6, 2> = with_friction();
const VALVE_COULOMB3: CoreStructure<3, 7, 3> = with_friction();

/// A kind whose inputs are those of the caller.
fn plain<const M: usize, const N: usize, const I: usize>(
    settings: &Settings,
    structure: CoreStructure<M, N, I>,
    own: [Option<usize>; I],
) -> Result<Plain<M, N, I, DELAY_MAX>, Detail> {
    let config = settings.config(structure, own);
    let identifier = Filtered::try_new(&config, settings.trends()?)?;
    Ok(Plain {
        identifier,
        given: I,
    })
}

/// A kind with a dead zone.
fn valve<const M: usize, const N: usize, const I: usize>(
    settings: &Settings,
    structure: CoreStructure<M, N, I>,
    own: [Option<usize>; I],
) -> Result<Valve<M, N, I, DELAY_MAX>, Detail> {
    let &Settings {
        dead_zone_max,
        dead_zone_block,
        ..
    } = settings;
    if !(dead_zone_max > 0.0 && dead_zone_max.is_finite()) {
        return Err(Detail::not_positive("dead_zone_max", dead_zone_max));
    }
    if dead_zone_block == 0 {
        return Err(Detail::not_positive("dead_zone_block", 0.0));
    }
    let config = settings.config(structure, own);
    let identifier = Filtered::try_new(&config, settings.trends()?)?;
    let unknown = DeadZone::new(0.0, dead_zone_max, dead_zone_block);
    Ok(Valve {
        identifier,
        dead_zone: unknown,
        unknown,
    })
}

/// The settings behind a pointer.
///
/// # Safety
/// The pointer is NULL, or points to settings that nobody writes during `'a`.
pub(super) unsafe fn of<'a>(settings: *const Settings) -> Result<&'a Settings, Detail> {
    // SAFETY: by the contract of this function.
    unsafe { crate::memory::shared(settings) }.map_err(Detail::from)
}

/// Words of 8 bytes of a `trendid_servo2`.
pub const SERVO2_WORDS: usize = 136;

/// Memory of an identifier of `b0 / (s (s + a1))`.
///
/// theta = (a1, b0, constant, initial state); inputs: u.
#[repr(C)]
pub struct Servo2 {
    words: [u64; SERVO2_WORDS],
}

/// Makes an identifier of the kind `trendid_servo2`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_servo2_init(
    memory: *mut Servo2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        plain(settings, CoreStructure::<2, 4, 1>::SERVO, [Some(0)])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_servo3`.
pub const SERVO3_WORDS: usize = 160;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1))`.
///
/// theta = (a1, a2, b0, constant, initial state); inputs: u.
#[repr(C)]
pub struct Servo3 {
    words: [u64; SERVO3_WORDS],
}

/// Makes an identifier of the kind `trendid_servo3`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_servo3_init(
    memory: *mut Servo3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        plain(settings, CoreStructure::<3, 5, 1>::SERVO, [Some(0)])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve2`.
pub const VALVE2_WORDS: usize = 164;

/// Memory of an identifier of `b0 / (s (s + a1)) behind a valve with a dead zone`.
///
/// theta = (a1, b0, b0 of the sign of u, constant, initial state); inputs: u.
#[repr(C)]
pub struct Valve2 {
    words: [u64; VALVE2_WORDS],
}

/// Makes an identifier of the kind `trendid_valve2`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve2_init(
    memory: *mut Valve2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        valve(settings, CoreStructure::<2, 5, 2>::SERVO, [Some(0), None])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve3`.
pub const VALVE3_WORDS: usize = 192;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) behind a valve with a dead zone`.
///
/// theta = (a1, a2, b0, b0 of the sign of u, constant, initial state); inputs: u.
#[repr(C)]
pub struct Valve3 {
    words: [u64; VALVE3_WORDS],
}

/// Makes an identifier of the kind `trendid_valve3`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve3_init(
    memory: *mut Valve3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        valve(settings, CoreStructure::<3, 6, 2>::SERVO, [Some(0), None])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_coulomb2`.
pub const COULOMB2_WORDS: usize = 160;

/// Memory of an identifier of `b0 / (s (s + a1)) with Coulomb friction`.
///
/// theta = (a1, b0, b0 of the sign of v, constant, initial state); inputs: u, sign of v.
#[repr(C)]
pub struct Coulomb2 {
    words: [u64; COULOMB2_WORDS],
}

/// Makes an identifier of the kind `trendid_coulomb2`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_coulomb2_init(
    memory: *mut Coulomb2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        plain(
            settings,
            CoreStructure::<2, 5, 2>::SERVO,
            [Some(0), Some(1)],
        )
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_coulomb3`.
pub const COULOMB3_WORDS: usize = 184;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) with Coulomb friction`.
///
/// theta = (a1, a2, b0, b1 of the sign of v, constant, initial state); inputs: u, sign of v.
#[repr(C)]
pub struct Coulomb3 {
    words: [u64; COULOMB3_WORDS],
}

/// Makes an identifier of the kind `trendid_coulomb3`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_coulomb3_init(
    memory: *mut Coulomb3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        plain(settings, COULOMB3, [Some(0), Some(1)])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve_coulomb2`.
pub const VALVE_COULOMB2_WORDS: usize = 188;

/// Memory of an identifier of `b0 / (s (s + a1)) with Coulomb friction, behind a valve with a dead zone`.
///
/// theta = (a1, b0, b0 of the sign of u, b0 of the sign of v, constant, initial state); inputs: u, sign of v.
#[repr(C)]
pub struct ValveCoulomb2 {
    words: [u64; VALVE_COULOMB2_WORDS],
}

/// Makes an identifier of the kind `trendid_valve_coulomb2`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve_coulomb2_init(
    memory: *mut ValveCoulomb2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        valve(
            settings,
            CoreStructure::<2, 6, 3>::SERVO,
            [Some(0), None, Some(1)],
        )
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_valve_coulomb3`.
pub const VALVE_COULOMB3_WORDS: usize = 216;

/// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) with Coulomb friction, behind a valve with a dead zone`.
///
/// theta = (a1, a2, b0, b0 of the sign of u, b1 of the sign of v, constant, initial state); inputs: u, sign of v.
#[repr(C)]
pub struct ValveCoulomb3 {
    words: [u64; VALVE_COULOMB3_WORDS],
}

/// Makes an identifier of the kind `trendid_valve_coulomb3`; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_valve_coulomb3_init(
    memory: *mut ValveCoulomb3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let kind = || {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        valve(settings, VALVE_COULOMB3, [Some(0), None, Some(1)])
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, kind, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_any`.
pub const ANY_WORDS: usize = 264;

/// Memory of an identifier of any structure: order 1 to 4, one or two inputs, up to `TRENDID_ANY_PARAMETERS_MAX`
/// parameters.
///
/// For hosts: a program that initialises one links the code of every structure. Archives for microcontrollers are built without
/// `trendid_any_init`.
#[repr(C)]
pub struct Any {
    words: [u64; ANY_WORDS],
}

/// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero and for NaN.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_sign_of_velocity(velocity: f32, rest: f32) -> f32 {
    trendid::inputs::coulomb(velocity, rest)
}

/// Puts an identifier of the core into memory of the caller.
///
/// # Safety
/// As [`begin`].
pub(crate) unsafe fn begin_plain(
    memory: *mut Servo3,
    identifier: impl FnOnce() -> Result<Filtered<3, 5, 1, DELAY_MAX>, Detail>,
    handle: *mut *mut Identifier,
) -> Error {
    let kind = || {
        Ok(Plain {
            identifier: identifier()?,
            given: 1,
        })
    };
    // SAFETY: by the contract of this function.
    unsafe { begin(memory, kind, handle, core::ptr::null_mut()) }
}

type OfServo2 = Plain<2, 4, 1, DELAY_MAX>;
type OfServo3 = Plain<3, 5, 1, DELAY_MAX>;
type OfValve2 = Valve<2, 5, 2, DELAY_MAX>;
type OfValve3 = Valve<3, 6, 2, DELAY_MAX>;
type OfCoulomb2 = Plain<2, 5, 2, DELAY_MAX>;
type OfCoulomb3 = Plain<3, 6, 2, DELAY_MAX>;
type OfValveCoulomb2 = Valve<2, 6, 3, DELAY_MAX>;
type OfValveCoulomb3 = Valve<3, 7, 3, DELAY_MAX>;
type LargestAny = Plain<4, 6, INPUTS_MAX, ANY_DELAY_MAX>;

/// Bytes of the memory of each kind, and how many of them this build uses.
pub(crate) const SIZES: [[usize; 2]; 9] = [
    sizes::<Servo2, OfServo2>(),
    sizes::<Servo3, OfServo3>(),
    sizes::<Valve2, OfValve2>(),
    sizes::<Valve3, OfValve3>(),
    sizes::<Coulomb2, OfCoulomb2>(),
    sizes::<Coulomb3, OfCoulomb3>(),
    sizes::<ValveCoulomb2, OfValveCoulomb2>(),
    sizes::<ValveCoulomb3, OfValveCoulomb3>(),
    sizes::<Any, LargestAny>(),
];

const fn sizes<W, K>() -> [usize; 2] {
    [size_of::<W>(), size_of::<Object<Body<K>>>()]
}
