//! The functions of a loop.

use trendid::servo::store::{Identity, RECORD_BYTES as CORE_RECORD_BYTES, Record};

use crate::detail::Detail;
use crate::error::{Error, code};
use crate::memory::{
    Object, blank, list, list_mut, make, object, object_mut, shared, tell, wanted, write,
    write_if_wanted,
};
use crate::servo::edge::{Body, Code, Output};
use crate::servo::report::{Model, Report};
use crate::servo::settings::LoopSettings;

/// Bytes of a stored model.
pub const RECORD_BYTES: usize = 96;

const _: () = assert!(RECORD_BYTES == CORE_RECORD_BYTES);

/// Words of 8 bytes of a `trendid_loop`.
pub const LOOP_WORDS: usize = 1936;

/// Memory of an adaptive position loop.
#[repr(C)]
pub struct Loop {
    words: [u64; LOOP_WORDS],
}

/// The object in the memory of the caller.
pub(super) const fn at(servo: *const Loop) -> *const Object<Body> {
    servo.cast()
}

/// What the loop of the caller holds.
///
/// # Safety
/// The contract of the header.
#[inline(always)]
unsafe fn body<'a>(servo: *mut Loop) -> Result<&'a mut Body, Error> {
    // SAFETY: by the contract of this function.
    unsafe { object_mut(at(servo).cast_mut()) }
}

/// Makes a loop that is idle; `detail`, if not NULL, says which setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_init(
    memory: *mut Loop,
    settings: *const LoopSettings,
    detail: *mut Detail,
) -> Error {
    let fill = |body: *mut Body| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { shared(settings) }?;
        let config = settings.config()?;
        // SAFETY: memory for a body, by the contract of `make`.
        let Body { servo, identity } = unsafe { blank(body) };
        *servo.sensor_mut() = Code(None);
        *servo.valve_mut() = Output {
            steps: settings.steps()?,
            fault: false,
        };
        let made = servo.reconfigure(&config, settings.axis()?);
        made.map_err(|error| settings.refused(error))?;
        *identity = Identity::new(0, &config);
        Ok(())
    };
    // SAFETY: by the contract of the header; where it succeeds, all of the body is made.
    unsafe { make(memory, fill, detail) }
}

/// One sample: takes the code of the sensor, gives the command for the valve in `report`.
///
/// For the interrupt of the sample. The loop counts on the command being in force until the next
/// sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_update(
    servo: *mut Loop,
    code: i32,
    report: *mut Report,
) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { sample(servo, Some(code), report) }
}

/// One sample without a reading: the sensor reported an error. Short gaps are bridged, longer ones
/// stop the axis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_update_blind(servo: *mut Loop, report: *mut Report) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { sample(servo, None, report) }
}

/// A sample; nothing is done where the report has no place, since the command would be lost.
///
/// # Safety
/// The contract of the header.
unsafe fn sample(servo: *mut Loop, code: Option<i32>, report: *mut Report) -> Error {
    if report.is_null() {
        return Error::Null;
    }
    if !report.is_aligned() {
        return Error::Misaligned;
    }
    // SAFETY: by the contract of the header.
    match unsafe { body(servo) } {
        Ok(body) => {
            body.servo.sensor_mut().0 = code;
            let done = body.servo.update();
            body.servo.valve_mut().fault = false;
            // SAFETY: by the contract of the header.
            unsafe { write_if_wanted(report, done.into()) };
            Error::Ok
        }
        Err(error) => error,
    }
}

/// Says that the valve did not take the last command: the next sample stops the axis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_valve_fault(servo: *mut Loop) -> Error {
    // SAFETY: by the contract of the header.
    code(unsafe { body(servo) }.map(|body| body.servo.valve_mut().fault = true))
}

/// Commissions the axis with the next sample, around the position it then has. The axis moves. One
/// in motion first comes to rest: in control within the limits of motion, at a place with room to
/// both ends, else behind the closed valve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_commission(servo: *mut Loop) -> Error {
    // SAFETY: by the contract of the header.
    code(unsafe { body(servo) }.map(|body| body.servo.commission()))
}

/// Stops commissioning or control: the valve closes at its rate limit, the verified model is kept.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_abort(servo: *mut Loop) -> Error {
    // SAFETY: by the contract of the header.
    code(unsafe { body(servo) }.map(|body| body.servo.abort()))
}

