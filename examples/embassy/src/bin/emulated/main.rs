//! The image of the emulator: a clock by SysTick, where embassy-stm32 waits for a clock control
//! that QEMU does not have.
//!
//! Both executors run in interrupts and the rest sleeps: the executor of the thread waits by an
//! instruction that QEMU does not count as sleep. The samples begin when all requests for those
//! that are compared were heard, since the line is not bound to the clock of the emulator; the last
//! line of these samples ends it.
#![no_std]
#![no_main]

mod clock;
mod line;

use cortex_m::peripheral::NVIC;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug;
use embassy_executor::InterruptExecutor;
use stm32f4xx_hal::pac::{CorePeripherals, Interrupt, Peripherals, interrupt};
use trendid_example_embassy::{Output, REQUESTS, Sensor, control, listen, tell};
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::machine::{Machine, ORIGIN, TRACED, plan};

use line::{Receiver, Sender};

static HIGH: InterruptExecutor = InterruptExecutor::new();
static LOW: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn EXTI0() {
    // SAFETY: the handler of its executor, which is started before the interrupt is let in.
    unsafe { HIGH.on_interrupt() }
}

#[interrupt]
fn EXTI1() {
    // SAFETY: as above.
    unsafe { LOW.on_interrupt() }
}

#[embassy_executor::task]
async fn control_task(machine: Machine<Sensor, Output>) {
    let planned = (1..=TRACED).filter_map(plan).count();
    while REQUESTS.len() < planned {
        embassy_time::Timer::after_millis(1).await;
    }
    control(machine).await;
}

#[embassy_executor::task]
async fn listen_task(line: Receiver) {
    listen(line).await
}

#[embassy_executor::task]
async fn tell_task(line: Sender) {
    let Ok(()) = tell(line, || debug::exit(debug::EXIT_SUCCESS)).await;
}

#[entry]
fn main() -> ! {
    let (Some(mut core), Some(chip)) = (CorePeripherals::take(), Peripherals::take()) else {
        unreachable!("the first lines of the image");
    };
    // SAFETY: no critical section is made of priorities.
    unsafe {
        core.NVIC.set_priority(Interrupt::EXTI0, 2 << 4);
        core.NVIC.set_priority(Interrupt::EXTI1, 6 << 4);
        core.NVIC.set_priority(Interrupt::USART1, 4 << 4);
    }
    clock::start(&mut core.SYST);
    let (receiver, sender) = line::open(chip.USART1);
    // SAFETY: its handler is in place.
    unsafe { NVIC::unmask(Interrupt::USART1) };
    // The settings are constants, and valid.
    let machine = Machine::try_new(Drive::new(ORIGIN), SimulatedValve).unwrap();
    HIGH.start(Interrupt::EXTI0)
        .spawn(control_task(machine).unwrap());
    let low = LOW.start(Interrupt::EXTI1);
    low.spawn(listen_task(receiver).unwrap());
    low.spawn(tell_task(sender).unwrap());
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    if let Ok(mut out) = cortex_m_semihosting::hio::hstdout() {
        // Without a debugger there is no receiver.
        let _ = core::fmt::Write::write_fmt(&mut out, format_args!("{info}\n"));
    }
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::nop();
    }
}
