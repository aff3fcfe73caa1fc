//! The stored model on a simulated flash: power that fails in any operation, flipped bits, records
//! of somebody else.

use std::convert::Infallible;

use crate::flash::{Cut, Flash, SECTOR};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use trendid::servo::store::{
    Identity, Keeper, ModelStore, RECORD_BYTES, Record, Refused, StoreError,
};
use trendid::servo::{Config, Model, Travel};

fn identity() -> Identity {
    Identity::new(7, &Config::new(0.001, 20.0, TRAVEL))
}

const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

/// The record number `number` of a history.
fn record(number: usize) -> Record {
    let value = number as f32;
    Record {
        model: Model {
            dead_zone: 0.03,
            offset: -0.01,
            friction: 4000.0 + value,
            ..Model::linear(400.0 + value, 20.0, 1.0e6)
        },
        std: [1.0, 0.1, 2.0e3, f32::INFINITY, value, 0.0],
        delay: 2e-3,
        sign: -1.0,
        noise: 0.01,
        dead_volume: f32::INFINITY,
        imbalance: -0.1,
    }
}

fn store(flash: Flash) -> ModelStore<Flash> {
    ModelStore::new(flash, 0, SECTOR as u32).expect("two sectors")
}

/// A history of `count` records.
fn filled(count: usize) -> Flash {
    let mut store = store(Flash::new());
    for number in 0..count {
        store.save(&identity(), &record(number)).expect("power");
    }
    store.release()
}

#[test]
fn the_newest_record_comes_back_over_many_turns_of_the_sectors() {
    let mut store = store(Flash::new());
    let empty = store.load(&identity());
    assert_eq!(empty, Err(StoreError::Refused(Refused::Empty)));
    for number in 0..20 {
        // Three records to a sector; both are blank at the begin.
        let erases = number > 3 && number % 3 == 0;
        assert_eq!(store.must_erase(), Ok(erases), "record {number}");
        store.save(&identity(), &record(number)).expect("power");
        assert_eq!(store.load(&identity()), Ok(record(number)));
    }
}

/// The cuts of an operation: after every byte, and with some of the bits of all bytes.
fn cuts(bytes: usize) -> impl Iterator<Item = Cut> {
    let masks = [0x00, 0x01, 0x0F, 0x55, 0xAA, 0xF0, 0xFE, 0xFF];
    (0..=bytes).map(Cut::Bytes).chain(masks.map(Cut::Bits))
}

#[test]
fn power_that_fails_in_any_operation_leaves_the_old_record_or_the_new_one_and_the_next_is_kept() {
    let (mut old_ones, mut new_ones) = (0, 0);
    // Every fill of the two sectors, three times over; a save is one write, or an erase and a
    // write.
    for count in 1..=10 {
        for operation in 0..2 {
            for cut in cuts(SECTOR) {
                let mut flash = filled(count);
                flash.operations = 0;
                flash.cut = Some((operation, cut));
                let mut broken = store(flash);
                let saved = broken.save(&identity(), &record(count));
                // The restart.
                let mut flash = broken.release();
                flash.cut = None;
                let mut again = store(flash);
                let found = again.load(&identity());
                let new = found == Ok(record(count));
                assert!(
                    new || found == Ok(record(count - 1)),
                    "{count} records, operation {operation}, {cut:?}: {found:?}"
                );
                assert!(
                    new || saved.is_err(),
                    "a record that is said to be kept is kept"
                );
                *(if new { &mut new_ones } else { &mut old_ones }) += 1;
                // Nothing that a cut leaves is in the way: at the latest the second attempt is
                // kept.
                let next = record(count + 1);
                let kept = again.save(&identity(), &next).is_ok()
                    || again.save(&identity(), &next).is_ok();
                assert!(kept, "{count} records, operation {operation}, {cut:?}");
                assert_eq!(again.load(&identity()), Ok(next));
            }
        }
    }
    assert!(old_ones > 1000 && new_ones > 1000, "{old_ones}, {new_ones}");
}

#[test]
fn room_that_is_made_at_the_start_keeps_the_record_and_spares_the_erase() {
    for count in 0..=10 {
        for cut in [None].into_iter().chain(cuts(SECTOR).map(Some)) {
            let mut flash = filled(count);
            flash.operations = 0;
            flash.cut = cut.map(|cut| (0, cut));
            let mut first = store(flash);
            let made = first.make_room();
            let mut flash = first.release();
            flash.cut = None;
            let mut again = store(flash);
            let kept = count.checked_sub(1).map(record);
            let found = again.load(&identity());
            let refused = matches!(found, Err(StoreError::Refused(_)));
            assert_eq!(found.ok(), kept, "{count} records, {cut:?}");
            assert_eq!(refused, kept.is_none());
            if made.is_ok() {
                assert_eq!(again.must_erase(), Ok(false), "{count} records");
            }
        }
    }
}

#[test]
fn each_flipped_bit_of_the_newest_record_is_detected() {
    for bit in 0..8 * RECORD_BYTES {
        let mut one = filled(1);
        one.bytes[bit / 8] ^= 1 << (bit % 8);
        let found = store(one).load(&identity());
        let damaged = StoreError::Refused(Refused::Damaged { records: 1 });
        assert_eq!(found, Err(damaged), "bit {bit}");
        let mut two = filled(2);
        two.bytes[RECORD_BYTES + bit / 8] ^= 1 << (bit % 8);
        assert_eq!(store(two).load(&identity()), Ok(record(0)), "bit {bit}");
    }
}

