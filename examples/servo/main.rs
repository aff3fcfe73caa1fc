//! The servo controller: encoder, valve, identification and position control in a 1 kHz interrupt of an STM32F405/407.
//!
//! | part | place |
//! |---|---|
//! | SSI encoder, 24 bits Gray with alarm and parity, 500 kHz | SPI2: clock PB13, data PB14 (RS-422 transceivers) |
//! | valve by pulse width, 20 kHz, and direction | TIM4 channel 1: PB6; direction PB7 |
//! | valve by voltage instead (`OUTPUT` in `wiring.rs`), DAC8551 | SPI3: clock PC10, data PC12; select PA15 |
//! | time slot of 1 ms | TIM2 |
//! | button: short press runs or stops, two seconds acknowledge a fault | PA0, high when pressed |
//! | watchdog | independent watchdog, 10 ms |
//! | log | defmt over RTT (probe-rs) or semihosting (emulator) |
//!
//! Nothing moves by itself: after every reset the loop is idle until the button is pressed, which commissions the axis; the
//! next press stops it. A verified model is kept in flash; `RESUME` lets control begin with it after a reset, at the position
//! where the axis then is. The interrupt reads, identifies, controls and drives; it hands a snapshot to the idle loop, which
//! alone logs. An update that is not done when the next slot begins is an overrun: it is counted, and three in a row stop
//! the machine, as a fault of sensor, valve or axis does.
//!
//! A machine that is stopped has the safe output until the button was held for two seconds. The fault is kept in memory
//! that survives a reset, with a panic, a hard fault and a bite of the watchdog, so that a restart does not forget it. The
//! watchdog is the first thing that runs, and is fed only by a slot that ended in time and either had a fresh reading or
//! wrote the safe output of a stop; whatever prevents that, the chip restarts with the valve at rest.
//!
//! In the emulator there is no machine. The image sees that (the clock control reads zero there) and puts a simulated
//! drive in the place of encoder and valve and a script in the place of the button; everything between them is the same.
//! The script provokes overruns and a panic and holds the reports of the starts after them against what it did
//! (`emulated.rs`). On the host the same loop runs on the same drive.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod emulated;
#[cfg(target_os = "none")]
mod keep;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod slot;
#[cfg(target_os = "none")]
mod snapshot;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod survival;
#[cfg(target_os = "none")]
mod wiring;

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, ServoLoop, Travel};

/// Units of the encoder: 5 um per count.
const MM_PER_COUNT: f32 = 0.005;

/// Code of the transducer at the begin of the travel, read once when the machine was built.
const ORIGIN: i32 = 8_000_000;

/// The machine: 400 mm of travel, a valve and a cylinder of about 20 rad/s.
const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};
/// The time slot in s.
const SAMPLE_TIME: f32 = 1e-3;

const BANDWIDTH: f32 = 20.0;

/// Time in s from the command to the flow: none in the simulated drive, 2 ms with a spool valve of 100 Hz. Two ms that are not
/// there cost 5 % in a1, 15 % in a2 and the dead zone.
const DELAY: f32 = 0.0;

/// Time in s of excitation before a model is tried. After the default of 0.26 s the loop controls, with b0 10 % too large and a
/// dead zone of 0.073 instead of 0.030; after 0.5 s both are found.
const EXCITE_TIME: f32 = 0.5;

/// Whether control begins after a reset with the model in flash, without a request. A latched fault prevents it.
#[cfg(target_os = "none")]
const RESUME: bool = false;

/// Targets of the moves in mm, and the samples between them.
const TARGETS: [f32; 2] = [120.0, 280.0];
const DWELL: u64 = 1500;

/// From codes to millimetres.
const AXIS: Axis = Axis {
    scale: Scale::new(MM_PER_COUNT).unwrap(),
    reference: ORIGIN,
};

/// The control loop of this machine, idle.
fn machine<S: PositionSensor, V: Valve>(
    sensor: S,
    valve: V,
) -> Result<ServoLoop<S, V>, servo::Error> {
    ServoLoop::try_new(&config(), AXIS, sensor, valve)
}

/// The settings of this machine.
fn config() -> servo::Config {
    let mut config = servo::Config::new(SAMPLE_TIME, BANDWIDTH, TRAVEL);
    config.delay = DELAY;
    config.supervision.excite_time = EXCITE_TIME;
    config
}

/// The next move, when one is due in sample `tick`.
fn target(tick: u64) -> Option<f32> {
    tick.is_multiple_of(DWELL)
        .then(|| TARGETS[(tick / DWELL) as usize % TARGETS.len()])
}

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use trendid_example_support::drive::{Drive, SimulatedValve};

    let mut servo = machine(Drive::new(ORIGIN), SimulatedValve)?;
    // The request that on a board the button makes.
    servo.commission();
    let mut last = None;
    for tick in 1..=10_000 {
        if let Some(target) = target(tick) {
            servo.move_to(target)?;
        }
        let report = servo.update();
        if last != Some(report.state) || tick.is_multiple_of(1000) {
            last = Some(report.state);
            println!(
                "{tick:5} ms {:12} position {:8.3} mm, set {:8.3} mm, command {:6.3}",
                report.state.to_string(),
                report.position,
                report.setpoint.position,
                report.command
            );
        }
    }
    let model = servo
        .supervisor()
        .verified_model()
        .ok_or("no model was verified")?;
    println!(
        "model: a1 {:.1} a2 {:.2} b0 {:.0} dead zone {:.4}",
        model.a1, model.a2, model.b0, model.dead_zone
    );
    Ok(())
}
