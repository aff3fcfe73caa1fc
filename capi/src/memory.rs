//! The edge of what is safe: pointers of the caller become references here, after their checks.
//!
//! A pointer is NULL or points to memory of its type, as the header asks of the caller. What can be
//! checked beyond that is: NULL, the alignment, and of an object the word that `_init` has left in
//! it.

use core::mem::MaybeUninit;

use crate::detail::Detail;
use crate::error::Error;

/// Most elements of a list of the caller; no list of the interface is longer.
const LONGEST: usize = 4096;

/// What an object begins with, behind the word that says that it is one.
#[repr(C)]
pub(crate) struct Object<T> {
    magic: u32,
    pub(crate) inside: T,
}

/// What is kept in an object.
pub(crate) trait Inside {
    /// The word of this type of object: four equal bytes, which a Thumb instruction can hold.
    const MAGIC: u32;
}

/// The error, out of the way of a sample: a branch that is not taken in the place of instructions
/// that are skipped.
#[cold]
#[inline(never)]
fn refused(error: Error) -> Error {
    error
}

/// An error unless the pointer may point to a `T`.
#[inline(always)]
pub(crate) fn check<T>(pointer: *const T) -> Result<(), Error> {
    if pointer.is_null() {
        Err(refused(Error::Null))
    } else if !pointer.is_aligned() {
        Err(refused(Error::Misaligned))
    } else {
        Ok(())
    }
}

/// The value behind a pointer.
///
/// # Safety
/// The pointer is NULL, or points to an initialised `T` that nobody writes during `'a`.
#[inline(always)]
pub(crate) unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, Error> {
    check(pointer)?;
    // SAFETY: not NULL, aligned, and by the contract valid.
    Ok(unsafe { &*pointer })
}

/// Writes a value behind a pointer that must not be NULL.
///
/// # Safety
/// The pointer is NULL, or points to memory for a `T` that nobody else uses.
#[inline(always)]
pub(crate) unsafe fn write<T>(pointer: *mut T, value: T) -> Result<(), Error> {
    check(pointer)?;
    // SAFETY: not NULL, aligned, and by the contract memory for a `T`.
    unsafe { pointer.write(value) };
    Ok(())
}

/// An error unless a pointer that may be NULL for nothing is aligned; asked before anything is
/// done.
#[inline(always)]
pub(crate) fn wanted<T>(pointer: *const T) -> Result<(), Error> {
    // NULL is aligned.
    if pointer.is_aligned() {
        Ok(())
    } else {
        Err(refused(Error::Misaligned))
    }
}

/// As [`write`], of a pointer that may be NULL for nothing.
///
/// # Safety
/// As [`write`].
#[inline(always)]
pub(crate) unsafe fn write_if_wanted<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() && pointer.is_aligned() {
        // SAFETY: as in [`write`].
        unsafe { pointer.write(value) };
    }
}

/// A list of the caller.
///
/// # Safety
/// The pointer is NULL, or points to `length` initialised elements that nobody writes during `'a`.
#[inline(always)]
pub(crate) unsafe fn list<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Error> {
    check(pointer)?;
    if length > LONGEST {
        return Err(Error::Length);
    }
    // SAFETY: not NULL, aligned, by the contract that long, and far below the largest size.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// A list of the caller to write to.
///
/// # Safety
/// The pointer is NULL, or points to `length` initialised elements that nobody else uses during
/// `'a`.
#[inline(always)]
pub(crate) unsafe fn list_mut<'a, T>(pointer: *mut T, length: usize) -> Result<&'a mut [T], Error> {
    check(pointer)?;
    if length > LONGEST {
        return Err(Error::Length);
    }
    // SAFETY: not NULL, aligned, by the contract that long, and far below the largest size.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, length) })
}

/// What is kept in the object behind a pointer.
///
/// # Safety
/// The pointer is NULL, or points to the memory of an object of this type that nobody writes during
/// `'a`.
#[inline(always)]
pub(crate) unsafe fn object<'a, T: Inside>(pointer: *const Object<T>) -> Result<&'a T, Error> {
    check(pointer)?;
    // SAFETY: not NULL, aligned; the word lies in the caller's memory and every value of it is a
    // u32.
    if unsafe { (&raw const (*pointer).magic).read() } != T::MAGIC {
        return Err(refused(Error::NotInitialised));
    }
    // SAFETY: as above, and the word says that an object was written here.
    Ok(unsafe { &(*pointer).inside })
}

/// As [`object`], to be changed.
///
/// # Safety
/// The pointer is NULL, or points to the memory of an object of this type that nobody else uses
/// during `'a`.
#[inline(always)]
pub(crate) unsafe fn object_mut<'a, T: Inside>(
    pointer: *mut Object<T>,
) -> Result<&'a mut T, Error> {
    check(pointer)?;
    // SAFETY: not NULL, aligned; the word lies in the caller's memory and every value of it is a
    // u32.
    if unsafe { (&raw const (*pointer).magic).read() } != T::MAGIC {
        return Err(refused(Error::NotInitialised));
    }
    // SAFETY: as above, and the word says that an object was written here.
    Ok(unsafe { &mut (*pointer).inside })
}

