//! One record: a model, the conditions of its commissioning, and the axis it belongs to.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

use crate::servo::config::Config;
use crate::servo::model::Model;

/// Bytes of a record.
pub(super) const BYTES: usize = 96;

/// Format of the bytes; another number, another layout.
const VERSION: u32 = 3;

/// The check of a record. Bit by bit: a record is rare, and a table costs 1 KiB of flash.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Words in front of the numbers: version, plant, settings, sequence.
const HEAD: usize = 4;

/// Numbers of a record: the model, its standard deviations, delay, sign, noise, dead volume,
/// imbalance.
const NUMBERS: usize = 17;

/// Axis and firmware that a record belongs to.
///
/// | field | bytes | |
/// |---|---|---|
/// | version | 4 | layout of what follows, little-endian |
/// | plant, settings | 8 | this |
/// | sequence | 4 | counts the records |
/// | numbers | 68 | f32: model (6), standard deviations (6), delay, sign, noise, dead volume, imbalance |
/// | zero | 8 | room |
/// | CRC-32 | 4 | of all bytes before, ISO-HDLC |
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identity {
    /// The machine, for instance its serial number: a controller board that is moved to another
    /// axis finds no model.
    pub plant: u32,
    /// The settings that a model depends on, see [`Identity::new`].
    pub settings: u32,
}

impl Identity {
    /// The identity of a `plant` under these settings: sample time, delay and travel, which fixes
    /// unit and origin of y.
    pub fn new(plant: u32, config: &Config) -> Self {
        let travel = config.travel;
        let mut digest = CRC.digest();
        for number in [config.sample_time, config.delay, travel.min, travel.max] {
            digest.update(&number.to_le_bytes());
        }
        Self {
            plant,
            settings: digest.finalize(),
        }
    }
}

/// A verified model and the conditions of its commissioning.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Record {
    /// The model, learned friction included.
    pub model: Model,
    /// Standard deviations, in the order of [`Model::parameters`]; infinite where not known.
    pub std: [f32; 6],
    /// Delay of the valve in s.
    pub delay: f32,
    /// Sign of the valve: -1 when the axis moves against a positive command.
    pub sign: f32,
    /// Standard deviation of the position, in units of y; 0 where no commissioning has found it.
    pub noise: f32,
    /// Dead volume of a chamber over that of the stroke, see
    /// [`ControllerSettings::dead_volume`](crate::servo::ControllerSettings::dead_volume).
    pub dead_volume: f32,
    /// Share by which the axis is slower towards larger y, see
    /// [`ControllerSettings::imbalance`](crate::servo::ControllerSettings::imbalance).
    pub imbalance: f32,
}

/// Why there is no model to load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Refused {
    /// Nothing was ever written.
    Empty,
    /// No record passes its check.
    Damaged {
        /// How many do not.
        records: u32,
    },
    /// The newest record has another layout.
    Version {
        /// Its version.
        found: u32,
    },
    /// The newest record is of another machine.
    Plant {
        /// Which one.
        found: u32,
    },
    /// The newest record was made under other settings.
    Settings {
        /// Their hash.
        found: u32,
    },
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Empty => f.write_str("no model is stored"),
            Self::Damaged { records } => write!(f, "{records} stored records, none is whole"),
            Self::Version { found } => {
                write!(
                    f,
                    "the stored model has version {found}, expected {VERSION}"
                )
            }
            Self::Plant { found } => write!(f, "the stored model is of machine {found}"),
            Self::Settings { found } => {
                write!(
                    f,
                    "the stored model was made under other settings ({found:#010x})"
                )
            }
        }
    }
}

impl core::error::Error for Refused {}

