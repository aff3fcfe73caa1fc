//! What is shown of a model, of a start and of a fault. Only the idle loop may log.

use micromath::F32Ext;
use trendid::servo;
use trendid_example_support::brown_out::Setting;
use trendid_example_support::reset::{Cause, Causes};
use trendid_example_support::survivor::{Fault, Survivor};
use trendid_link::telemetry;

use crate::logger::FRAMES;

/// Shows a model as its parameters, and as frequency and damping of the drive behind the
/// integrator.
///
/// The square root is a display value: micromath's approximation (a few per cent) in one
/// instruction pair instead of the exact one of the library.
pub(crate) fn model(model: &servo::Model) {
    let frequency = model.a1.sqrt();
    let damping = model.a2 / (2.0 * frequency);
    defmt::info!(
        "model: a1 {=f32} a2 {=f32} b0 {=f32} dead zone {=f32}; about {=f32} rad/s, damping {=f32}",
        model.a1,
        model.a2,
        model.b0,
        model.dead_zone,
        frequency,
        damping
    );
}

/// Shows what the start found: where it runs, why the chip restarted, how often, and what ended the
/// run before.
pub(crate) fn start(survivor: &Survivor, causes: Causes, brown_out: Option<Setting>) {
    match brown_out {
        None => defmt::info!(
            "trendid servo, simulated drive; reset flags, brown-out and watchdog are not modelled"
        ),
        Some(setting) => {
            defmt::info!("trendid servo, encoder on SPI2");
            match setting {
                Setting::Kept => {}
                Setting::Written => defmt::info!("brown-out reset set, from the next start on"),
                Setting::Refused => defmt::error!("the brown-out reset cannot be set"),
            }
        }
    }
    defmt::info!(
        "start {=u32}, cause of the reset: {=str} (flags {=u32:#x})",
        survivor.starts(),
        causes.main().name(),
        causes.bits()
    );
    for cause in Cause::ALL {
        let count = survivor.resets(cause);
        if count > 1 {
            defmt::info!(
                "resets since power came, {=str}: {=u32}",
                cause.name(),
                count
            );
        }
    }
    if survivor.fault().is_some() {
        defmt::error!("a fault is latched: nothing moves until it is acknowledged");
        fault(survivor.fault());
    }
}

/// A fault in few words.
pub(crate) fn words(fault: &Fault) -> telemetry::Text {
    telemetry::text(match fault {
        Fault::Stopped { why } => why.as_str(),
        Fault::Watchdog => "the watchdog was not fed",
        Fault::Panic { .. } => "panic",
        Fault::HardFault { .. } => "hard fault",
        Fault::StackOverflow { .. } => "the stack overflowed",
        Fault::Exception { .. } => "an exception has no handler",
        Fault::Forgotten => "the record of faults was damaged",
    })
}

/// Shows a latched fault.
pub(crate) fn fault(fault: Option<Fault>) {
    match fault {
        None => {}
        Some(Fault::Stopped { why }) => defmt::error!("fault: {=str}", why.as_str()),
        Some(Fault::Watchdog) => defmt::error!("fault: the watchdog was not fed"),
        Some(Fault::Panic { line, file }) => {
            defmt::error!("fault: panic in {=str}, line {=u32}", file.as_str(), line);
        }
        Some(Fault::HardFault { pc, lr }) => {
            defmt::error!("fault: hard fault");
            // Addresses are another with every build: no lines for the quoted log.
            if !FRAMES.are_over_semihosting() {
                defmt::error!("at {=u32:#x}, return address {=u32:#x}", pc, lr);
            }
        }
        Some(Fault::StackOverflow { sp }) => {
            defmt::error!("fault: the stack overflowed");
            if !FRAMES.are_over_semihosting() {
                defmt::error!("its pointer was {=u32:#x}", sp);
            }
        }
        Some(Fault::Exception { number }) => {
            defmt::error!("fault: exception {=i32} has no handler", number);
        }
        Some(Fault::Forgotten) => defmt::error!("fault: the record of faults was damaged"),
    }
}
