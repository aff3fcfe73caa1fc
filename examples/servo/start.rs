//! From the reset to the idle loop: the cause of the reset, the watchdog, then clocks and ports;
//! the idle loop alone logs.

use cortex_m_rt::entry;
use heapless::spsc::{Consumer, Queue};
use stm32f4xx_hal::pac::{self, NVIC, RCC, TIM2, TIM5};
use stm32f4xx_hal::timer;
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use stm32f4xx_hal::{prelude::*, rcc};
use trendid::hardware::Valve;
use trendid::servo::ServoLoop;
use trendid_example_support::brown_out::set_brown_out_level;
use trendid_example_support::machine::{config, servo_loop};
use trendid_example_support::reset;
use trendid_example_support::survivor::{Fault, Survivor, Text};
use trendid_example_support::watchdog::{at_least, set_period};
use trendid_link::telemetry::Event;

use crate::emulated::{self, Script};
use crate::keep::Keep;
use crate::slot::{self, Slot, UNWATCHED, WATCHDOG_MS, requests};
use crate::snapshot::Snapshot;
use crate::wire::{self, Pump};
use crate::wiring::{self, CRYSTAL_MHZ, Chip, Output, Ports, Sensor, TELEMETRY};
use crate::{RESUME, live, log, logger, survival};

/// Ticks of TIM2 per second in QEMU, whatever the clock control says.
const EMULATED_HZ: u32 = 1_000_000_000;

/// Slots in a second.
const SLOTS_PER_S: u64 = 1000;

/// Time for crystal, ports and construction; a crystal that does not start ends in a restart.
const START_MS: u32 = 100;

/// Time for the option bytes and for the stored model, when a sector of flash must be erased.
const KEEP_MS: u32 = 10_000;

/// Longest time for both (data sheet): the HAL erases with a parallelism of one byte, 0.8 s for the
/// option bytes as for a sector of 16 KiB, and 4 s for one of 128 KiB, 2 s as a rule.
const ERASE_MS: u32 = 4800;

// In the flash no code runs meanwhile that could feed.
const _: () = assert!(at_least(KEEP_MS) > ERASE_MS);

/// Priority of the slot: below that of the line, whose interrupt takes one byte.
const SLOT_PRIORITY: u8 = 0x10;

/// Level of the brown-out reset: below 2.7 V or so the chip is held in reset, and neither runs nor
/// writes its flash. For a supply of 3.3 V.
const BROWN_OUT: u8 = 3;

#[entry]
fn main() -> ! {
    let (consumer, script, keep, pump) = begin();
    idle(consumer, script, keep, pump)
}

/// What the idle loop owns.
type Idle = (
    Consumer<'static, Snapshot>,
    Option<Script>,
    Option<Keep>,
    Option<Pump>,
);

/// Begins the slots. Not part of `main`, on whose stack the loops that are built here would stay
/// for ever.
#[inline(never)]
fn begin() -> Idle {
    let chip = pac::Peripherals::take().unwrap();
    let mut core = cortex_m::Peripherals::take().unwrap();
    let watchdog = IndependentWatchdog::new(chip.IWDG);
    set_period(&mut Chip, START_MS);
    let (causes, mut survivor) = reset::take(&mut Chip, |causes| (causes, survival::begin(causes)));

    // The internal oscillator runs after reset on every chip; a clock control that does not know it
    // is QEMU's.
    let emulated = chip.RCC.cr().read().hsirdy().bit_is_clear();
    if emulated {
        logger::FRAMES.go_over_semihosting();
    }
    let mut rcc = clocked(chip.RCC, emulated);

    let ports = Ports {
        a: chip.GPIOA,
        b: chip.GPIOB,
        c: chip.GPIOC,
        encoder: chip.SPI2,
        dac: chip.SPI3,
        pulse: chip.TIM4,
    };
    let (sensor, mut valve, panel, pins) = if emulated {
        wiring::simulated(ports, &mut rcc)
    } else {
        wiring::wired(ports, &mut rcc)
    };
    // A converter keeps its last code over a restart of the chip. A failure is written again in
    // every slot.
    let _ = valve.safe();
    let mut servo = servo_loop(sensor, valve).unwrap();

    // In the emulator a word asks for the wire in the place of the script, in real time.
    let asked = if emulated { emulated::wire() } else { None };
    let wired = asked.is_some();
    let mut slots = slot_timer(chip.TIM2, emulated, &mut rcc);
    if !wired {
        slots.listen(timer::Event::Update);
    }
    let period = run_on(chip.TIM5);
    watch(&mut survivor, KEEP_MS);
    // Nothing moves yet: option bytes may be written, as a sector may be erased.
    let brown_out = (!emulated).then(|| set_brown_out_level(&mut Chip, BROWN_OUT));
    log::start(&survivor, causes, brown_out);
    // QEMU has no flash controller.
    let keep =
        (!emulated).then(|| kept(chip.FLASH, &mut servo, RESUME && survivor.fault().is_none()));

    let identity = wire::identity(&config(), emulated);
    let begun = (&survivor, causes.main().name());
    let over = asked.unwrap_or(TELEMETRY);
    let (mut wire, pump) = wire::begin(over, chip.USART1, pins, &mut rcc, identity, begun);
    if let (Some(wire), Some(fault)) = (&mut wire, survivor.fault()) {
        wire.event(Event::Fault(log::words(&fault)));
    }
    let queue = cortex_m::singleton!(: Queue<Snapshot, 32> = Queue::new()).unwrap();
    let (producer, consumer) = queue.split();
    watch(&mut survivor, WATCHDOG_MS);
    let stopped = survivor.fault().is_some();
    let panel = (panel, wire);
    slot::hand_over(Slot::new(
        servo, slots, period, watchdog, panel, producer, stopped,
    ));
    release(&mut core.NVIC);
    if wired {
        live::pace(&mut core.SYST);
    }
    let script = (emulated && !wired).then(Script::new);
    (consumer, script, keep, pump)
}

