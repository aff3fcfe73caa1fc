//! A verified model that survives the loss of power: records in two sectors of NOR flash.
//!
//! # What holds
//! *At every instant, also when power fails within an operation, the flash holds the model before
//! or the model after, and a reader can tell which bytes are a model.* The reason, for any flash
//! that keeps the promise of [`NorFlash`] (an operation touches only its own range):
//!
//! 1. Records are only ever written to bytes that are erased, behind the newest record in its
//!    sector or at the begin of the other one: no operation touches a record that counts. Only
//!    the *other* sector is ever erased, in which no record is the newest.
//! 2. A record that was cut off does not end in its own CRC-32, which is programmed with it.
//!    [`Record`] finds every error of up to three bits and every burst of up to 32 bits; what else
//!    passes is one in 2^32. It is stepped over, not repaired.
//! 3. The newest record is the one of the largest sequence number. One record a minute reaches 2^32
//!    after 8000 years.
//!
//! A record of another version, machine or configuration is refused with the reason ([`Refused`]).
//! What is read is not valid yet: [`ServoLoop::resume`](crate::servo::ServoLoop::resume) holds
//! it against every limit that a candidate of the identifier must keep.
//!
//! # Where the time goes
//! Never call [`ModelStore::save`] in the path of a sample. On an STM32F405 programming one record
//! stalls reads of the same bank for about 0.4 ms, erasing a sector of 16 KiB for 0.25 s and of 128
//! KiB for 1 s (typical figures of the data sheet for words of 32 bits, tables of flash
//! programming), in which no code runs from flash and no watchdog is fed. A driver that writes
//! bytes, such as that of stm32f4xx-hal, takes 1.5 ms, 0.4 s and 2 s, and 4 s at most.
//! [`ModelStore::must_erase`] is true beforehand; [`ModelStore::make_room`] does it where the time
//! is, at the start before anything moves.
//! [`Keeper`] decides when a model is worth a record.
//!
//! Not a general file system: one kind of record, two sectors. A log-structured map as in
//! `sequential-storage` does more, behind async traits and with an erase inside a call that the
//! caller cannot foresee, and this store must warn the caller before it stalls the chip.

mod keeper;
mod record;

use embedded_storage::nor_flash::NorFlash;

pub use keeper::Keeper;
pub use record::{Identity, Record, Refused};

/// Bytes of a record: a multiple of every write size up to 32.
pub const RECORD_BYTES: usize = record::BYTES;

/// Errors of a store; `E` is the error of the flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StoreError<E> {
    /// The flash reported an error.
    Flash(E),
    /// The two sectors do not begin at an erase block, hold no record, or lie beyond the capacity.
    Place,
    /// The flash writes in units that do not divide a record, or erases in units that do not divide
    /// a sector.
    Unit,
    /// The written record does not read back; the record before it still counts.
    NotKept,
    /// There is no model to load.
    Refused(Refused),
}

/// Two adjoining sectors of a flash, and the records in them.
#[derive(Debug)]
pub struct ModelStore<F> {
    flash: F,
    /// First byte of the first sector.
    begin: u32,
    /// Bytes of a sector.
    sector: u32,
}

/// Where a record stands: sector 0 or 1, and its number in the sector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct RecordPlace {
    sector: u32,
    number: u32,
}

impl<F: NorFlash> ModelStore<F> {
    /// A store in `begin .. begin + 2 sector` of `flash`; nothing is read or written yet.
    ///
    /// # Errors
    /// [`StoreError::Place`], [`StoreError::Unit`].
    pub fn new(flash: F, begin: u32, sector: u32) -> Result<Self, StoreError<F::Error>> {
        let (erase, write) = (F::ERASE_SIZE, F::WRITE_SIZE);
        if write == 0 || erase == 0 || !RECORD_BYTES.is_multiple_of(write) {
            return Err(StoreError::Unit);
        }
        let (first, bytes) = (begin as usize, sector as usize);
        if !bytes.is_multiple_of(erase) {
            return Err(StoreError::Unit);
        }
        let end = bytes
            .checked_mul(2)
            .and_then(|both| both.checked_add(first));
        let fits = end.is_some_and(|end| end <= flash.capacity() && u32::try_from(end).is_ok());
        if !fits || bytes < RECORD_BYTES || !first.is_multiple_of(erase) {
            return Err(StoreError::Place);
        }
        Ok(Self {
            flash,
            begin,
            sector,
        })
    }

    /// Gives the flash back.
    pub fn release(self) -> F {
        self.flash
    }

    /// The newest record.
    ///
    /// # Errors
    /// [`StoreError::Refused`] with the reason, or an error of the flash.
    pub fn load(&mut self, identity: &Identity) -> Result<Record, StoreError<F::Error>> {
        let scan = self.scan()?;
        match scan.newest {
            Some((_, _, bytes)) => Record::decode(&bytes, identity).map_err(StoreError::Refused),
            None if scan.damaged > 0 => Err(StoreError::Refused(Refused::Damaged {
                records: scan.damaged,
            })),
            None => Err(StoreError::Refused(Refused::Empty)),
        }
    }

