//! The clock of Embassy by SysTick, one tick a millisecond.

use core::cell::{Cell, RefCell};
use core::task::Waker;

use cortex_m::interrupt::{Mutex, free};
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use embassy_time_driver::{Driver, TICK_HZ};
use embassy_time_queue_utils::Queue;

/// Clock of the core of the board that QEMU models.
const CORE_HZ: u64 = 168_000_000;

struct Clock {
    ticks: Mutex<Cell<u64>>,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: Clock = Clock {
    ticks: Mutex::new(Cell::new(0)),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

impl Driver for Clock {
    fn now(&self) -> u64 {
        free(|section| self.ticks.borrow(section).get())
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        // Every tick looks into the queue: no alarm is set.
        free(|section| {
            let _ = self
                .queue
                .borrow(section)
                .borrow_mut()
                .schedule_wake(at, waker);
        });
    }
}

/// Lets the ticks come.
pub fn start(timer: &mut SYST) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload((CORE_HZ / TICK_HZ - 1) as u32);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}

#[exception]
fn SysTick() {
    free(|section| {
        let ticks = CLOCK.ticks.borrow(section);
        ticks.set(ticks.get() + 1);
        CLOCK
            .queue
            .borrow(section)
            .borrow_mut()
            .next_expiration(ticks.get());
    });
}
