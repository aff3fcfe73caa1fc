//! The kinds of identifiers behind one table of functions.

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::Identifier;
use crate::identifier::kind::Kind;
use crate::identifier::outputs::{Estimate, Outcome, Parameter, Pole, Status};
use crate::identifier::recursion::{Change, Recursion};
use crate::memory::{Inside, Object, blank, check, make, object, wanted, write, write_if_wanted};

/// What every handle can do. The functions take a handle of the kind that the table belongs to.
pub(crate) struct Methods {
    pub update: unsafe fn(*mut Identifier, f32, f32, *mut Outcome) -> Error,
    pub update_inputs: unsafe fn(*mut Identifier, &[f32], f32, *mut Outcome) -> Error,
    pub change: unsafe fn(*mut Identifier, Change<'_>) -> Result<(), Detail>,
    pub theta: unsafe fn(*const Identifier, &mut [f32]) -> Result<(), Error>,
    pub estimate: unsafe fn(*const Identifier, *mut Estimate) -> Result<(), Error>,
    pub covariance: unsafe fn(*const Identifier, &mut [f32]) -> Result<(), Error>,
    pub parameters: unsafe fn(*const Identifier, &mut [Parameter]) -> Result<(), Error>,
    pub poles: unsafe fn(*const Identifier, &mut [Pole]) -> Result<(), Error>,
    pub status: unsafe fn(*const Identifier, *mut Status) -> Result<(), Error>,
}

/// What the object of an identifier holds, whatever its kind.
#[repr(C)]
pub(crate) struct Head {
    methods: &'static Methods,
}

impl Inside for Head {
    const MAGIC: u32 = 0x1D1D_1D1D;
}

/// What the object of an identifier of this kind holds.
#[repr(C)]
pub(crate) struct Body<K> {
    methods: &'static Methods,
    pub(crate) kind: K,
}

impl<K> Inside for Body<K> {
    const MAGIC: u32 = Head::MAGIC;
}

/// The table of an initialised identifier.
///
/// # Safety
/// The handle is NULL, or points to the memory of an identifier that nobody writes meanwhile.
#[inline(always)]
pub(crate) unsafe fn methods(identifier: *const Identifier) -> Result<&'static Methods, Error> {
    // SAFETY: the object of every kind begins with a `Head`.
    unsafe { object(identifier.cast::<Object<Head>>()) }.map(|head| head.methods)
}

/// Makes an identifier in memory of the caller; `configure` gets a kind without meaning and makes
/// all of it, or fails.
///
/// # Safety
/// As [`make`]; `handle` is NULL or points to a handle.
pub(crate) unsafe fn begin<W, K: Kind>(
    memory: *mut W,
    configure: impl FnOnce(&mut K) -> Result<(), Detail>,
    handle: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    const {
        // The handle finds word and table at one place, whatever the kind.
        assert!(align_of::<Body<K>>() == align_of::<Head>());
    }
    let fill = |body: *mut Body<K>| {
        wanted(handle)?;
        // SAFETY: memory for a body, by the contract of `make`.
        unsafe {
            configure(blank(&raw mut (*body).kind))?;
            (&raw mut (*body).methods).write(Table::<K>::METHODS);
        }
        Ok(())
    };
    // SAFETY: by the contract of this function; a body has no other fields.
    let done = unsafe { make(memory, fill, detail) };
    if done == Error::Ok {
        // SAFETY: by the contract of this function.
        unsafe { write_if_wanted(handle, memory.cast()) };
    }
    done
}

/// The kind behind a handle of this kind, which [`methods`] has checked.
///
/// # Safety
/// The handle points to an initialised identifier of the kind `K` that nobody writes meanwhile.
#[inline(always)]
unsafe fn kind<'a, K: 'a>(identifier: *const Identifier) -> &'a K {
    // SAFETY: by the contract of this function.
    unsafe { &(*identifier.cast::<Object<Body<K>>>()).inside.kind }
}

/// As [`kind`], to be changed.
///
/// # Safety
/// As [`kind`], and nobody else uses the identifier.
#[inline(always)]
unsafe fn kind_mut<'a, K: 'a>(identifier: *mut Identifier) -> &'a mut K {
    // SAFETY: by the contract of this function.
    unsafe { &mut (*identifier.cast::<Object<Body<K>>>()).inside.kind }
}

