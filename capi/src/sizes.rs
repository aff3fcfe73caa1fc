//! Bytes of the objects, for a program that compares them with its header.

use crate::bank::{Bank, DelayBank};
use crate::detail::Detail;
use crate::friction::FRICTION_SIZES;
use crate::identifier::{Estimate, INSTRUMENTED_SIZES, Outcome, Parameter, Pole, SIZES, Status};
use crate::memory::Object;
use crate::servo::{Body, Loop, LoopSettings, Model, Quality, Report};
use crate::settings::{Settings, Structure};

/// The types of memory.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjectKind {
    /// `trendid_servo2`
    Servo2 = 0,
    /// `trendid_servo3`
    Servo3 = 1,
    /// `trendid_valve2`
    Valve2 = 2,
    /// `trendid_valve3`
    Valve3 = 3,
    /// `trendid_coulomb2`
    Coulomb2 = 4,
    /// `trendid_coulomb3`
    Coulomb3 = 5,
    /// `trendid_valve_coulomb2`
    ValveCoulomb2 = 6,
    /// `trendid_valve_coulomb3`
    ValveCoulomb3 = 7,
    /// `trendid_any`
    Any = 8,
    /// `trendid_delay_bank`
    DelayBank = 9,
    /// `trendid_loop`
    Loop = 10,
    /// `trendid_instrumented2`
    Instrumented2 = 11,
    /// `trendid_instrumented3`
    Instrumented3 = 12,
    /// `trendid_friction`
    Friction = 13,
}

// The other half of these stands in the header, for the compiler of the caller.
const _: () = {
    assert!(size_of::<Detail>() == 56);
    assert!(size_of::<Settings>() == 148);
    assert!(size_of::<Structure>() == 7);
    assert!(size_of::<Outcome>() == 12);
    assert!(size_of::<Parameter>() == 3);
    assert!(size_of::<Pole>() == 8);
    assert!(size_of::<Estimate>() == 180);
    assert!(size_of::<Status>() == 44);
    assert!(size_of::<LoopSettings>() == 100);
    assert!(size_of::<Report>() == 52);
    assert!(size_of::<Quality>() == 56);
    assert!(size_of::<Model>() == 24);
};

/// Bytes of each type of memory, and how many of them this build uses.
fn sizes(kind: i32) -> [usize; 2] {
    let others = [
        [size_of::<DelayBank>(), size_of::<Object<Bank>>()],
        [size_of::<Loop>(), size_of::<Object<Body>>()],
    ];
    let found = SIZES
        .iter()
        .chain(&others)
        .chain(&INSTRUMENTED_SIZES)
        .chain([&FRICTION_SIZES])
        .zip(0..)
        .find(|(_, number)| *number == kind);
    found.map_or([0; 2], |(sizes, _)| *sizes)
}

/// Bytes of a type of memory, a `trendid_object_kind`, as the library was built: `sizeof` must say
/// the same. 0 of another number.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_object_size(kind: i32) -> usize {
    sizes(kind)[0]
}

/// Bytes of a type of memory that this build of the library uses; the rest is room for later
/// versions.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_object_used(kind: i32) -> usize {
    sizes(kind)[1]
}
