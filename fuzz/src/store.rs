//! What a flash holds, and saves that lose their power.

use std::sync::LazyLock;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::store::{Identity, Keeper, ModelStore, RECORD_BYTES, Record, StoreError};
use trendid::servo::{Config, Model, ServoLoop, Travel};

use crate::bytes::Bytes;

/// Two sectors with a margin on both sides that is nobody's.
const SECTOR: usize = 4 * RECORD_BYTES;
const MARGIN: usize = SECTOR;
const SIZE: usize = 2 * SECTOR + 2 * MARGIN;

#[derive(Clone, Debug)]
struct Flash {
    bytes: [u8; SIZE],
    /// Bytes that are still programmed or erased before the power fails.
    power: usize,
}

#[derive(Debug, PartialEq, Eq)]
struct NoPower;

impl NorFlashError for NoPower {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Flash {
    type Error = NoPower;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NoPower> {
        let begin = offset as usize;
        bytes.copy_from_slice(&self.bytes[begin..begin + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl Flash {
    fn spend(&mut self) -> Result<(), NoPower> {
        self.power = self.power.checked_sub(1).ok_or(NoPower)?;
        Ok(())
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NoPower> {
        assert!(from as usize >= MARGIN && to as usize <= SIZE - MARGIN);
        for place in from as usize..to as usize {
            self.spend()?;
            self.bytes[place] = 0xFF;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NoPower> {
        let begin = offset as usize;
        assert!(begin >= MARGIN && begin + bytes.len() <= SIZE - MARGIN);
        for (place, byte) in (begin..).zip(bytes) {
            assert_eq!(self.bytes[place], 0xFF, "written over what is not erased");
            self.spend()?;
            self.bytes[place] &= byte;
        }
        Ok(())
    }
}

#[derive(Clone, Debug)]
struct Code;
impl PositionSensor for Code {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        Ok(20_000)
    }
}
#[derive(Clone, Debug)]
struct Finite;
impl Valve for Finite {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        assert!((-1.0..=1.0).contains(&command), "command {command}");
        Ok(command)
    }
}

fn config() -> Config {
    Config::new(
        1e-3,
        20.0,
        Travel {
            min: 0.0,
            max: 400.0,
        },
    )
}

/// Any numbers: what a record says is not yet trusted.
fn record(bytes: &mut Bytes<'_>) -> Record {
    Record {
        model: Model {
            a1: bytes.signal(800.0),
            a2: bytes.signal(40.0),
            b0: bytes.signal(2e6),
            dead_zone: bytes.signal(0.1),
            offset: bytes.signal(0.1),
            friction: bytes.signal(5e3),
        },
        std: std::array::from_fn(|_| bytes.signal(1.0)),
        delay: bytes.signal(4e-3),
        sign: bytes.signal(1.0).signum(),
        noise: bytes.signal(0.1),
        dead_volume: bytes.signal(1.0),
        imbalance: bytes.signal(1.0),
    }
}

/// Whether all numbers are the same, bit by bit.
fn same(one: &Record, other: &Record) -> bool {
    let bits = |record: &Record| {
        let model = record.model;
        let rest = [
            model.a1,
            model.a2,
            model.b0,
            model.dead_zone,
            model.offset,
            model.friction,
            record.delay,
            record.sign,
            record.noise,
            record.dead_volume,
        ];
        (rest.map(f32::to_bits), record.std.map(f32::to_bits))
    };
    bits(one) == bits(other)
}

fn store(flash: Flash) -> ModelStore<Flash> {
    ModelStore::new(flash, MARGIN as u32, SECTOR as u32).expect("two sectors")
}

/// Runs what the bytes say.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let mut flash = Flash {
        bytes: [0xFF; SIZE],
        power: usize::MAX,
    };
    let identity = Identity::new(7, &config());
    let mut kept: Option<Record> = None;
    if bytes.byte() & 1 == 0 {
        // Debris: what a flash may hold that was never ours.
        for _ in 0..bytes.byte() {
            let place = usize::from(u16::from_le_bytes(bytes.take())) % SIZE;
            flash.bytes[place] = bytes.byte();
        }
        let found = store(flash.clone()).load(&identity);
        assert!(matches!(found, Err(StoreError::Refused(_))), "{found:?}");
    }
    let margins = [
        flash.bytes[..MARGIN].to_vec(),
        flash.bytes[SIZE - MARGIN..].to_vec(),
    ];
    let mut keeper = Keeper::new(None);
    let mut now = 0_u32;
    while !bytes.is_empty() {
        let new = record(&mut bytes);
        now = now.wrapping_add(u32::from(bytes.byte()));
        if keeper.is_due(&new.model, now) {
            keeper.saved(&new.model, now);
            assert!(
                !keeper.is_due(&new.model, now.wrapping_add(59)),
                "twice in a minute"
            );
        }
        flash.power = match bytes.byte() {
            0..=99 => usize::MAX,
            cut => (usize::from(cut) * 7 + usize::from(bytes.byte())) % (SECTOR + RECORD_BYTES + 8),
        };
        let mut one = store(flash);
        if bytes.byte() & 3 == 0 {
            // The start makes room, and may lose its power too.
            let _ = one.make_room();
        }
        let saved = one.save(&identity, &new).is_ok();
        // The restart.
        flash = one.release();
        flash.power = usize::MAX;
        let found = store(flash.clone()).load(&identity).ok();
        let is_new = found.as_ref().is_some_and(|found| same(found, &new));
        let is_old = match (&found, &kept) {
            (Some(found), Some(kept)) => same(found, kept),
            (None, None) => true,
            _ => false,
        };
        assert!(is_new || is_old, "{found:?} is neither old nor new");
        assert!(is_new || !saved, "a record that is said to be kept is kept");
        kept = found;
        if let Some(kept) = &kept {
            resume(kept);
        }
    }
    assert!(margins[0] == flash.bytes[..MARGIN] && margins[1] == flash.bytes[SIZE - MARGIN..]);
}

/// A loop that was just built; copied, because the design of its settings takes longer.
static FRESH: LazyLock<ServoLoop<Code, Finite>> = LazyLock::new(|| {
    let axis = Axis {
        scale: Scale::new(0.01).expect("a scale"),
        reference: 0,
    };
    ServoLoop::try_new(&config(), axis, Code, Finite).expect("settings")
});

/// What was loaded controls with commands that are numbers, or is refused and leaves a loop that
/// stands.
fn resume(record: &Record) {
    let mut servo = FRESH.clone();
    let resumed = servo.resume(record).is_ok();
    for _ in 0..4 {
        let report = servo.update();
        assert!(resumed || report.command == 0.0);
    }
}
