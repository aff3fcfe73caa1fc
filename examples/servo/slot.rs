//! The 1 ms slot of the servo controller and the idle loop around it.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU8, Ordering};

use cortex_m::interrupt::{Mutex, free};
use cortex_m_rt::entry;
use cortex_m_semihosting::debug;
use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::pac::{self, NVIC, TIM2};
use stm32f4xx_hal::timer::{CounterHz, Event, Flag};
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use stm32f4xx_hal::{ReadFlags, pac::interrupt, prelude::*, rcc};
use trendid::hardware::Valve;
use trendid::servo::{self, ServoLoop, State};

use crate::wiring::{self, CRYSTAL_MHZ, FRESH, Output, Ports, Sensor};
use crate::{ORIGIN, log, machine, target};
use trendid_example_support::drive::{Drive, SimulatedValve};

/// Overruns in a row that end in the safe output.
const LIMIT: u8 = 3;

/// Samples between two lines of the log.
const EVERY: u32 = 500;

/// End of the run in the emulator, in samples; three overruns are provoked before it.
const END: u32 = 6000;

/// Ticks of TIM2 per second in QEMU, whatever the clock control says.
const EMULATED_HZ: u32 = 1_000_000_000;

/// Overruns that the interrupt is asked to provoke.
static PROVOKED: AtomicU8 = AtomicU8::new(0);

/// Messages from the interrupt to the idle loop.
#[derive(Clone, Copy)]
struct Snapshot {
    tick: u32,
    state: State,
    position: f32,
    setpoint: f32,
    command: f32,
    overruns: u32,
    /// Slots that could not be logged because the queue was full.
    dropped: u32,
    stopped: bool,
    fed: u32,
    /// Longest update so far in us; in the emulator in thousands of instructions.
    longest: u32,
    model: Option<servo::Model>,
}

/// Everything the interrupt owns.
struct Slot {
    servo: ServoLoop<Sensor, Output>,
    timer: CounterHz<TIM2>,
    /// Ticks of the timer per slot.
    period: u32,
    watchdog: IndependentWatchdog,
    out: Producer<'static, Snapshot>,
    now: Snapshot,
    in_a_row: u8,
}

static SLOT: Mutex<RefCell<Option<Slot>>> = Mutex::new(RefCell::new(None));

#[interrupt]
fn TIM2() {
    static mut OWN: Option<Slot> = None;
    if OWN.is_none() {
        *OWN = free(|section| SLOT.borrow(section).take());
    }
    if let Some(slot) = OWN {
        slot.run();
    }
}

impl Slot {
    fn run(&mut self) {
        let begin = count();
        // Ends the request, so that the next one shows whether this slot was too long.
        let _ = self.timer.wait();
        self.now.tick += 1;
        if self.now.stopped {
            // Again and again: a valve that missed it once must not stay open.
            let _ = self.servo.valve_mut().safe();
        } else {
            self.control(begin);
        }
        if self.now.tick.is_multiple_of(EVERY) && self.out.enqueue(self.now).is_err() {
            self.now.dropped += 1;
        }
    }

    fn control(&mut self, begin: u32) {
        if let Some(target) = target(self.now.tick) {
            // The targets are finite: nothing to refuse.
            let _ = self.servo.move_to(target);
        }
        let report = self.servo.update();
        let before = core::mem::discriminant(&self.now.state);
        self.now.state = report.state;
        self.now.position = report.position;
        self.now.setpoint = report.setpoint.position;
        self.now.command = report.command;
        if PROVOKED.load(Ordering::Relaxed) > 0 {
            PROVOKED.fetch_sub(1, Ordering::Relaxed);
            while !self.late() {}
        }
        let fresh = FRESH.swap(false, Ordering::Relaxed);
        if self.late() {
            self.now.overruns += 1;
            self.in_a_row += 1;
            if self.in_a_row >= LIMIT {
                self.now.stopped = true;
                let _ = self.servo.valve_mut().safe();
            }
            return;
        }
        self.in_a_row = 0;
        if fresh {
            self.watchdog.feed();
            self.now.fed += 1;
        }
        let end = count();
        // The counter of the chip begins again with each slot, that of the emulator runs on.
        let ticks = if end >= begin {
            end - begin
        } else {
            end + self.period - begin
        };
        let us = (u64::from(ticks) * 1000 / u64::from(self.period)) as u32;
        self.now.longest = self.now.longest.max(us);
        if core::mem::discriminant(&self.now.state) != before {
            self.now.model = self.servo.supervisor().verified_model();
            if self.out.enqueue(self.now).is_err() {
                self.now.dropped += 1;
            }
        }
    }

