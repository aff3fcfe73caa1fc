//! The delay of a drive: eight identifiers of order 3 side by side.

use trendid::identifier::DelayBank as CoreBank;
use trendid::trends::FilteredTrends;
use trendid::{Identifier as Core, Structure};

use crate::detail::Detail;
use crate::error::{Error, code};
use crate::identifier::{DELAY_MAX, Identifier, OfServo3, Outcome, Servo3, begin};
use crate::memory::{
    Inside, Object, blank, list_mut, make, object, object_mut, shared, wanted, write,
    write_if_wanted,
};
use crate::settings::{Settings, Takes};

/// Number of candidates: delays of 0 to 7 samples.
pub const DELAY_CANDIDATES: usize = DELAY_MAX + 1;

/// Words of 8 bytes of a `trendid_delay_bank`.
pub const DELAY_BANK_WORDS: usize = 1552;

/// Identifiers of the kind `trendid_servo3` with the delays 0 to 7 side by side; the one that
/// predicts best has the delay.
///
/// For commissioning: eight times an identifier in time and memory.
#[repr(C)]
pub struct DelayBank {
    words: [u64; DELAY_BANK_WORDS],
}

type Servo = Core<FilteredTrends<3>, 3, 5, 1, DELAY_MAX>;
pub(crate) type Bank = CoreBank<Servo, DELAY_CANDIDATES>;

impl Inside for Bank {
    const MAGIC: u32 = 0xBABA_BABA;
}

/// The object in the memory of the caller.
const fn at(bank: *const DelayBank) -> *const Object<Bank> {
    bank.cast()
}

/// Makes a bank; `delay` of the settings, which is looked for, must be 0. `detail`, if not NULL,
/// says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_delay_bank_init(
    memory: *mut DelayBank,
    settings: *const Settings,
    detail: *mut Detail,
) -> Error {
    let fill = |bank: *mut Bank| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { shared(settings) }?;
        let structure = Structure::<3, 5, 1>::SERVO;
        settings.check(&Takes {
            inputs: 1,
            sign: 1,
            // It is what is looked for.
            delay: 0,
            parameters: 5,
            constant: structure.constant(),
            dead_zone: false,
        })?;
        let mut config = settings.config(structure, [Some(0)]);
        // As `Bank::try_new`, each candidate where it is to stand.
        for delay in 0..DELAY_CANDIDATES {
            config.delays = [delay];
            // SAFETY: memory for a bank, by the contract of `make`, which is laid out as the array
            // of its candidates.
            let candidate = unsafe { blank(bank.cast::<Servo>().add(delay)) };
            candidate.reconfigure(&config, settings.trends()?)?;
        }
        Ok(())
    };
    // SAFETY: by the contract of the header.
    unsafe { make(memory, fill, detail) }
}

/// Takes command and position, as `trendid_identifier_update`; `outcome` is that of the candidate
/// without delay, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_delay_bank_update(
    bank: *mut DelayBank,
    u: f32,
    y: f32,
    outcome: *mut Outcome,
) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { object_mut(at(bank).cast_mut()) };
    match found.and_then(|bank| wanted(outcome).map(|()| bank)) {
        Ok(bank) => {
            let done = bank.update_inputs([u], y);
            // SAFETY: by the contract of the header.
            unsafe { write_if_wanted(outcome, done.into()) };
            Error::Ok
        }
        Err(error) => error,
    }
}

/// The delay with the smallest prediction error, in samples, and how clear the choice is: the error
/// of the second best over that of the best, at least 1. Either may be NULL.
/// `TRENDID_ERROR_NOT_YET` until all can be compared.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_delay_bank_best(
    bank: *const DelayBank,
    delay: *mut u32,
    margin: *mut f32,
) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { object(at(bank)) }.and_then(|bank| {
        wanted(delay)?;
        wanted(margin)?;
        Ok((
            bank.best().ok_or(Error::NotYet)?,
            bank.margin().ok_or(Error::NotYet)?,
        ))
    });
    match found {
        Ok((best, clear)) => {
            // SAFETY: by the contract of the header.
            unsafe {
                write_if_wanted(delay, best as u32);
                write_if_wanted(margin, clear);
            }
            Error::Ok
        }
        Err(error) => error,
    }
}

/// The delay between the samples, half a sample from the one of `trendid_delay_bank_best` at most,
/// as a `delay` of the settings. `TRENDID_ERROR_NOT_YET` until all can be compared.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_delay_bank_refined(
    bank: *const DelayBank,
    delay: *mut f32,
) -> Error {
    // SAFETY: by the contract of the header.
    let refined = unsafe { object(at(bank)) }.and_then(|bank| bank.refined().ok_or(Error::NotYet));
    // SAFETY: by the contract of the header.
    code(refined.and_then(|refined| unsafe { write(delay, refined) }))
}

/// The prediction error of each delay in the unit of y, infinite while unknown; `count` is
/// `TRENDID_DELAY_CANDIDATES`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_delay_bank_errors(
    bank: *const DelayBank,
    errors: *mut f32,
    count: usize,
) -> Error {
    // SAFETY: by the contract of the header.
    code(unsafe { object(at(bank)) }.and_then(|bank| {
        // SAFETY: by the contract of the header.
        let to = unsafe { list_mut(errors, count) }?;
        if to.len() != DELAY_CANDIDATES {
            return Err(Error::Length);
        }
        for (place, error) in to.iter_mut().zip(bank.errors()) {
            *place = error.unwrap_or(f32::INFINITY);
        }
        Ok(())
    }))
}

/// Copies the identifier with the best delay into memory of its own, to go on with it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_delay_bank_chosen(
    bank: *const DelayBank,
    memory: *mut Servo3,
    identifier: *mut *mut Identifier,
) -> Error {
    let chosen = |kind: &mut OfServo3| {
        // SAFETY: by the contract of the header.
        let bank = unsafe { object(at(bank)) }?;
        let chosen = bank.chosen().ok_or(Error::NotYet)?;
        kind.identifier.clone_from(chosen);
        kind.given = 1;
        Ok(())
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, chosen, identifier, core::ptr::null_mut()) }
}
