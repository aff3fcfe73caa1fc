//! The kinds of memory, and how an identifier begins in each.

mod instrumented;
mod plain;
mod valve;

pub use instrumented::*;
pub use plain::*;
pub use valve::*;

use trendid::Structure as CoreStructure;
use trendid::estimation::Terms;
use trendid::instruments::rows;

use crate::detail::Detail;
use crate::identifier::body::Body;
use crate::identifier::instrumented::{Instrumented, SERVO2, SERVO3};
use crate::identifier::kind::{Plain, Valve};
use crate::memory::Object;
use crate::settings::{INPUTS_MAX, Settings};

/// Longest delay of an input in samples.
pub const DELAY_MAX: usize = 7;

/// Longest delay of an input of a `trendid_any` in samples.
pub const ANY_DELAY_MAX: usize = 64;

/// Most parameters of a `trendid_any`.
pub const ANY_PARAMETERS_MAX: usize = 6;

/// Order 3 with Coulomb friction as the last input: it acts on the acceleration, one integration
/// behind the valve.
const fn with_friction<const N: usize, const I: usize>() -> CoreStructure<3, N, I> {
    let mut inputs = [Terms::of(&[0]); I];
    inputs[I - 1] = Terms::of(&[1]);
    match CoreStructure::try_with_initial_state(Terms::between(1, 3), inputs, true) {
        Ok(structure) => structure,
        Err(_) => panic!("the sizes contradict the terms"),
    }
}

/// The settings behind a pointer.
///
/// # Safety
/// The pointer is NULL, or points to settings that nobody writes during `'a`.
pub(super) unsafe fn of<'a>(settings: *const Settings) -> Result<&'a Settings, Detail> {
    // SAFETY: by the contract of this function.
    unsafe { crate::memory::shared(settings) }.map_err(Detail::from)
}

/// Words of 8 bytes of a `trendid_any`.
pub const ANY_WORDS: usize = 300;

/// Memory of an identifier of any structure: order 1 to 4, one or two inputs, up to
/// `TRENDID_ANY_PARAMETERS_MAX` parameters.
///
/// For hosts: a program that initialises one links the code of every structure. Archives for
/// microcontrollers are built without `trendid_any_init`.
#[repr(C)]
pub struct Any {
    words: [u64; ANY_WORDS],
}

/// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero and for NaN.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_sign_of_velocity(velocity: f32, rest: f32) -> f32 {
    trendid::inputs::coulomb(velocity, rest)
}

type OfServo2 = Plain<2, 4, 1, DELAY_MAX>;
pub(crate) type OfServo3 = Plain<3, 5, 1, DELAY_MAX>;
type OfValve2 = Valve<2, 5, 2, DELAY_MAX>;
type OfValve3 = Valve<3, 6, 2, DELAY_MAX>;
type OfCoulomb2 = Plain<2, 5, 2, DELAY_MAX>;
type OfCoulomb3 = Plain<3, 6, 2, DELAY_MAX>;
type OfValveCoulomb2 = Valve<2, 6, 3, DELAY_MAX>;
type OfValveCoulomb3 = Valve<3, 7, 3, DELAY_MAX>;
type OfInstrumented2 = Instrumented<2, 4, { rows(&SERVO2) }, DELAY_MAX>;
type OfInstrumented3 = Instrumented<3, 5, { rows(&SERVO3) }, DELAY_MAX>;
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

/// The same of those with instruments.
pub(crate) const INSTRUMENTED_SIZES: [[usize; 2]; 2] = [
    sizes::<Instrumented2, OfInstrumented2>(),
    sizes::<Instrumented3, OfInstrumented3>(),
];

const fn sizes<W, K>() -> [usize; 2] {
    [size_of::<W>(), size_of::<Object<Body<K>>>()]
}
