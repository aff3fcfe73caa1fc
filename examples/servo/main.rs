//! The servo controller: encoder, valve, identification and position control in a 1 kHz interrupt of an STM32F405/407.
//!
//! | part | place |
//! |---|---|
//! | SSI encoder, 24 bits Gray with alarm and parity, 500 kHz | SPI2: clock PB13, data PB14 (RS-422 transceivers) |
//! | valve by pulse width, 20 kHz, and direction | TIM4 channel 1: PB6; direction PB7 |
//! | valve by voltage instead (`OUTPUT` in `wiring.rs`), DAC8551 | SPI3: clock PC10, data PC12; select PA15 |
//! | time slot of 1 ms | TIM2 |
//! | watchdog | independent watchdog, 10 ms |
//! | log | defmt over RTT (probe-rs) or semihosting (emulator) |
//!
//! The interrupt reads, identifies, controls and drives; it hands a snapshot to the idle loop, which alone logs. An update
//! that is not done when the next slot begins is an overrun: it is counted, and three in a row switch to the safe output
//! for good. The watchdog is fed only by an update that ended in its slot and had a fresh reading; whatever stops that,
//! the chip restarts with the valve at rest.
//!
//! In the emulator there is no machine. The image sees that (the clock control reads zero there) and puts a simulated
//! drive in the place of encoder and valve; everything between them is the same. It then provokes
//! three overruns to show that they end in the safe output, and exits. On the host the same loop runs on the same drive.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod slot;
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

/// Targets of the moves in mm, and the samples between them.
const TARGETS: [f32; 2] = [120.0, 280.0];
const DWELL: u32 = 1500;

/// The control loop of this machine.
fn machine<S: PositionSensor, V: Valve>(
    sensor: S,
    valve: V,
) -> Result<ServoLoop<S, V>, servo::Error> {
    let axis = Axis {
        scale: const { Scale::new(MM_PER_COUNT).unwrap() },
        reference: ORIGIN,
    };
    let mut config = servo::Config::new(SAMPLE_TIME, BANDWIDTH, TRAVEL);
    config.delay = DELAY;
    let mut servo = ServoLoop::try_new(&config, axis, sensor, valve)?;
    servo.commission();
    Ok(servo)
}

/// The next move, when one is due in sample `tick`.
fn target(tick: u32) -> Option<f32> {
    tick.is_multiple_of(DWELL)
        .then(|| TARGETS[(tick / DWELL) as usize % TARGETS.len()])
}

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use trendid_example_support::drive::{Drive, SimulatedValve};

    let mut servo = machine(Drive::new(ORIGIN), SimulatedValve)?;
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
