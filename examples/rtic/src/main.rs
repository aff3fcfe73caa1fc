//! The servo loop in RTIC 2: control by its priority, requests and log below it.
//!
//! | task | kind | priority | does |
//! |---|---|---|---|
//! | `slot` | interrupt of TIM2, every 1 ms | 3 | reads, identifies, controls, drives |
//! | `operator` | software, every 500 samples | 2 | asks for what is due in the next 500 samples |
//! | `log` | software, when there is something to show | 1 | formats and sends |
//!
//! Requests stand in a queue that `slot` and `operator` share; RTIC's lock keeps `slot` out for the
//! few instructions of a push, and costs `slot` itself nothing, because nobody stands above it. A
//! request names the sample in which it is due, so that it does not matter when it is heard before
//! that. What `slot` shows goes through a queue of one writer and one reader, without a lock; when
//! `log` is late, messages are dropped and counted, and control goes on.
//!
//! The drive is the simulated one, on a board too. For a machine, [`Sensor`] and [`Output`] become
//! the drivers of `trendid::hardware` as in `examples/servo/wiring.rs`, and a fault is latched as
//! in `examples/servo/slot.rs`.
#![no_std]
#![no_main]

mod debugger;
mod logger;
mod rest;

use trendid::servo::State;
use trendid_example_support::drive::{Drive, SimulatedValve};

/// The position sensor of the machine.
type Sensor = Drive;
/// The valve of the machine.
type Output = SimulatedValve;

/// Samples between two lines of the log, and between two looks of the operator.
const EVERY: u64 = 500;

/// What `slot` shows.
#[derive(Clone, Copy)]
struct Snapshot {
    tick: u64,
    state: State,
    position: f32,
    setpoint: f32,
    command: f32,
    /// Messages that found no room.
    dropped: u32,
    /// Hash of what was done so far.
    hash: u64,
}

#[rtic::app(device = stm32f4xx_hal::pac, dispatchers = [EXTI0, EXTI1])]
mod app {
    use cortex_m_semihosting::debug;
    use heapless::Deque;
    use heapless::spsc::{Consumer, Producer, Queue};
    use stm32f4xx_hal::pac::TIM2;
    use stm32f4xx_hal::timer::{CounterHz, Event};
    use stm32f4xx_hal::watchdog::IndependentWatchdog;
    use stm32f4xx_hal::{prelude::*, rcc};
    use trendid_example_support::drive::{Drive, SimulatedValve};
    use trendid_example_support::machine::{Machine, ORIGIN, TRACED, plan};
    use trendid_example_support::request::Request;

    use crate::{EVERY, Output, Sensor, Snapshot, logger};

    /// Ticks of TIM2 per second in QEMU, whatever the clock control says.
    const EMULATED_HZ: u32 = 1_000_000_000;
    /// Frequency of the crystal of the board.
    const CRYSTAL_MHZ: u32 = 8;
    /// Time in which a slot must have fed the watchdog.
    const WATCHDOG_MS: u32 = 10;

    #[shared]
    struct Shared {
        requests: Deque<Request, 8>,
    }

    #[local]
    struct Local {
        machine: Machine<Sensor, Output>,
        timer: CounterHz<TIM2>,
        watchdog: IndependentWatchdog,
        shown: Option<trendid::servo::State>,
        dropped: u32,
        out: Producer<'static, Snapshot>,
        messages: Consumer<'static, Snapshot>,
        emulated: bool,
    }

    #[init(local = [queue: Queue<Snapshot, 32> = Queue::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let chip = context.device;
        // The internal oscillator runs after reset on every chip; a clock control that does not
        // know it is QEMU's.
        let emulated = chip.RCC.cr().read().hsirdy().bit_is_clear();
        let clock = if emulated {
            logger::FRAMES.go_over_semihosting();
            rcc::Config::hsi()
        } else {
            rcc::Config::hse(CRYSTAL_MHZ.MHz()).sysclk(168.MHz())
        };
        let mut rcc = chip.RCC.freeze(clock);
        defmt::info!("trendid in RTIC, simulated drive");

        // The settings are constants, and valid.
        let machine = Machine::try_new(Drive::new(ORIGIN), SimulatedValve).unwrap();
        let mut timer = chip.TIM2.counter_hz(&mut rcc);
        // QEMU counts with its own frequency, so there the rate is that of a clock which is so much
        // slower.
        let rate = if emulated {
            1000 * (rcc.clocks.timclk1().raw() / 1000) / (EMULATED_HZ / 1000)
        } else {
            1000
        };
        timer.start(rate.Hz()).unwrap();
        timer.listen(Event::Update);
        let mut watchdog = IndependentWatchdog::new(chip.IWDG);
        watchdog.start(WATCHDOG_MS.millis());

        let (out, messages) = context.local.queue.split();
        // The queue of the tasks is empty.
        let _ = operator::spawn(1);
        let shared = Shared {
            requests: Deque::new(),
        };
        let local = Local {
            machine,
            timer,
            watchdog,
            shown: None,
            dropped: 0,
            out,
            messages,
            emulated,
        };
        (shared, local)
    }

    /// Sleeps; without it, RTIC would spin.
    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }

    /// One sample.
    #[task(binds = TIM2, priority = 3, local = [machine, timer, watchdog, shown, dropped, out], shared = [requests])]
    fn slot(mut context: slot::Context) {
        let local = context.local;
        let _ = local.timer.wait();
        let tick = local.machine.next_tick();
        let due = context.shared.requests.lock(|requests| {
            let due = requests.front().is_some_and(|first| first.tick <= tick);
            due.then(|| requests.pop_front()).flatten()
        });
        let report = local.machine.update(due.map(|request| request.action));
        local.watchdog.feed();

        if *local.shown != Some(report.state) || tick.is_multiple_of(EVERY) {
            *local.shown = Some(report.state);
            let message = Snapshot {
                tick,
                state: report.state,
                position: report.position,
                setpoint: report.setpoint.position,
                command: report.command,
                dropped: *local.dropped,
                hash: local.machine.trace().value(),
            };
            *local.dropped += u32::from(local.out.enqueue(message).is_err());
            // A log that is still busy takes this message too.
            let _ = log::spawn();
        }
        if tick.is_multiple_of(EVERY) {
            // An operator that is still busy misses a look.
            let _ = operator::spawn(tick + 1);
        }
    }

    /// In the place of a person and of the control above: asks for what is due from sample `from`
    /// on.
    #[task(priority = 2, shared = [requests])]
    async fn operator(mut context: operator::Context, from: u64) {
        for request in (from..from + EVERY).filter_map(plan) {
            let heard = context
                .shared
                .requests
                .lock(|requests| requests.push_back(request).is_ok());
            if !heard {
                defmt::error!("no room for a request");
            }
        }
    }

    /// Shows what happened; ends the emulator after the samples that are compared.
    #[task(priority = 1, local = [messages, emulated])]
    async fn log(context: log::Context) {
        while let Some(now) = context.local.messages.dequeue() {
            defmt::info!(
                "{=u64} ms {}: position {=f32} mm, set {=f32} mm, command {=f32}; dropped {=u32}",
                now.tick,
                now.state,
                now.position,
                now.setpoint,
                now.command,
                now.dropped
            );
            if now.tick >= TRACED && *context.local.emulated {
                defmt::info!("hash of {=u64} samples: {=u64:016x}", TRACED, now.hash);
                debug::exit(debug::EXIT_SUCCESS);
            }
        }
    }
}