    /// Whether the next [`save`](Self::save) erases a sector first.
    ///
    /// # Errors
    /// An error of the flash.
    pub fn must_erase(&mut self) -> Result<bool, StoreError<F::Error>> {
        let newest = self.scan()?.newest.map(|(place, ..)| place);
        Ok(self.room(newest)?.is_none())
    }

    /// Erases a sector now if the next [`save`](Self::save) would have to.
    ///
    /// # Errors
    /// An error of the flash; the newest record still counts then.
    pub fn make_room(&mut self) -> Result<(), StoreError<F::Error>> {
        let newest = self.scan()?.newest.map(|(place, ..)| place);
        if self.room(newest)?.is_none() {
            self.erased(newest)?;
        }
        Ok(())
    }

    /// Writes a record behind the newest one, and reads it back; erases a sector first when there
    /// is no room.
    ///
    /// # Errors
    /// An error of the flash, or [`StoreError::NotKept`]; the record before still counts then.
    pub fn save(
        &mut self,
        identity: &Identity,
        record: &Record,
    ) -> Result<(), StoreError<F::Error>> {
        let newest = self.scan()?.newest;
        let sequence = newest.map_or(0, |(_, sequence, _)| sequence.wrapping_add(1));
        let newest = newest.map(|(place, ..)| place);
        let place = match self.room(newest)? {
            Some(place) => place,
            None => self.erased(newest)?,
        };
        let bytes = record.encode(identity, sequence);
        let at = self.address(place);
        self.flash.write(at, &bytes).map_err(StoreError::Flash)?;
        if self.read(place)? == bytes {
            Ok(())
        } else {
            Err(StoreError::NotKept)
        }
    }

    /// Erases the sector in which the newest record is not.
    fn erased(&mut self, newest: Option<RecordPlace>) -> Result<RecordPlace, StoreError<F::Error>> {
        let place = RecordPlace {
            sector: newest.map_or(0, |place| 1 - place.sector),
            number: 0,
        };
        let begin = self.address(place);
        self.flash
            .erase(begin, begin + self.sector)
            .map_err(StoreError::Flash)?;
        Ok(place)
    }

    /// Where the next record goes: behind the newest one in its sector, else at the begin of the
    /// other when that is blank.
    fn room(
        &mut self,
        newest: Option<RecordPlace>,
    ) -> Result<Option<RecordPlace>, StoreError<F::Error>> {
        let (sector, after) = newest.map_or((0, 0), |place| (place.sector, place.number + 1));
        if let Some(place) = self.blank(sector, after)? {
            return Ok(Some(place));
        }
        let other = self.blank(1 - sector, 0)?;
        Ok(other.filter(|place| place.number == 0))
    }

    /// The first place of `sector`, from `after` on, from which on all is erased.
    fn blank(
        &mut self,
        sector: u32,
        after: u32,
    ) -> Result<Option<RecordPlace>, StoreError<F::Error>> {
        let mut blank = None;
        // From the end: behind a blank place may be no other byte, as half an erase would leave it.
        for number in (after..self.places()).rev() {
            let place = RecordPlace { sector, number };
            if self.read(place)? != [0xFF; RECORD_BYTES] {
                break;
            }
            blank = Some(place);
        }
        Ok(blank)
    }

    /// Reads every record.
    fn scan(&mut self) -> Result<Scan, StoreError<F::Error>> {
        let mut scan = Scan {
            newest: None,
            damaged: 0,
        };
        for sector in 0..2 {
            for number in 0..self.places() {
                let place = RecordPlace { sector, number };
                let bytes = self.read(place)?;
                if bytes == [0xFF; RECORD_BYTES] {
                    continue;
                }
                let Some(sequence) = record::sequence(&bytes) else {
                    scan.damaged = scan.damaged.saturating_add(1);
                    continue;
                };
                if scan.newest.is_none_or(|(_, known, _)| sequence > known) {
                    scan.newest = Some((place, sequence, bytes));
                }
            }
        }
        Ok(scan)
    }

    /// Records that a sector holds.
    const fn places(&self) -> u32 {
        self.sector / RECORD_BYTES as u32
    }

    const fn address(&self, place: RecordPlace) -> u32 {
        self.begin + place.sector * self.sector + place.number * RECORD_BYTES as u32
    }

    fn read(&mut self, place: RecordPlace) -> Result<[u8; RECORD_BYTES], StoreError<F::Error>> {
        let mut bytes = [0; RECORD_BYTES];
        let at = self.address(place) as usize;
        // The unit of reading divides that of writing.
        self.flash
            .read(at as u32, &mut bytes)
            .map_err(StoreError::Flash)?;
        Ok(bytes)
    }
}

/// Content of the sectors.
struct Scan {
    /// Place, sequence number and bytes of the newest record.
    newest: Option<(RecordPlace, u32, [u8; RECORD_BYTES])>,
    /// Places that are neither erased nor a record.
    damaged: u32,
}

#[cfg(test)]
mod tests;