#[test]
fn a_record_of_somebody_else_is_refused_with_the_reason() {
    let Identity { plant, settings } = identity();
    let other = Identity { plant: 8, settings };
    let found = store(filled(1)).load(&other);
    assert_eq!(
        found,
        Err(StoreError::Refused(Refused::Plant { found: plant }))
    );
    for change in [
        |config: &mut Config| config.sample_time = 0.002,
        |config: &mut Config| config.delay = 0.004,
        |config: &mut Config| config.travel.min = 1.0,
        |config: &mut Config| config.travel.max = 401.0,
    ] {
        let mut config = Config::new(0.001, 20.0, TRAVEL);
        change(&mut config);
        let found = store(filled(1)).load(&Identity::new(7, &config));
        let refused = StoreError::Refused(Refused::Settings { found: settings });
        assert_eq!(found, Err(refused), "{config:?}");
    }
    // Another layout, with a check of its own.
    let mut flash = filled(1);
    flash.bytes[0] = 2;
    let check = crc(&flash.bytes[..RECORD_BYTES - 4]);
    flash.bytes[RECORD_BYTES - 4..RECORD_BYTES].copy_from_slice(&check.to_le_bytes());
    let found = store(flash).load(&identity());
    assert_eq!(
        found,
        Err(StoreError::Refused(Refused::Version { found: 2 }))
    );
}

/// CRC-32 of ISO-HDLC, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc: u32, _| {
            (crc >> 1) ^ (0xEDB8_8320 * (crc & 1))
        })
    })
}

#[test]
fn a_place_that_cannot_hold_a_store_is_refused() {
    for (begin, sector, expected) in [
        (0, 0, StoreError::Place),
        (0, 100, StoreError::Unit),
        (4, SECTOR as u32, StoreError::Place),
        (SECTOR as u32, SECTOR as u32, StoreError::Place),
        (u32::MAX - 63, SECTOR as u32, StoreError::Place),
        (0, 13_421_772 * SECTOR as u32, StoreError::Place),
    ] {
        let refused = ModelStore::new(Flash::new(), begin, sector).map(|_| ());
        assert_eq!(refused, Err(expected), "{begin}, {sector}");
    }
}

#[test]
fn a_flash_that_does_not_keep_what_was_written_is_noticed() {
    /// Flash whose first byte reads as 0.
    struct Worn(Flash);
    impl ErrorType for Worn {
        type Error = Infallible;
    }
    impl ReadNorFlash for Worn {
        const READ_SIZE: usize = 1;
        fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
            self.0.read(offset, bytes).expect("in bounds");
            if offset == 0 {
                bytes[0] = 0;
            }
            Ok(())
        }
        fn capacity(&self) -> usize {
            self.0.capacity()
        }
    }
    impl NorFlash for Worn {
        const WRITE_SIZE: usize = 4;
        const ERASE_SIZE: usize = SECTOR;
        fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
            self.0.erase(from, to).expect("power");
            Ok(())
        }
        fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
            self.0.write(offset, bytes).expect("power");
            Ok(())
        }
    }
    let mut flash = Flash::new();
    flash.bytes[..SECTOR].fill(0);
    let mut store = ModelStore::new(Worn(flash), 0, SECTOR as u32).expect("two sectors");
    let mut kept = Vec::new();
    for number in 0..6 {
        kept.push(store.save(&identity(), &record(number)));
    }
    assert!(kept.contains(&Err(StoreError::NotKept)), "{kept:?}");
    assert!(kept.iter().any(Result::is_ok), "{kept:?}");
}

#[test]
fn a_model_is_written_for_a_change_beyond_two_percent_and_once_a_minute() {
    let model = record(0).model;
    let changes: [fn(&mut Model, f32); 6] = [
        |model, share| model.a1 *= share,
        |model, share| model.a2 *= share,
        |model, share| model.b0 *= share,
        |model, share| model.friction *= share,
        |model, share| model.dead_zone += 0.1 * (share - 1.0),
        |model, share| model.offset += 0.1 * (share - 1.0),
    ];
    // The seconds wrap around, too.
    for begin in [0, 1000, u32::MAX - 30] {
        for change in changes {
            let changed = |share| {
                let mut model = model;
                change(&mut model, share);
                model
            };
            let mut keeper = Keeper::new(Some(model));
            assert!(!keeper.is_due(&changed(1.0), begin), "the same model");
            assert!(!keeper.is_due(&changed(1.019), begin), "less than 2 %");
            assert!(keeper.is_due(&changed(1.022), begin), "more than 2 %");
            keeper.saved(&changed(1.022), begin);
            for second in 0..60_u32 {
                let now = begin.wrapping_add(second);
                assert!(!keeper.is_due(&model, now), "{second} s after a record");
            }
            assert!(keeper.is_due(&model, begin.wrapping_add(60)));
            assert!(!keeper.is_due(&changed(1.022), begin.wrapping_add(60)));
        }
        assert!(!Keeper::new(None).is_due(
            &Model {
                a1: f32::NAN,
                ..model
            },
            begin
        ));
        assert!(Keeper::new(None).is_due(&model, begin));
    }
}