/// Gives the watchdog another period. A machine whose watchdog does not take it is stopped: nothing
/// moves that nothing watches over.
fn watch(survivor: &mut Survivor, ms: u32) {
    if !set_period(&mut Chip, ms) {
        survivor.latch(Fault::Stopped {
            why: Text::end_of(UNWATCHED),
        });
        survival::update(|kept| *kept = *survivor);
    }
}

/// The clocks of the board, or those that the emulator has.
fn clocked(control: pac::RCC, emulated: bool) -> rcc::Rcc {
    control.freeze(if emulated {
        rcc::Config::hsi()
    } else {
        rcc::Config::hse(CRYSTAL_MHZ.MHz()).sysclk(168.MHz())
    })
}

/// The memory of the machine; control resumes with what it holds, where that is wanted.
fn kept(flash: pac::FLASH, servo: &mut ServoLoop<Sensor, Output>, resume: bool) -> Keep {
    let (keep, record) = Keep::load(flash);
    if let Some(record) = record
        && resume
        && servo.resume(&record).is_err()
    {
        defmt::error!("the stored model is refused");
    }
    keep
}

/// Lets the slots interrupt.
fn release(interrupts: &mut NVIC) {
    // SAFETY: everything the interrupt needs was handed over, and it may wait for one of a higher
    // priority.
    unsafe {
        interrupts.set_priority(pac::Interrupt::TIM2, SLOT_PRIORITY);
        NVIC::unmask(pac::Interrupt::TIM2);
    }
}

/// Starts the timer of the slots.
fn slot_timer(timer: TIM2, emulated: bool, rcc: &mut rcc::Rcc) -> timer::CounterHz<TIM2> {
    let mut slots = timer.counter_hz(rcc);
    // QEMU counts with its own frequency, so there the rate is that of a clock which is so much
    // slower.
    let clock = rcc.clocks.timclk1().raw();
    let rate = if emulated {
        1000 * (clock / 1000) / (EMULATED_HZ / 1000)
    } else {
        1000
    };
    slots.start(rate.Hz()).unwrap();
    slots
}

/// Starts a counter that runs on, at the rate of the slot timer; gives the counts in a slot.
fn run_on(counter: TIM5) -> u32 {
    // SAFETY: the clocks of the ports and timers are set up; nobody else changes this register at
    // this time.
    unsafe {
        (*RCC::ptr())
            .apb1enr()
            .modify(|_, word| word.tim5en().set_bit())
    };
    // SAFETY: reading prescaler and reload value has no side effect.
    let slot = unsafe { &*TIM2::ptr() };
    let scale = slot.psc().read().bits();
    // SAFETY: any number is a prescaler or a reload value.
    counter.psc().write(|word| unsafe { word.bits(scale) });
    // SAFETY: as above.
    counter.arr().write(|word| unsafe { word.bits(u32::MAX) });
    counter.egr().write(|word| word.ug().set_bit());
    counter.cr1().modify(|_, word| word.cen().set_bit());
    slot.arr().read().bits() + 1
}

/// Sends what waits for the line, logs what the interrupt hands over, and keeps the model.
fn idle(
    mut snapshots: Consumer<'static, Snapshot>,
    mut script: Option<Script>,
    mut keep: Option<Keep>,
    mut pump: Option<Pump>,
) -> ! {
    let (mut known, mut lost) = (None, 0);
    loop {
        let sends = pump.as_mut().is_some_and(Pump::run);
        let Some(now) = snapshots.dequeue() else {
            if !sends {
                live::sent();
                cortex_m::asm::wfi();
            }
            continue;
        };
        defmt::info!(
            "{=u64} ms {}: position {=f32} mm, set {=f32} mm, command {=f32}; overruns {=u32}, missed {=u32}, dropped {=u32}, longest {=u32} us",
            now.tick,
            now.state,
            now.position,
            now.setpoint,
            now.command,
            now.overruns,
            now.missed,
            now.dropped,
            now.longest
        );
        if let Some(verified) = &now.verified
            && known.as_ref() != Some(verified)
        {
            log::model(&verified.record.model);
            known = Some(verified.clone());
        }
        if let (Some(keep), Some(verified)) = (&mut keep, &now.verified) {
            // The horizon of 136 years is that of the seconds.
            keep.consider(verified, (now.tick / SLOTS_PER_S) as u32);
        }
        if now.store {
            let seconds = (now.tick / SLOTS_PER_S) as u32;
            let store = |(keep, verified): (&mut Keep, _)| keep.store(verified, seconds);
            requests::stored(keep.as_mut().zip(now.verified.as_ref()).is_some_and(store));
        }
        let frames = logger::FRAMES.lost();
        if frames != lost {
            lost = frames;
            defmt::warn!("lines of the log that found no room: {=u32}", lost);
        }
        if now.stopped {
            defmt::error!(
                "stopped: safe output until acknowledged; requests refused {=u32}",
                now.refused
            );
            log::fault(survival::load().fault());
        }
        if let Some(script) = &mut script {
            script.step(&now);
        }
    }
}
