//! The servo controller: encoder, valve, identification and position control in a 1 kHz interrupt
//! of an STM32F405/407.
//!
//! | part | place |
//! |---|---|
//! | SSI encoder, 24 bits Gray with alarm and parity, 500 kHz | SPI2: clock PB13, data PB14 (RS-422 transceivers) |
//! | valve by pulse width, 20 kHz, and direction | TIM4 channel 1: PB6; direction PB7 |
//! | valve by voltage instead (`OUTPUT` in `wiring.rs`), DAC8551 | SPI3: clock PC10, data PC12; select PA15 |
//! | time slot of 1 ms; slots that are missing | TIM2; TIM5 |
//! | button: any press stops, a short one runs, two seconds acknowledge a fault | PA0, high when pressed |
//! | watchdog | independent watchdog, 10 ms |
//! | log | defmt over RTT (probe-rs) or semihosting (emulator) |
//! | telemetry and requests (`wire.rs`), 921 600 baud | USART1: transmit PA9, receive PA10 |
//! | the same through the debugger (`TELEMETRY` in `wiring.rs`) | channel 1 of RTT in both directions |
//!
//! Nothing moves by itself: after every reset the loop is idle until the button is pressed, which
//! commissions the axis; the next press stops it; or until the wire asks. A verified model is kept
//! in flash; `RESUME` lets control begin with it after a reset, at the position where the axis then
//! is. The interrupt reads, identifies, controls and drives; it hands a snapshot to the idle loop,
//! which alone logs, without waiting for a reader. An update that is not done when the next slot
//! begins is an overrun: it is counted, the loop is told of every slot that is missing, and three
//! in a row stop the machine, as a fault of sensor, valve or axis does.
//!
//! A machine that is stopped has the safe output until the button was held for two seconds. The
//! fault is kept in memory that survives a reset, with a panic, a hard fault and a bite of the
//! watchdog, so that a restart does not forget it. The watchdog is the first thing that runs, and
//! is fed only by a slot that ended in time and either had a fresh reading or wrote the safe output
//! of a stop; whatever prevents that, the chip restarts with the valve at rest.
//!
//! In the emulator there is no machine. The image sees that (the clock control reads zero there)
//! and puts a simulated drive in the place of encoder and valve and a script in the place of the
//! button; everything between them is the same. The script provokes overruns and a panic and holds
//! the reports of the starts after them against what it did (`emulated.rs`); started with the word
//! `wire` or `rtt` it leaves that to the wire, in real time (`live.rs`). On the host the same loop
//! runs on the same drive.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod debugger;
#[cfg(target_os = "none")]
mod emulated;
#[cfg(target_os = "none")]
mod keep;
#[cfg(target_os = "none")]
mod live;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod logger;
#[cfg(target_os = "none")]
mod slot;
#[cfg(target_os = "none")]
mod snapshot;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod survival;
#[cfg(target_os = "none")]
mod wire;
#[cfg(target_os = "none")]
mod wiring;

/// Whether control begins after a reset with the model in flash, without a request. A latched fault
/// prevents it.
#[cfg(target_os = "none")]
const RESUME: bool = false;

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use trendid_example_support::drive::{Drive, SimulatedValve};
    use trendid_example_support::machine::{Machine, ORIGIN, TRACED, plan};

    let mut machine = Machine::try_new(Drive::new(ORIGIN), SimulatedValve)?;
    let mut last = None;
    for tick in 1..=10_000 {
        // The requests that on a board a person makes.
        let request = plan(tick);
        if let Some(request) = request {
            println!("request: {request}");
        }
        let report = machine.update(request.map(|request| request.action));
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
    let model = machine
        .servo
        .supervisor()
        .verified_model()
        .ok_or("no model was verified")?;
    println!(
        "model: a1 {:.1} a2 {:.2} b0 {:.0} dead zone {:.4}",
        model.a1, model.a2, model.b0, model.dead_zone
    );
    println!("hash of {TRACED} samples: {:016x}", machine.trace().value());
    Ok(())
}