impl Record {
    /// The bytes of the record with this `sequence` number, for memory that is not a flash behind a
    /// [`ModelStore`](super::ModelStore): they end in their CRC-32.
    ///
    /// # Examples
    /// ```
    /// use trendid::servo::store::{Identity, Record, Refused};
    /// use trendid::servo::{Config, Model, Travel};
    /// let identity = Identity::new(7, &Config::minimal(0.001, Travel { min: 0.0, max: 400.0 }));
    /// let model = Model::linear(400.0, 20.0, 1.0e6);
    /// let record = Record { model, std: [f32::INFINITY; 6], delay: 0.002, sign: 1.0, noise: 0.01, dead_volume: 0.06, imbalance: 0.0 };
    /// let mut bytes = record.to_bytes(&identity, 3);
    /// assert_eq!(Record::from_bytes(&bytes, &identity), Ok((record, 3)));
    /// bytes[20] ^= 1;
    /// assert_eq!(Record::from_bytes(&bytes, &identity), Err(Refused::Damaged { records: 1 }));
    /// ```
    pub fn to_bytes(&self, identity: &Identity, sequence: u32) -> [u8; BYTES] {
        self.encode(identity, sequence)
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote: the record and its sequence number.
    ///
    /// # Errors
    /// [`Refused`]: erased memory, a wrong check, another version, machine or configuration.
    pub fn from_bytes(bytes: &[u8; BYTES], identity: &Identity) -> Result<(Self, u32), Refused> {
        if *bytes == [0xFF; BYTES] {
            return Err(Refused::Empty);
        }
        let number = sequence(bytes).ok_or(Refused::Damaged { records: 1 })?;
        Ok((Self::decode(bytes, identity)?, number))
    }

    /// The bytes of the record with this `sequence` number.
    pub(super) fn encode(&self, identity: &Identity, sequence: u32) -> [u8; BYTES] {
        let mut words = [0_u32; BYTES / 4 - 1];
        [words[0], words[1], words[2], words[3]] =
            [VERSION, identity.plant, identity.settings, sequence];
        let model = self.model.fields();
        let rest = [
            self.delay,
            self.sign,
            self.noise,
            self.dead_volume,
            self.imbalance,
        ];
        let numbers = model.iter().chain(&self.std).chain(&rest);
        for (word, number) in words[HEAD..].iter_mut().zip(numbers) {
            *word = number.to_bits();
        }
        let mut bytes = [0; BYTES];
        for (place, word) in bytes.chunks_exact_mut(4).zip(words) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        let check = CRC.checksum(&bytes[..BYTES - 4]);
        bytes[BYTES - 4..].copy_from_slice(&check.to_le_bytes());
        bytes
    }

    /// Reads bytes that passed their check.
    pub(super) fn decode(bytes: &[u8; BYTES], identity: &Identity) -> Result<Self, Refused> {
        let found = |place| word(bytes, place);
        if found(0) != VERSION {
            return Err(Refused::Version { found: found(0) });
        }
        if found(1) != identity.plant {
            return Err(Refused::Plant { found: found(1) });
        }
        if found(2) != identity.settings {
            return Err(Refused::Settings { found: found(2) });
        }
        let numbers: [f32; NUMBERS] =
            core::array::from_fn(|place| f32::from_bits(word(bytes, HEAD + place)));
        let [
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
            std @ ..,
            delay,
            sign,
            noise,
            dead_volume,
            imbalance,
        ] = numbers;
        Ok(Self {
            model: Model::from_fields([a1, a2, b0, dead_zone, offset, friction]),
            std,
            delay,
            sign,
            noise,
            dead_volume,
            imbalance,
        })
    }
}

/// The word at `place`; zero beyond the end.
fn word(bytes: &[u8; BYTES], place: usize) -> u32 {
    let (words, _) = bytes.as_chunks::<4>();
    words
        .get(place)
        .map_or(0, |bytes| u32::from_le_bytes(*bytes))
}

/// The sequence number of bytes that pass their check.
pub(super) fn sequence(bytes: &[u8; BYTES]) -> Option<u32> {
    (CRC.checksum(&bytes[..BYTES - 4]) == word(bytes, BYTES / 4 - 1)).then(|| word(bytes, 3))
}
