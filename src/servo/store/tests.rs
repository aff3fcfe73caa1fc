//! The store somewhere in a flash that is larger than it.

extern crate std;

mod units;

use super::*;
use crate::servo::{Config, Model, Travel};
use core::convert::Infallible;
use embedded_storage::nor_flash::{ErrorType, ReadNorFlash};

/// Bytes of a sector: room for two records, and 64 bytes that are left over.
const SECTOR: usize = 256;

/// Four sectors, of which the store has the second and the third.
#[derive(Clone, Debug, PartialEq)]
struct Flash([u8; 4 * SECTOR]);

impl ErrorType for Flash {
    type Error = Infallible;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        let begin = offset as usize;
        bytes.copy_from_slice(&self.0[begin..begin + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        self.0[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        let begin = offset as usize;
        for (old, new) in self.0[begin..].iter_mut().zip(bytes) {
            *old &= new;
        }
        Ok(())
    }
}

fn identity() -> Identity {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    Identity::new(7, &Config::new(0.001, 20.0, travel))
}

fn record(number: usize) -> Record {
    Record {
        model: Model::linear(400.0 + number as f32, 20.0, 1e6),
        std: [f32::INFINITY; 6],
        delay: 2e-3,
        sign: 1.0,
        noise: 0.01,
        dead_volume: 0.06,
        imbalance: 0.1,
    }
}

fn store(flash: Flash) -> ModelStore<Flash> {
    ModelStore::new(flash, SECTOR as u32, SECTOR as u32).expect("a place")
}

#[test]
fn records_stand_in_their_two_sectors_and_nowhere_else() {
    let mut store = store(Flash([0xFF; 4 * SECTOR]));
    // Bytes of somebody else on either side.
    store.flash.0[..SECTOR].fill(0x11);
    store.flash.0[3 * SECTOR..].fill(0x33);
    for number in 0..9 {
        let erases = number > 2 && number % 2 == 0;
        assert_eq!(store.must_erase(), Ok(erases), "{number}");
        store.save(&identity(), &record(number)).expect("a flash");
        assert_eq!(store.load(&identity()), Ok(record(number)));
        // Two to a sector, one behind the other, in turns.
        let place = SECTOR * (1 + number / 2 % 2) + RECORD_BYTES * (number % 2);
        let bytes = record(number).to_bytes(&identity(), number as u32);
        assert_eq!(store.flash.0[place..place + RECORD_BYTES], bytes);
    }
    let Flash(bytes) = store.release();
    assert!(bytes[..SECTOR].iter().all(|byte| *byte == 0x11));
    assert!(bytes[3 * SECTOR..].iter().all(|byte| *byte == 0x33));
}

#[test]
fn room_is_made_where_there_is_none() {
    let mut store = store(Flash([0xFF; 4 * SECTOR]));
    for number in 0..4 {
        store.make_room().expect("a flash");
        store.save(&identity(), &record(number)).expect("a flash");
    }
    assert_eq!(store.must_erase(), Ok(true));
    store.make_room().expect("a flash");
    assert_eq!(store.must_erase(), Ok(false));
    // The sector of the newest record is the other one.
    assert_eq!(store.load(&identity()), Ok(record(3)));
    assert!(
        store.flash.0[SECTOR..2 * SECTOR]
            .iter()
            .all(|byte| *byte == 0xFF)
    );
    let before = store.flash.clone();
    store.make_room().expect("a flash");
    assert_eq!(store.flash, before);
}

#[test]
fn what_is_no_record_is_counted_and_stepped_over() {
    let mut store = store(Flash([0xFF; 4 * SECTOR]));
    let load = |store: &mut ModelStore<Flash>| store.load(&identity());
    assert_eq!(load(&mut store), Err(StoreError::Refused(Refused::Empty)));
    for (count, place) in [(1, SECTOR), (2, 2 * SECTOR + RECORD_BYTES)] {
        store.flash.0[place] = 0;
        let refused = Refused::Damaged { records: count };
        assert_eq!(load(&mut store), Err(StoreError::Refused(refused)));
    }
    // Behind the damaged one of the first sector there is room.
    store.save(&identity(), &record(5)).expect("a flash");
    let place = SECTOR + RECORD_BYTES;
    let bytes = record(5).to_bytes(&identity(), 0);
    assert_eq!(store.flash.0[place..place + RECORD_BYTES], bytes);
    assert_eq!(load(&mut store), Ok(record(5)));
}

#[test]
fn a_place_is_two_whole_sectors_within_the_flash() {
    let place = |begin: usize, sector: usize| {
        let flash = Flash([0xFF; 4 * SECTOR]);
        ModelStore::new(flash, begin as u32, sector as u32).map(|store| store.places())
    };
    assert!(matches!(place(0, 2 * SECTOR), Ok(5)));
    assert!(matches!(place(2 * SECTOR, SECTOR), Ok(2)));
    assert!(matches!(place(3 * SECTOR, SECTOR), Err(StoreError::Place)));
    assert!(matches!(place(SECTOR, 2 * SECTOR), Err(StoreError::Place)));
    assert!(matches!(place(4, SECTOR), Err(StoreError::Place)));
    assert!(matches!(place(0, 0), Err(StoreError::Place)));
    assert!(matches!(place(0, SECTOR + 4), Err(StoreError::Unit)));
    assert!(matches!(
        place(0, u32::MAX as usize / SECTOR * SECTOR),
        Err(StoreError::Place)
    ));
}

#[test]
fn a_record_is_refused_with_what_was_found() {
    let bytes = record(3).to_bytes(&identity(), 9);
    assert_eq!(Record::from_bytes(&bytes, &identity()), Ok((record(3), 9)));
    let erased = Record::from_bytes(&[0xFF; RECORD_BYTES], &identity());
    assert_eq!(erased, Err(Refused::Empty));
    for at in [0, 15, RECORD_BYTES - 5, RECORD_BYTES - 1] {
        let mut bytes = bytes;
        bytes[at] ^= 1;
        let damaged = Refused::Damaged { records: 1 };
        assert_eq!(
            Record::from_bytes(&bytes, &identity()),
            Err(damaged),
            "{at}"
        );
    }
    let other = Identity {
        plant: 8,
        ..identity()
    };
    assert_eq!(
        Record::from_bytes(&bytes, &other),
        Err(Refused::Plant { found: 7 })
    );
    let other = Identity {
        settings: 1,
        ..identity()
    };
    let found = identity().settings;
    assert_eq!(
        Record::from_bytes(&bytes, &other),
        Err(Refused::Settings { found })
    );
}

#[test]
fn a_keeper_waits_a_minute_and_for_two_percent() {
    let model = record(0).model;
    let changed = |share: f32| Model {
        b0: share * model.b0,
        ..model
    };
    assert!(Keeper::new(None).is_due(&model, 0));
    let mut keeper = Keeper::new(Some(model));
    for (share, due) in [(1.0, false), (1.019, false), (1.022, true), (0.979, true)] {
        assert_eq!(keeper.is_due(&changed(share), 5), due, "{share}");
    }
    keeper.saved(&changed(1.1), u32::MAX - 9);
    assert!(!keeper.is_due(&model, 49) && keeper.is_due(&model, 50));
    assert!(!keeper.is_due(&changed(1.1), 50));
}

#[test]
fn a_refusal_says_what_was_found() {
    let said = |refused: Refused| std::string::ToString::to_string(&refused);
    assert_eq!(said(Refused::Empty), "no model is stored");
    for (refused, part) in [
        (Refused::Damaged { records: 3 }, "3 stored records"),
        (Refused::Version { found: 7 }, "has version 7, expected"),
        (Refused::Plant { found: 9 }, "of machine 9"),
        (Refused::Settings { found: 0xAB }, "(0x000000ab)"),
    ] {
        assert!(said(refused).contains(part), "{}", said(refused));
    }
}

#[test]
fn each_parameter_alone_is_worth_a_record() {
    let fields = [400.0, 20.0, 1.0e6, 0.03, -0.01, 4000.0];
    let keeper = Keeper::new(Some(Model::from_fields(fields)));
    for moved in 0..fields.len() {
        for (share, due) in [(0.015, false), (0.025, true), (-0.025, true)] {
            let mut changed = fields;
            // Dead zone and offset count from two thousandths of the command on.
            changed[moved] += share * changed[moved].abs().max(0.1);
            let model = Model::from_fields(changed);
            assert_eq!(keeper.is_due(&model, 0), due, "{moved}: {changed:?}");
        }
    }
}

#[test]
fn a_save_that_fails_is_not_tried_again_within_the_minute() {
    let model = record(0).model;
    for begin in [0, u32::MAX - 9] {
        let mut keeper = Keeper::new(None);
        assert!(keeper.is_due(&model, begin));
        keeper.failed(begin);
        for second in 0..60 {
            assert!(!keeper.is_due(&model, begin.wrapping_add(second)));
        }
        // It is still worth a record.
        assert!(keeper.is_due(&model, begin.wrapping_add(60)));
    }
}
