//! One user with the identifier and its opponent.

use crate::users::draw::User;
use crate::users::filter;
use crate::users::identified;
use crate::users::kind::Kind;
use crate::users::reading::Reading;
use crate::users::record::{Event, Record};

/// A user, and what it reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The user.
    pub user: User,
    /// Whether a sample was missed.
    pub missed: bool,
    /// What it reads of the identifier, or why its settings were refused.
    pub read: Result<Vec<Reading>, String>,
    /// What it would read of an extended Kalman filter; `None` where the drive is none of its form.
    pub filter: Option<Vec<Reading>>,
}

impl Trial {
    /// Draws the user of a seed, of one kind where it is given, and runs both on its record.
    pub fn run(seed: u64, kind: Option<Kind>) -> Self {
        let user = User::of(seed, kind);
        let record = Record::of(&user);
        let skips = |event: &Event| matches!(event, Event::Skip(_));
        Self {
            missed: record.events.iter().any(skips),
            read: identified::readings(&user, &record).map_err(|error| error.to_string()),
            filter: filter::readings(&user, &record),
            user,
        }
    }

    /// Readings of the identifier; none where it was refused.
    pub fn readings(&self) -> &[Reading] {
        self.read.as_deref().unwrap_or_default()
    }

    /// Whether something of this name happened to the user.
    pub fn has(&self, special: Special) -> bool {
        let User {
            told,
            sensor,
            interruptions,
            ..
        } = &self.user;
        match special {
            Special::None => !Special::HAPPENS.iter().any(|other| self.has(*other)),
            Special::Gap => self.missed,
            Special::Nan => interruptions.nans,
            Special::Spike => interruptions.spikes,
            Special::Retune => told.retuned.is_some(),
            Special::Quantised => sensor.resolution > 0.0,
            Special::Memory => told.memory.is_some(),
        }
    }
}

/// What is special about a user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Special {
    /// None of the others.
    None,
    /// Samples are missed.
    Gap,
    /// Positions are no numbers.
    Nan,
    /// Positions are far off.
    Spike,
    /// The bandwidth is told anew.
    Retune,
    /// The resolution of the sensor is seen.
    Quantised,
    /// The identifier forgets.
    Memory,
}

impl Special {
    /// All but [`Special::None`].
    pub const HAPPENS: [Self; 6] = [
        Self::Gap,
        Self::Nan,
        Self::Spike,
        Self::Retune,
        Self::Quantised,
        Self::Memory,
    ];

    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "nothing special",
            Self::Gap => "gaps",
            Self::Nan => "no numbers",
            Self::Spike => "spikes",
            Self::Retune => "retuned",
            Self::Quantised => "quantised",
            Self::Memory => "memory",
        }
    }
}
