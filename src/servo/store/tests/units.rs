//! A flash and its units.

use core::convert::Infallible;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

use crate::servo::store::{ModelStore, StoreError};

/// Erased flash that is written in units of `WRITE` and erased in units of `ERASE` bytes.
struct Units<const WRITE: usize, const ERASE: usize>;

impl<const WRITE: usize, const ERASE: usize> ErrorType for Units<WRITE, ERASE> {
    type Error = Infallible;
}

impl<const WRITE: usize, const ERASE: usize> ReadNorFlash for Units<WRITE, ERASE> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, _: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.fill(0xFF);
        Ok(())
    }

    fn capacity(&self) -> usize {
        1 << 20
    }
}

impl<const WRITE: usize, const ERASE: usize> NorFlash for Units<WRITE, ERASE> {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = ERASE;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), Infallible> {
        Ok(())
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn a_flash_whose_units_divide_no_record_or_no_sector_is_refused() {
    fn made<const WRITE: usize, const ERASE: usize>() -> Result<(), StoreError<Infallible>> {
        ModelStore::new(Units::<WRITE, ERASE>, 0, 4096).map(drop)
    }
    let good = [
        made::<1, 1>(),
        made::<4, 256>(),
        made::<8, 2048>(),
        made::<16, 4096>(),
        made::<32, 4096>(),
    ];
    assert_eq!(good, [Ok(()); 5]);
    let bad = [
        made::<0, 4096>(),
        made::<64, 4096>(),
        made::<256, 4096>(),
        made::<4, 0>(),
        made::<4, 3072>(),
        made::<4, 8192>(),
    ];
    assert_eq!(bad, [Err(StoreError::Unit); 6]);
}