/// Does what can be refused.
///
/// # Safety
/// The contract of the header.
unsafe fn attempt(
    servo: *mut Loop,
    detail: *mut Detail,
    attempt: impl FnOnce(&mut Body) -> Result<(), Detail>,
) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { body(servo) }.and_then(|body| wanted(detail).map(|()| body));
    let done = found.map_err(Detail::from).and_then(attempt);
    // SAFETY: by the contract of the header.
    unsafe { tell(done, detail) }
}

/// Moves to `target`, in the unit of y, limited to the travel, as fast as the limits of motion
/// allow; in any sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_move_to(
    servo: *mut Loop,
    target: f32,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    unsafe { attempt(servo, detail, |body| Ok(body.servo.move_to(target)?)) }
}

/// Oscillates with `amplitude` (unit of y) and `frequency` (Hz) about the present reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_oscillate(
    servo: *mut Loop,
    amplitude: f32,
    frequency: f32,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    unsafe {
        attempt(servo, detail, |body| {
            Ok(body.servo.oscillate(amplitude, frequency)?)
        })
    }
}

/// Takes a model that is known to be good: control begins with the next sample, with the motion
/// that the axis then has, and lets it run out. Before the first position the valve is in its
/// middle until the readings show that motion.
///
/// `TRENDID_ERROR_OUT_OF_RANGE` with the position where the axis stands beyond its travel by more
/// than a hundredth of it; where that is seen with the next sample, the state is failed with
/// `TRENDID_REASON_IMPLAUSIBLE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_install(
    servo: *mut Loop,
    model: *const Model,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    let model = unsafe { shared(model) }.copied();
    // SAFETY: by the contract of the header.
    unsafe {
        attempt(servo, detail, |body| {
            Ok(body.servo.install(model?.into())?)
        })
    }
}

/// The verified model; `TRENDID_ERROR_NOT_YET` before there is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_model(servo: *const Loop, model: *mut Model) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { object(at(servo)) }.and_then(|body| {
        body.servo
            .supervisor()
            .verified_model()
            .ok_or(Error::NotYet)
    });
    // SAFETY: by the contract of the header.
    code(found.and_then(|found| unsafe { write(model, found.into()) }))
}

/// The verified model as bytes that end in their CRC-32, to be stored; `count` is
/// `TRENDID_RECORD_BYTES`.
///
/// `plant` is the machine, for instance its serial number; `sequence` counts the records, so that
/// the newest can be told.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_store(
    servo: *const Loop,
    plant: u32,
    sequence: u32,
    bytes: *mut u8,
    count: usize,
) -> Error {
    // SAFETY: by the contract of the header.
    code(unsafe { object(at(servo)) }.and_then(|body| {
        // SAFETY: by the contract of the header.
        let to = unsafe { list_mut(bytes, count) }?;
        if to.len() != RECORD_BYTES {
            return Err(Error::Length);
        }
        let record = body.servo.record().ok_or(Error::NotYet)?;
        let identity = Identity {
            plant,
            ..body.identity
        };
        for (place, byte) in to.iter_mut().zip(record.to_bytes(&identity, sequence)) {
            *place = byte;
        }
        Ok(())
    }))
}

/// Control from the next sample on with a stored model, in the motion that the axis then has, as
/// the record of this machine and these settings; refused for the place of the axis as by
/// `trendid_loop_install`.
///
/// `sequence`, if not NULL, gets the number of the record; `detail`, if not NULL, says what was
/// refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_load(
    servo: *mut Loop,
    plant: u32,
    bytes: *const u8,
    count: usize,
    sequence: *mut u32,
    detail: *mut Detail,
) -> Error {
    // SAFETY: by the contract of the header.
    let bytes = unsafe { list(bytes, count) };
    let load = |body: &mut Body| {
        let bytes = bytes?.try_into().map_err(|_| Error::Length)?;
        wanted(sequence)?;
        let identity = Identity {
            plant,
            ..body.identity
        };
        let (record, number) = Record::from_bytes(bytes, &identity)?;
        body.servo.resume(&record)?;
        // SAFETY: by the contract of the header.
        unsafe { write_if_wanted(sequence, number) };
        Ok(())
    };
    // SAFETY: by the contract of the header.
    unsafe { attempt(servo, detail, load) }
}
