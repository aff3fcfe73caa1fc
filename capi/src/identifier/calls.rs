//! What can be asked of an identifier of any kind.

use crate::detail::Detail;
use crate::error::{Error, code};
use crate::identifier::Identifier;
use crate::identifier::body::{Methods, methods};
use crate::identifier::outputs::{Estimate, Outcome, Parameter, Pole, Status};
use crate::identifier::recursion::Change;
use crate::memory::{list, list_mut, wanted};

/// Takes the command u, in force from now until the next sample, and the position y, for a kind
/// with one input.
///
/// For the interrupt of the sample. `outcome` may be NULL. A number that is not finite is refused
/// by `outcome`, not by the code.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_update(
    identifier: *mut Identifier,
    u: f32,
    y: f32,
    outcome: *mut Outcome,
) -> Error {
    // SAFETY: by the contract of the header.
    match unsafe { methods(identifier) } {
        // SAFETY: the table belongs to the kind of the handle; the rest by the contract of the
        // header.
        Ok(methods) => unsafe { (methods.update)(identifier, u, y, outcome) },
        Err(error) => error,
    }
}

/// As `trendid_identifier_update` for a kind with several inputs: `u` has `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_update_inputs(
    identifier: *mut Identifier,
    u: *const f32,
    count: usize,
    y: f32,
    outcome: *mut Outcome,
) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { methods(identifier) }.and_then(|methods| {
        // SAFETY: by the contract of the header.
        Ok((methods, unsafe { list(u, count) }?))
    });
    match found {
        // SAFETY: the table belongs to the kind of the handle; the rest by the contract of the
        // header.
        Ok((methods, u)) => unsafe { (methods.update_inputs)(identifier, u, y, outcome) },
        Err(error) => error,
    }
}

/// Does a change; what is wrong in `detail`.
///
/// # Safety
/// The contract of the header.
unsafe fn change(identifier: *mut Identifier, change: Change<'_>, detail: *mut Detail) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { methods(identifier) }.and_then(|of| wanted(detail).map(|()| of));
    let done = found.map_err(Detail::from).and_then(|methods| {
        // SAFETY: the table belongs to the kind of the handle; the rest by the contract of the
        // header.
        unsafe { (methods.change)(identifier, change) }
    });
    // SAFETY: by the contract of the header.
    unsafe { crate::memory::tell(done, detail) }
}

/// Lets `samples` sample times pass without a measurement; a short gap is bridged by what the model
/// predicts.
///
/// For the interrupt; its time grows with `samples` up to the longest gap that is bridged, 5 /
/// bandwidth.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_skip(
    identifier: *mut Identifier,
    samples: u32,
) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { change(identifier, Change::Skip(samples), core::ptr::null_mut()) }
}

/// Back to the identifier as initialised.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_reset(identifier: *mut Identifier) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { change(identifier, Change::Reset, core::ptr::null_mut()) }
}

/// Forgets the signals, after a long gap in the samples, and keeps the estimate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_restart_trends(identifier: *mut Identifier) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { change(identifier, Change::RestartTrends, core::ptr::null_mut()) }
}

/// Makes the current estimate the one to which it returns where nothing excites it; only with a
/// memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_set_nominal(identifier: *mut Identifier) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { change(identifier, Change::SetNominal, core::ptr::null_mut()) }
}

/// Adapts (`true`, as initialised) or holds the estimate; predictions go on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_adapt(identifier: *mut Identifier, on: bool) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { change(identifier, Change::Adapt(on), core::ptr::null_mut()) }
}

/// Goes on with the default filter for a drive of the bandwidth `omega0` (rad/s); the estimate
/// stays.
///
/// Not for the 1 ms path: some 13000 instructions for order 3, see the table of the core.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_retune(
    identifier: *mut Identifier,
    omega0: f32,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { change(identifier, Change::Retune(omega0), detail) }
}

/// Begins again from an estimate with its standard deviations, 0 for a known parameter; both lists
/// have `count` numbers, one per parameter, in the units of `trendid_estimate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_warm_start(
    identifier: *mut Identifier,
    theta: *const f32,
    std: *const f32,
    count: usize,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    let lists = unsafe { list(theta, count) }.and_then(|theta| {
        // SAFETY: by the contract of the header.
        Ok((theta, unsafe { list(std, count) }?))
    });
    match lists {
        // SAFETY: by the contract of the header.
        Ok((theta, std)) => unsafe { change(identifier, Change::WarmStart(theta, std), detail) },
        // SAFETY: by the contract of the header.
        Err(error) => unsafe { crate::memory::tell(Err(error.into()), detail) },
    }
}

/// Asks something.
///
/// # Safety
/// The contract of the header.
#[inline(always)]
unsafe fn ask(
    identifier: *const Identifier,
    question: impl FnOnce(&'static Methods) -> Result<(), Error>,
) -> Error {
    // SAFETY: by the contract of the header.
    code(unsafe { methods(identifier) }.and_then(question))
}

/// The parameters alone, at about a sixth of the cost of `trendid_identifier_estimate`; `count` is
/// their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_theta(
    identifier: *const Identifier,
    theta: *mut f32,
    count: usize,
) -> Error {
    // SAFETY: by the contract of the header, and the table belongs to the kind of the handle.
    unsafe {
        ask(identifier, |of| {
            (of.theta)(identifier, list_mut(theta, count)?)
        })
    }
}

/// The model found, with its uncertainty.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_estimate(
    identifier: *const Identifier,
    estimate: *mut Estimate,
) -> Error {
    // SAFETY: by the contract of the header, and the table belongs to the kind of the handle.
    unsafe { ask(identifier, |of| (of.estimate)(identifier, estimate)) }
}

/// The covariance of the parameters, row by row; `count` is the square of their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_covariance(
    identifier: *const Identifier,
    covariance: *mut f32,
    count: usize,
) -> Error {
    // SAFETY: by the contract of the header, and the table belongs to the kind of the handle.
    unsafe {
        ask(identifier, |of| {
            (of.covariance)(identifier, list_mut(covariance, count)?)
        })
    }
}

/// The meaning of each entry of theta; `count` is their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_parameters(
    identifier: *const Identifier,
    parameters: *mut Parameter,
    count: usize,
) -> Error {
    // SAFETY: by the contract of the header, and the table belongs to the kind of the handle.
    unsafe {
        ask(identifier, |of| {
            (of.parameters)(identifier, list_mut(parameters, count)?)
        })
    }
}

/// The poles of the model, integrators first, then by rising distance from zero; `count` is the
/// order. `TRENDID_ERROR_NOT_YET` where they are not found.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_poles(
    identifier: *const Identifier,
    poles: *mut Pole,
    count: usize,
) -> Error {
    // SAFETY: by the contract of the header, and the table belongs to the kind of the handle.
    unsafe {
        ask(identifier, |of| {
            (of.poles)(identifier, list_mut(poles, count)?)
        })
    }
}

/// Prediction, noise, sums of errors, changes, dead zone, and what the estimate rests on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_identifier_status(
    identifier: *const Identifier,
    status: *mut Status,
) -> Error {
    // SAFETY: by the contract of the header, and the table belongs to the kind of the handle.
    unsafe { ask(identifier, |of| (of.status)(identifier, status)) }
}
