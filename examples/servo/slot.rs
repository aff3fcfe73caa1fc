//! The 1 ms slot of the servo controller.

pub(crate) mod requests;

use core::cell::RefCell;
use core::mem::{Discriminant, discriminant};
use core::sync::atomic::Ordering;

use cortex_m::interrupt::{Mutex, free};
use heapless::spsc::Producer;
use stm32f4xx_hal::pac::{TIM2, TIM5};
use stm32f4xx_hal::timer::{CounterHz, Flag};
use stm32f4xx_hal::watchdog::IndependentWatchdog;
use stm32f4xx_hal::{ReadFlags, pac::interrupt};
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Config, ServoLoop, State};
use trendid_example_support::guard::{self, Guard, Verdict};
use trendid_example_support::machine::{AXIS, TRACED, Trace, Verified, config, target};
use trendid_example_support::slots::Slots;
use trendid_example_support::survivor::{Fault, Text};
use trendid_link::telemetry::{Event, text};

use crate::snapshot::{EVERY, Snapshot};
use crate::wire::Wire;
use crate::wiring::{FRESH, Output, Panel, Sensor};
use crate::{emulated, survival};

/// Time in which a slot must have fed the watchdog.
pub(crate) const WATCHDOG_MS: u32 = 10;

/// The fault of a watchdog that does not take its period.
pub(crate) const UNWATCHED: &str = "the watchdog does not run";

/// Everything the interrupt owns.
pub(crate) struct Slot {
    servo: ServoLoop<Sensor, Output>,
    /// Its settings.
    config: Config,
    timer: CounterHz<TIM2>,
    /// Ticks of the timer per slot.
    period: u32,
    watchdog: IndependentWatchdog,
    panel: Panel,
    wire: Option<Wire>,
    /// Moved over the wire, and not between the targets.
    guided: bool,
    out: Producer<'static, Snapshot>,
    now: Snapshot,
    /// The state that the idle loop was told last.
    told: Discriminant<State>,
    slots: Slots,
    guard: Guard,
}

static SLOT: Mutex<RefCell<Option<Slot>>> = Mutex::new(RefCell::new(None));

