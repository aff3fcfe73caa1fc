//! What is wired to the chip: encoder, valve and button on their pins, or the simulated drive and
//! its script.

use core::sync::atomic::{AtomicBool, Ordering};

use stm32f4xx_hal::gpio::{Input, Output as PinOutput, PA0, PA9, PA10, PA15, PB7, PushPull};
use stm32f4xx_hal::hal::pwm::SetDutyCycle;
use stm32f4xx_hal::hal::spi;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use stm32f4xx_hal::timer::PwmChannel;
use stm32f4xx_hal::{pac, prelude::*};
use trendid::hardware::{
    DacValve, PositionSensor, PwmValve, SsiCode, SsiEncoder, SsiFormat, Valve,
};

use trendid_example_support::bus::Device;
use trendid_example_support::button::{Button, Request};
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::machine::ORIGIN;
use trendid_example_support::pulse::PromptZero;
use trendid_example_support::registers::Registers;
use trendid_example_support::safe_output;

use crate::wire::Over;
use crate::{emulated, live};

/// The transducer on SPI2.
const ENCODER: SsiFormat = SsiFormat {
    bits: 24,
    code: SsiCode::Gray,
    alarm: true,
    parity: true,
};

/// Frequency of the crystal; the only number of the board here besides the pins.
pub(crate) const CRYSTAL_MHZ: u32 = 8;

/// How the valve is driven on a board.
#[derive(PartialEq)]
enum Wiring {
    Pwm,
    #[allow(dead_code, reason = "the alternative of the wiring table")]
    Dac,
}

const OUTPUT: Wiring = Wiring::Pwm;

/// Where telemetry goes and requests come from: `Over::Usart` with the pins of the table, or
/// `Over::Rtt` through the debugger.
pub(crate) const TELEMETRY: Over = Over::Usart;

/// Set when a reading succeeded since the last look.
pub(crate) static FRESH: AtomicBool = AtomicBool::new(false);

type NoPin = PB7<PinOutput<PushPull>>;
type EncoderBus = Device<Spi<pac::SPI2>, NoPin>;
type DacBus = Device<Spi<pac::SPI3>, PA15<PinOutput<PushPull>>>;
type Pulse = PromptZero<PwmChannel<pac::TIM4, 0>, Chip>;

/// The transducer, or the simulated one.
pub(crate) enum Sensor {
    Encoder(SsiEncoder<EncoderBus>),
    Simulated(Drive),
}

impl PositionSensor for Sensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        let counts = match self {
            Self::Encoder(encoder) => encoder.counts().map_err(drop),
            Self::Simulated(drive) => live::reading(drive),
        };
        FRESH.store(counts.is_ok(), Ordering::Relaxed);
        counts
    }
}

/// The valve, or the simulated one.
pub(crate) enum Output {
    Pwm(PwmValve<Pulse, PB7<PinOutput<PushPull>>>),
    Dac(DacValve<DacBus>),
    Simulated(SimulatedValve),
}

impl Valve for Output {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        match self {
            Self::Pwm(valve) => valve.drive(command).map_err(drop),
            Self::Dac(valve) => valve.drive(command).map_err(drop),
            Self::Simulated(valve) => live::drive(valve, command),
        }
    }
}

/// Where requests of a person come from, or those of the emulated run.
pub(crate) enum Panel {
    Button(Button, PA0<Input>),
    Emulated,
}

impl Panel {
    /// The request of this slot; `moves`: whether the loop moves the axis.
    pub(crate) fn request(&mut self, moves: bool) -> Option<Request> {
        match self {
            Self::Button(button, pin) => button.update(pin.is_high(), moves),
            Self::Emulated => emulated::request(),
        }
    }
}

/// Centres the valve by its registers, whatever state the drivers are in: for handlers that do not
/// return, and restarts.
pub(crate) fn centre() {
    // The simulated valve cannot fail.
    let _ = SimulatedValve.drive(0.0);
    match OUTPUT {
        Wiring::Pwm => safe_output::stop_pulse(&mut Chip),
        Wiring::Dac => safe_output::middle_voltage(&mut Chip),
    }
}

/// The registers of this chip.
pub(crate) struct Chip;

impl Registers for Chip {
    fn read(&mut self, address: u32) -> u32 {
        // SAFETY: the callers name registers of the STM32F405/407, which are aligned; those that
        // are read may be.
        unsafe { (address as *const u32).read_volatile() }
    }

    fn write(&mut self, address: u32, word: u32) {
        // SAFETY: as above; no register here changes memory.
        unsafe { (address as *mut u32).write_volatile(word) };
    }

    fn write_byte(&mut self, address: u32, byte: u8) {
        // SAFETY: as above.
        unsafe { (address as *mut u8).write_volatile(byte) };
    }
}

/// The parts of the chip that the wiring needs.
pub(crate) struct Ports {
    pub a: pac::GPIOA,
    pub b: pac::GPIOB,
    pub c: pac::GPIOC,
    pub encoder: pac::SPI2,
    pub dac: pac::SPI3,
    pub pulse: pac::TIM4,
}

/// Sensor, valve, panel, and the pins of the wire.
pub(crate) type Connected = (Sensor, Output, Panel, (PA9, PA10));

/// The simulated drive and the script, and the pins of the wire.
pub(crate) fn simulated(ports: Ports, rcc: &mut Rcc) -> Connected {
    let pins = ports.a.split(rcc);
    (
        Sensor::Simulated(Drive::new(ORIGIN)),
        Output::Simulated(SimulatedValve),
        Panel::Emulated,
        (pins.pa9, pins.pa10),
    )
}

/// Encoder, valve as [`OUTPUT`] says, button, and the pins of the wire.
pub(crate) fn wired(ports: Ports, rcc: &mut Rcc) -> Connected {
    let pins_a = ports.a.split(rcc);
    let pins_b = ports.b.split(rcc);
    let pins_c = ports.c.split(rcc);
    let falling = spi::MODE_2;
    let bus = ports.encoder.spi(
        (Some(pins_b.pb13), Some(pins_b.pb14), pac::SPI2::NoMosi),
        falling,
        500.kHz(),
        rcc,
    );
    let encoder = SsiEncoder::new(Device { bus, select: None }, ENCODER).unwrap();
    let valve = if OUTPUT == Wiring::Pwm {
        let (_, (channel, ..)) = ports.pulse.pwm_hz(20.kHz(), rcc);
        let mut pulse = channel.with(pins_b.pb6);
        let _ = pulse.set_duty_cycle(0);
        pulse.enable();
        let pulse = PromptZero::new(pulse, Chip);
        Output::Pwm(PwmValve::new(pulse, pins_b.pb7.into_push_pull_output()))
    } else {
        let bus = ports.dac.spi(
            (Some(pins_c.pc10), pac::SPI3::NoMiso, Some(pins_c.pc12)),
            spi::MODE_1,
            10.MHz(),
            rcc,
        );
        let mut select = pins_a.pa15.into_push_pull_output();
        select.set_high();
        Output::Dac(DacValve::new(Device {
            bus,
            select: Some(select),
        }))
    };
    let panel = Panel::Button(Button::default(), pins_a.pa0.into_pull_down_input());
    let line = (pins_a.pa9, pins_a.pa10);
    (Sensor::Encoder(encoder), valve, panel, line)
}