    /// Whether the next slot has begun.
    fn late(&self) -> bool {
        self.timer.flags().contains(Flag::Update)
    }
}

/// The counter of the slot timer.
fn count() -> u32 {
    // SAFETY: reading the counter has no side effect.
    unsafe { (*TIM2::ptr()).cnt().read().bits() }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // Interrupts off: the watchdog gets no food and restarts the chip with the valve at rest.
    cortex_m::interrupt::disable();
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

#[entry]
fn main() -> ! {
    let queue = cortex_m::singleton!(: Queue<Snapshot, 32> = Queue::new()).unwrap();
    let (producer, consumer) = queue.split();
    let chip = pac::Peripherals::take().unwrap();
    // The internal oscillator runs after reset on every chip; a clock control that does not know it is QEMU's.
    let emulated = chip.RCC.cr().read().hsirdy().bit_is_clear();
    let config = if emulated {
        log::over_semihosting();
        rcc::Config::hsi()
    } else {
        rcc::Config::hse(CRYSTAL_MHZ.MHz()).sysclk(168.MHz())
    };
    let mut rcc = chip.RCC.freeze(config);

    let (sensor, valve) = if emulated {
        (
            Sensor::Simulated(Drive::new(ORIGIN)),
            Output::Simulated(SimulatedValve),
        )
    } else {
        wiring::wired(
            Ports {
                a: chip.GPIOA,
                b: chip.GPIOB,
                c: chip.GPIOC,
                encoder: chip.SPI2,
                dac: chip.SPI3,
                pulse: chip.TIM4,
            },
            &mut rcc,
        )
    };
    let servo = machine(sensor, valve).unwrap();

    let mut timer = chip.TIM2.counter_hz(&mut rcc);
    // QEMU counts with its own frequency, so there the rate is that of a clock which is so much slower.
    let clock = rcc.clocks.timclk1().raw();
    let rate = if emulated {
        1000 * (clock / 1000) / (EMULATED_HZ / 1000)
    } else {
        1000
    };
    timer.start(rate.Hz()).unwrap();
    timer.listen(Event::Update);
    // SAFETY: reading the reload value has no side effect.
    let period = unsafe { (*TIM2::ptr()).arr().read().bits() } + 1;
    let mut watchdog = IndependentWatchdog::new(chip.IWDG);
    watchdog.start(10.millis());
    let now = Snapshot {
        tick: 0,
        state: State::Idle,
        position: 0.0,
        setpoint: 0.0,
        command: 0.0,
        overruns: 0,
        dropped: 0,
        stopped: false,
        fed: 0,
        longest: 0,
        model: None,
    };
    let slot = Slot {
        servo,
        timer,
        period,
        watchdog,
        out: producer,
        now,
        in_a_row: 0,
    };
    free(|section| SLOT.borrow(section).replace(Some(slot)));
    defmt::info!(
        "trendid servo, {=str}",
        if emulated {
            "simulated drive"
        } else {
            "encoder on SPI2"
        }
    );
    // SAFETY: everything the interrupt needs is in SLOT.
    unsafe { NVIC::unmask(pac::Interrupt::TIM2) };
    idle(consumer, emulated)
}

/// Logs what the interrupt hands over.
fn idle(mut snapshots: Consumer<'static, Snapshot>, emulated: bool) -> ! {
    let mut controlled = false;
    let mut known = None;
    loop {
        let Some(now) = snapshots.dequeue() else {
            cortex_m::asm::wfi();
            continue;
        };
        defmt::info!(
            "{=u32} ms {}: position {=f32} mm, set {=f32} mm, command {=f32}; overruns {=u32}, dropped {=u32}, longest {=u32} us",
            now.tick,
            now.state,
            now.position,
            now.setpoint,
            now.command,
            now.overruns,
            now.dropped,
            now.longest
        );
        if let Some(model) = now.model
            && known != now.model
        {
            known = now.model;
            log::model(&model);
        }
        if now.stopped {
            defmt::error!(
                "{=u32} overruns in a row: safe output, watchdog fed {=u32} times",
                u32::from(LIMIT),
                now.fed
            );
        }
        if emulated {
            controlled |= now.state.is_controlling() && now.overruns == 0 && now.model.is_some();
            if now.tick == END - EVERY {
                PROVOKED.store(LIMIT, Ordering::Relaxed);
            }
            if now.tick >= END {
                let passed = controlled
                    && now.stopped
                    && now.overruns == u32::from(LIMIT)
                    && now.dropped == 0;
                debug::exit(if passed {
                    debug::EXIT_SUCCESS
                } else {
                    debug::EXIT_FAILURE
                });
            }
        }
    }
}