/// The functions of a kind. Each takes a handle that was found initialised, of its own kind.
struct Table<K>(core::marker::PhantomData<K>);

impl<K: Kind> Table<K> {
    const METHODS: &'static Methods = &Methods {
        update: Self::update,
        update_inputs: Self::update_inputs,
        change: Self::change,
        theta: Self::theta,
        estimate: Self::estimate,
        covariance: Self::covariance,
        parameters: Self::parameters,
        poles: Self::poles,
        status: Self::status,
    };

    /// The update itself stands in one of the next two, the other one calls it.
    unsafe fn update(identifier: *mut Identifier, u: f32, y: f32, outcome: *mut Outcome) -> Error {
        if K::SINGLE {
            // SAFETY: the contract of this function.
            unsafe { Self::sample(identifier, &[u], y, outcome) }
        } else {
            // SAFETY: the contract of this function.
            unsafe { Self::update_inputs(identifier, &[u], y, outcome) }
        }
    }

    unsafe fn update_inputs(
        identifier: *mut Identifier,
        u: &[f32],
        y: f32,
        outcome: *mut Outcome,
    ) -> Error {
        match u {
            // SAFETY: the contract of this function.
            [u] if K::SINGLE => unsafe { Self::update(identifier, *u, y, outcome) },
            _ if K::SINGLE => Error::Length,
            // SAFETY: the contract of this function.
            _ => unsafe { Self::sample(identifier, u, y, outcome) },
        }
    }

    #[inline(always)]
    unsafe fn sample(
        identifier: *mut Identifier,
        u: &[f32],
        y: f32,
        outcome: *mut Outcome,
    ) -> Error {
        if let Err(error) = wanted(outcome) {
            return error;
        }
        // SAFETY: the handle is initialised and of this kind, and nobody else uses it.
        let kind = unsafe { kind_mut::<K>(identifier) };
        match kind.update(u, y) {
            None => Error::Length,
            Some(done) => {
                // SAFETY: NULL, or memory of the caller for an outcome.
                unsafe { write_if_wanted(outcome.cast(), Outcome::from(done).words()) };
                Error::Ok
            }
        }
    }

    unsafe fn change(identifier: *mut Identifier, change: Change<'_>) -> Result<(), Detail> {
        // SAFETY: the handle is of this kind and nobody else uses it.
        unsafe { kind_mut::<K>(identifier) }
            .core_mut()
            .change(change)
    }

    unsafe fn theta(identifier: *const Identifier, theta: &mut [f32]) -> Result<(), Error> {
        // SAFETY: the handle is of this kind and nobody writes it.
        unsafe { kind::<K>(identifier) }.core().theta(theta)
    }

    unsafe fn estimate(identifier: *const Identifier, to: *mut Estimate) -> Result<(), Error> {
        // SAFETY: the handle is of this kind and nobody writes it.
        let kind = unsafe { kind::<K>(identifier) };
        // Before it is made: then it is made where it is to stand.
        check(to)?;
        // SAFETY: checked, and by the contract memory of the caller for an estimate, which is made
        // before it is changed.
        unsafe {
            kind.core().estimate(&mut *to.cast());
            (*to).inputs = kind.inputs() as u8;
        }
        Ok(())
    }

    unsafe fn covariance(identifier: *const Identifier, to: &mut [f32]) -> Result<(), Error> {
        // SAFETY: the handle is of this kind and nobody writes it.
        unsafe { kind::<K>(identifier) }.core().covariance(to)
    }

    unsafe fn parameters(identifier: *const Identifier, to: &mut [Parameter]) -> Result<(), Error> {
        // SAFETY: the handle is of this kind and nobody writes it.
        unsafe { kind::<K>(identifier) }.core().parameters(to)
    }

    unsafe fn poles(identifier: *const Identifier, to: &mut [Pole]) -> Result<(), Error> {
        // SAFETY: the handle is of this kind and nobody writes it.
        unsafe { kind::<K>(identifier) }.core().poles(to)
    }

    unsafe fn status(identifier: *const Identifier, to: *mut Status) -> Result<(), Error> {
        // SAFETY: the handle is of this kind and nobody writes it.
        let kind = unsafe { kind::<K>(identifier) };
        // SAFETY: NULL, or memory of the caller for a status.
        unsafe { write(to, kind.core().status()) }
    }
}