/// What a `T` is before it is configured: bytes that are all zero, a value without meaning. The
/// compiler checks that they are a value: a constant that is none does not compile, be it by a
/// reference, an enumeration without 0 or what contains one.
trait Blank: Sized {
    // SAFETY: the value of a constant is validated, to its last field.
    const BLANK: Self = unsafe { MaybeUninit::zeroed().assume_init() };
}

impl<T> Blank for T {}

/// Memory of the caller as a `T` to be configured in place: a copy on the stack of a
/// microcontroller would be a large one.
///
/// # Safety
/// The pointer is aligned and points to memory for a `T` that nobody else uses during `'a`.
#[inline(always)]
pub(crate) unsafe fn blank<'a, T>(place: *mut T) -> &'a mut T {
    const { core::mem::forget(<T as Blank>::BLANK) }
    // SAFETY: by the contract of this function; zeros are a `T` by the line above.
    unsafe {
        place.write_bytes(0, 1);
        &mut *place
    }
}

/// Makes an object in memory of the caller that holds at least a `T`; the answer of `_init`.
///
/// `fill` makes all of the `T` or fails, where the object is to stand. The word that says that it
/// is one comes last; what was there before is none from the begin.
///
/// # Safety
/// `memory` is NULL or points to a `W` that nobody else uses; `detail` is NULL or points to a
/// [`Detail`]. Where `fill` succeeds, its pointer, which is aligned and may be written, points to
/// an initialised `T`.
#[inline(always)]
pub(crate) unsafe fn make<W, T: Inside>(
    memory: *mut W,
    fill: impl FnOnce(*mut T) -> Result<(), Detail>,
    detail: *mut Detail,
) -> Error {
    const {
        assert!(
            size_of::<Object<T>>() <= size_of::<W>(),
            "the object has outgrown its words"
        );
        assert!(align_of::<Object<T>>() <= align_of::<W>());
    }
    let pointers = check(memory).and_then(|()| wanted(detail));
    let done = pointers.map_err(Detail::from).and_then(|()| {
        let object = memory.cast::<Object<T>>();
        // SAFETY: not NULL, aligned for `W` and so for the object, and by the assertion above large
        // enough.
        let inside = unsafe {
            (&raw mut (*object).magic).write(0);
            &raw mut (*object).inside
        };
        fill(inside)?;
        // SAFETY: as above.
        unsafe { (&raw mut (*object).magic).write(T::MAGIC) };
        Ok(())
    });
    // SAFETY: by the contract of this function.
    unsafe { tell(done, detail) }
}

/// The code of a result; what is wrong in `detail`.
///
/// # Safety
/// `detail` is NULL or points to a [`Detail`].
pub(crate) unsafe fn tell(done: Result<(), Detail>, detail: *mut Detail) -> Error {
    let told = match done {
        Ok(()) => Detail::of(Error::Ok),
        Err(told) => told,
    };
    // SAFETY: by the contract of this function.
    unsafe { write_if_wanted(detail, told) };
    told.error
}
