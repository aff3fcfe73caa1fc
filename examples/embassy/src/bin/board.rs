//! The image of a board with an STM32F405/407 and a crystal of 8 MHz, on embassy-stm32; line on PA9
//! (out) and PA10 (in).
//!
//! Compiled with every change, not tried on a board.
#![no_std]
#![no_main]

use core::sync::atomic::Ordering;

use embassy_executor::{Executor, InterruptExecutor};
use embassy_stm32::interrupt::{self, InterruptExt as _, Priority};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::mhz;
use embassy_stm32::usart::{self, BufferedUart, BufferedUartRx, BufferedUartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, peripherals};
use embassy_time::Timer;
use static_cell::StaticCell;
use trendid::hardware::Valve;
use trendid_example_embassy::{Output, SAMPLES, Sensor, control, listen, tell};
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::guard::Progress;
use trendid_example_support::machine::{Machine, ORIGIN};

static HIGH: InterruptExecutor = InterruptExecutor::new();
static LOW: StaticCell<Executor> = StaticCell::new();

/// Bytes of the line on their way.
static SENT: StaticCell<[u8; 256]> = StaticCell::new();
static RECEIVED: StaticCell<[u8; 64]> = StaticCell::new();

/// Time in which the watchdog must be fed.
const WATCHDOG_US: u32 = 20_000;

bind_interrupts!(struct Interrupts {
    USART1 => usart::BufferedInterruptHandler<peripherals::USART1>;
});

#[embassy_stm32::interrupt]
unsafe fn UART5() {
    // SAFETY: the handler of its executor, which is started before the interrupt is let in.
    unsafe { HIGH.on_interrupt() }
}

#[embassy_executor::task]
async fn control_task(machine: Machine<Sensor, Output>) {
    control(machine).await;
}

#[embassy_executor::task]
async fn listen_task(line: BufferedUartRx<'static>) {
    listen(line).await
}

#[embassy_executor::task]
async fn tell_task(line: BufferedUartTx<'static>) {
    let _ = tell(line, || ()).await;
}

/// Restarts the chip when control has taken no sample for longer than its time, or this executor
/// was kept from running.
#[embassy_executor::task]
async fn watchdog_task(mut watchdog: IndependentWatchdog<'static, peripherals::IWDG>) {
    watchdog.unleash();
    let mut control = Progress::new();
    loop {
        if control.goes_on(SAMPLES.load(Ordering::Relaxed)) {
            watchdog.pet();
        }
        Timer::after_millis(2).await;
    }
}

/// 168 MHz from a crystal of 8 MHz.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse {
        freq: mhz(8),
        mode: HseMode::Oscillator,
    });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let chip = embassy_stm32::init(clocks());
    // The settings are constants, and valid.
    let machine = Machine::try_new(Drive::new(ORIGIN), SimulatedValve).unwrap();
    let line = BufferedUart::new(
        chip.USART1,
        chip.PA10,
        chip.PA9,
        SENT.init([0; 256]),
        RECEIVED.init([0; 64]),
        Interrupts,
        usart::Config::default(),
    )
    .unwrap();
    let (sender, receiver) = line.split();
    let watchdog = IndependentWatchdog::new(chip.IWDG, WATCHDOG_US);

    interrupt::UART5.set_priority(Priority::P2);
    let high = HIGH.start(interrupt::UART5);
    high.spawn(control_task(machine).unwrap());
    LOW.init(Executor::new()).run(|low| {
        low.spawn(listen_task(receiver).unwrap());
        low.spawn(tell_task(sender).unwrap());
        low.spawn(watchdog_task(watchdog).unwrap());
    })
}

/// The valve comes to rest, and the watchdog restarts the chip.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    // On a machine: by the registers of the output, whose driver is in the hands of the task that
    // panicked.
    let _ = SimulatedValve.safe();
    loop {
        cortex_m::asm::nop();
    }
}
