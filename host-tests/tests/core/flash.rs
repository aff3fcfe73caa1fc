//! A simulated NOR flash that loses its power where a test says.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Bytes of a sector: room for three records, and 32 bytes that are left over.
pub(crate) const SECTOR: usize = 320;

/// What became of an operation in which power failed: NOR flash programs bits to 0 and erases to 1,
/// in any order.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cut {
    /// After so many bytes.
    Bytes(usize),
    /// Every byte, but only the bits of this mask.
    Bits(u8),
}

/// NOR flash of two sectors, of which the operation number `cut` loses its power.
#[derive(Debug, Clone)]
pub(crate) struct Flash {
    pub(crate) bytes: [u8; 2 * SECTOR],
    pub(crate) operations: usize,
    pub(crate) cut: Option<(usize, Cut)>,
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    Power,
    Bounds,
}

impl NorFlashError for Fault {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Flash {
    pub(crate) const fn new() -> Self {
        Self {
            bytes: [0xFF; 2 * SECTOR],
            operations: 0,
            cut: None,
        }
    }

    /// The bytes `range` through `operation`, as far as power lasts.
    fn run(
        &mut self,
        range: std::ops::Range<usize>,
        operation: impl Fn(usize, u8) -> u8,
    ) -> Result<(), Fault> {
        let place = self.bytes.get_mut(range).ok_or(Fault::Bounds)?;
        let cut = self.cut.filter(|(at, _)| *at == self.operations);
        self.operations += 1;
        for (k, byte) in place.iter_mut().enumerate() {
            let new = operation(k, *byte);
            match cut {
                Some((_, Cut::Bytes(bytes))) if k >= bytes => return Err(Fault::Power),
                Some((_, Cut::Bits(mask))) => *byte = (new & mask) | (*byte & !mask),
                _ => *byte = new,
            }
        }
        cut.map_or(Ok(()), |_| Err(Fault::Power))
    }
}

impl ErrorType for Flash {
    type Error = Fault;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Fault> {
        let begin = offset as usize;
        let place = self.bytes.get(begin..begin + bytes.len());
        bytes.copy_from_slice(place.ok_or(Fault::Bounds)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Fault> {
        assert!((from as usize).is_multiple_of(SECTOR) && (to as usize).is_multiple_of(SECTOR));
        self.run(from as usize..to as usize, |_, _| 0xFF)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Fault> {
        let begin = offset as usize;
        assert!(begin.is_multiple_of(4) && bytes.len().is_multiple_of(4));
        self.run(begin..begin + bytes.len(), |k, old| old & bytes[k])
    }
}