/// Gives the interrupt what it owns.
pub(crate) fn hand_over(slot: Slot) {
    free(|section| SLOT.borrow(section).replace(Some(slot)));
}

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
    /// A slot that waits for a request; `stopped` when a fault is latched.
    pub(crate) fn new(
        servo: ServoLoop<Sensor, Output>,
        timer: CounterHz<TIM2>,
        period: u32,
        watchdog: IndependentWatchdog,
        (panel, wire): (Panel, Option<Wire>),
        out: Producer<'static, Snapshot>,
        stopped: bool,
    ) -> Self {
        let now = Snapshot {
            tick: 0,
            state: State::Idle,
            position: 0.0,
            setpoint: 0.0,
            command: 0.0,
            overruns: 0,
            missed: 0,
            dropped: 0,
            stopped,
            refused: 0,
            longest: 0,
            trace: Trace::new(),
            verified: None,
            store: false,
        };
        Self {
            servo,
            config: config(),
            timer,
            period,
            watchdog,
            panel,
            wire,
            // Between the targets only when the button asks for it: a model from the flash takes
            // control without anybody.
            guided: true,
            out,
            now,
            told: discriminant(&State::Idle),
            slots: Slots::new(period),
            guard: Guard::new(),
        }
    }

    fn run(&mut self) {
        let begin = count();
        // Ends the request, so that the next one shows whether this slot was too long.
        let _ = self.timer.wait();
        // The counter of the chip begins again with each slot, that of the emulator runs on.
        let (now, since) = match self.panel {
            Panel::Button(..) => (running(), begin),
            Panel::Emulated => (emulated::counter(self.period), 0),
        };
        let missed = self.slots.missed(now, since);
        self.now.missed = self.now.missed.saturating_add(missed);
        self.now.tick += 1 + u64::from(missed);
        let moves = self.moves() && !self.now.stopped;
        if let Some(request) = self.panel.request(moves) {
            self.answer(request);
        }
        self.over_the_wire();
        if self.now.stopped {
            self.rest();
        } else {
            self.control(begin, missed);
        }
        if self.now.tick / EVERY != (self.now.tick - 1 - u64::from(missed)) / EVERY {
            self.send();
        }
    }

    /// A slot after a fault: the safe output again and again, since a valve that missed it once
    /// must not stay open.
    fn rest(&mut self) {
        let safe = self.servo.valve_mut().safe().is_ok();
        self.now.command = 0.0;
        if let Ok(code) = self.servo.sensor_mut().counts() {
            self.now.position = AXIS.position(code);
        }
        let slots = [self.now.overruns, self.now.longest];
        if let Some(wire) = &mut self.wire {
            wire.rests(self.now.tick as u32, self.now.position, slots);
        }
        // Stopped is a state in which the chip may stay, so that the fault can be read.
        if Guard::rest(safe, self.late()) == Verdict::Feed {
            self.watchdog.feed();
        }
    }

    fn control(&mut self, begin: u32, missed: u32) {
        if !self.guided
            && self.now.state.is_controlling()
            && let Some(target) =
                (self.now.tick - u64::from(missed)..=self.now.tick).find_map(target)
        {
            // The targets are finite: nothing to refuse.
            let _ = self.servo.move_to(target);
        }
        self.servo.skip(missed);
        let report = self.servo.update();
        if matches!(self.panel, Panel::Emulated) && self.now.tick <= TRACED {
            self.now.trace.take(&report);
        }
        if let Some(wire) = &mut self.wire {
            let slots = [self.now.overruns, self.now.longest];
            if wire.sample(self.now.tick as u32, &report, &self.servo, slots) {
                self.servo.abort();
            }
        }
        self.now.state = report.state;
        self.now.position = report.position;
        self.now.setpoint = report.setpoint.position;
        self.now.command = report.command;
        emulated::provoke(self.period, || while !self.late() {});
        let slot = guard::Slot {
            missed,
            late: self.late(),
            fresh: FRESH.swap(false, Ordering::Relaxed),
            fault: match report.state {
                State::Failed(reason) => guard::fault(reason),
                _ => None,
            },
        };
        if slot.late {
            self.now.overruns = self.now.overruns.saturating_add(1);
            self.tell(Event::Overrun);
        }
        match self.guard.control(&slot) {
            Verdict::Feed => self.watchdog.feed(),
            Verdict::Starve => {}
            Verdict::Stop(why) => self.stop(why),
        }
        if slot.late {
            return;
        }
        let end = count();
        let ticks = if end >= begin {
            end - begin
        } else {
            end + self.period - begin
        };
        let us = (u64::from(ticks) * 1000 / u64::from(self.period)) as u32;
        self.now.longest = self.now.longest.max(us);
        // Of a slot that was late, in the next one.
        let state = discriminant(&self.now.state);
        if state != self.told {
            self.told = state;
            self.now.verified = Verified::of(&self.servo, &self.config);
            self.send();
        }
    }

    /// The safe output until a person has acknowledged, over any restart.
    fn stop(&mut self, why: &'static str) {
        // Written again in every slot from now on.
        let _ = self.servo.valve_mut().safe();
        self.now.stopped = true;
        self.tell(Event::Fault(text(why)));
        survival::update(|survivor| {
            survivor.latch(Fault::Stopped {
                why: Text::end_of(why),
            });
        });
    }

    /// Over the wire.
    fn tell(&mut self, event: Event) {
        if let Some(wire) = &mut self.wire {
            wire.event(event);
        }
    }

    /// To the idle loop; whether there was room.
    fn send(&mut self) -> bool {
        let sent = self.out.enqueue(self.now.clone()).is_ok();
        if !sent {
            self.now.dropped = self.now.dropped.saturating_add(1);
        }
        sent
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

/// The counter that runs on over all slots, at the rate of the slot timer.
fn running() -> u32 {
    // SAFETY: as above.
    unsafe { (*TIM5::ptr()).cnt().read().bits() }
}
