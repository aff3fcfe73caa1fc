//! The verified model in the last two sectors of the flash: loaded after a reset, saved by the idle
//! loop.
//!
//! The emulator has no flash controller, so there nothing is loaded or saved. What the store does
//! is tested on a simulated flash on the host (`host-tests/tests/core/store.rs`); its flash here is
//! the HAL's. Not tried on a board.

use stm32f4xx_hal::flash::{FlashExt, LockedFlash};
use stm32f4xx_hal::pac;
use trendid::servo::store::{Keeper, ModelStore, Record, StoreError};

use trendid_example_support::machine::{Verified, config, identity};

/// The sectors 10 and 11; `memory.x` keeps the image out of them.
const BEGIN: u32 = 0xC_0000;
const SECTOR: u32 = 0x2_0000;

/// The memory of the machine.
pub(crate) struct Keep {
    flash: LockedFlash,
    keeper: Keeper,
}

impl Keep {
    /// What the flash holds, and its record; makes room for the next ones, which may take a second.
    pub(crate) fn load(flash: pac::FLASH) -> (Self, Option<Record>) {
        let mut flash = LockedFlash::new(flash);
        let identity = identity(&config());
        let loaded = ModelStore::new(flash.unlocked(), BEGIN, SECTOR).and_then(|mut store| {
            let loaded = store.load(&identity);
            if store.make_room().is_err() {
                defmt::error!("the flash has no room for another model");
            }
            loaded
        });
        let record = match loaded {
            Ok(record) => {
                defmt::info!("stored model: {}", record.model);
                Some(record)
            }
            Err(StoreError::Refused(reason)) => {
                defmt::info!("no stored model: {}", reason);
                None
            }
            Err(_) => {
                defmt::error!("the flash cannot be read");
                None
            }
        };
        let keeper = Keeper::new(record.as_ref().map(|record| record.model));
        (Self { flash, keeper }, record)
    }

    /// Saves a verified model that is worth it, a byte at a time, which delays a slot by 100 us at
    /// most. One of settings that the next start does not have is of no use to it, and would stand
    /// before the one that is: that is saved for a request only.
    ///
    /// A sector that is full is erased at the next start: here it would stop the chip for longer
    /// than the watchdog waits.
    pub(crate) fn consider(&mut self, verified: &Verified, seconds: u32) {
        if verified.is_of_the_program() && self.keeper.is_due(&verified.record.model, seconds) {
            self.store(verified, seconds);
        }
    }

    /// The same for one that somebody asked for; whether it was saved.
    pub(crate) fn store(&mut self, verified: &Verified, seconds: u32) -> bool {
        let saved = self.save(verified).is_some();
        if saved {
            self.keeper.saved(&verified.record.model, seconds);
            defmt::info!("model stored");
        } else {
            self.keeper.failed(seconds);
            defmt::error!("the model could not be stored");
        }
        saved
    }

    /// Saves what was verified where no sector must be erased for it, under the settings of then:
    /// the next start, which has its own, tells them apart.
    fn save(&mut self, verified: &Verified) -> Option<()> {
        let mut store = ModelStore::new(self.flash.unlocked(), BEGIN, SECTOR).ok()?;
        let full = store.must_erase().ok()?;
        (!full).then(|| store.save(&verified.identity, &verified.record).ok())?
    }
}
