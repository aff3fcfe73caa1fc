//! Nothing but one update of the reference structure: what the core needs in flash, and the proof
//! that it cannot panic.
//!
//! `cargo xtask size` reads the image: it must not contain any function of the panic machinery. The
//! identifier is a place in memory that is not initialised, because its construction belongs to the
//! start and not to the 1 ms path; the image is not meant to be run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use core::mem::MaybeUninit;

    use cortex_m_rt::entry;
    #[cfg(target_abi = "eabihf")]
    use stm32f4xx_hal as _;
    use trendid::Identifier;
    use trendid::trends::FilteredTrends;

    static mut IDENTIFIER: MaybeUninit<Identifier<FilteredTrends<3>, 3, 3>> = MaybeUninit::uninit();
    static mut SAMPLE: [f32; 3] = [0.0; 3];

    #[entry]
    fn main() -> ! {
        let sample = &raw mut SAMPLE;
        let identifier = &raw mut IDENTIFIER;
        loop {
            // SAFETY: one thread without interrupts. The image is read and never run.
            unsafe {
                let [u, y, _] = sample.read_volatile();
                let innovation = (*identifier).assume_init_mut().update(u, y).innovation();
                sample.write_volatile([u, y, innovation.unwrap_or(0.0)]);
            }
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {}
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    type Identifier = trendid::Identifier<trendid::trends::FilteredTrends<3>, 3, 3>;
    println!(
        "the identifier of three parameters takes {} bytes of RAM",
        size_of::<Identifier>()
    );
    println!("`cargo xtask size` tells the flash");
}
