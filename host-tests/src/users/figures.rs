//! The figures of many users.

use crate::users::command::Command;
use crate::users::kind::Kind;
use crate::users::reading::Reading;
use crate::users::trial::{Special, Trial};

/// Errors in standard deviations whose share is counted.
pub const LIMITS: [f64; 4] = [1.0, 3.0, 5.0, 10.0];

/// Error of the truth within which a reading counts as good.
pub const GOOD: f64 = 0.1;

/// Figures of readings; shares are in per cent of them, and `NaN` of none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Readings.
    pub readings: usize,
    /// The largest error of a reading exceeds each of [`LIMITS`] \[%\].
    pub beyond: [f64; 4],
    /// A deviation is not finite \[%\].
    pub without_deviation: f64,
    /// Every quantity is within 10 % of the truth \[%\].
    pub good: f64,
    /// A quantity is no number, or its deviation is none or 0.
    pub unsound: usize,
}

impl Figures {
    /// The figures of readings.
    pub fn new(readings: &[&Reading]) -> Self {
        let count = |holds: &dyn Fn(&Reading) -> bool| {
            let counted = readings.iter().filter(|reading| holds(reading));
            counted.count()
        };
        let share =
            |holds: &dyn Fn(&Reading) -> bool| 100.0 * count(holds) as f64 / readings.len() as f64;
        Self {
            readings: readings.len(),
            beyond: LIMITS.map(|limit| share(&|reading| reading.exceeds(limit))),
            without_deviation: share(&|reading| !reading.has_deviations()),
            good: share(&|reading| reading.within(GOOD)),
            unsound: count(&|reading| !reading.quantities.iter().all(|q| q.is_sound())),
        }
    }
}

/// Which readings a row is of: all, after a time, of a structure, of a command, of what happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of them.
    All,
    /// Those at this place among the readings of a user; the last are those at the end.
    After(usize),
    /// Those of a structure.
    Of(Kind),
    /// Those of a command.
    Moved(Command),
    /// Those of users with something special.
    With(Special),
}

/// Times of the readings.
const TIMES: [&str; 4] = ["10/w", "30/w", "100/w", "end"];

impl Part {
    /// All parts, in the order of a table.
    pub fn all() -> Vec<Self> {
        let mut parts = vec![Self::All];
        parts.extend((0..TIMES.len()).map(Self::After));
        parts.extend(Kind::ALL.map(Self::Of));
        parts.extend(Command::ALL.map(Self::Moved));
        parts.push(Self::With(Special::None));
        parts.extend(Special::HAPPENS.map(Self::With));
        parts
    }

    /// What the part is a part by, and its name.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::All => ["all", "all"],
            Self::After(place) => ["time", TIMES[place]],
            Self::Of(kind) => ["structure", kind.name()],
            Self::Moved(command) => ["command", command.name()],
            Self::With(special) => ["special", special.name()],
        }
    }

    /// Readings of the identifier that belong to it.
    pub fn readings(self, trials: &[Trial]) -> Vec<&Reading> {
        let of = |trial: &&Trial| match self {
            Self::All | Self::After(_) => true,
            Self::Of(kind) => trial.user.kind == kind,
            Self::Moved(command) => trial.user.command == command,
            Self::With(special) => trial.has(special),
        };
        let own = trials.iter().filter(of).flat_map(|trial| {
            let readings = trial.readings();
            let last = readings.len().saturating_sub(1);
            readings
                .iter()
                .enumerate()
                .filter(move |(i, _)| match self {
                    Self::After(place) if place + 1 == TIMES.len() => *i == last,
                    Self::After(place) => *i == place && *i != last,
                    _ => true,
                })
        });
        own.map(|(_, reading)| reading).collect()
    }
}

/// C, omega0 and xi of the identifier and of the Kalman filter, of the users that both can serve.
pub fn duel(trials: &[Trial]) -> [Figures; 2] {
    let both: Vec<(&[Reading], &Vec<Reading>)> = trials
        .iter()
        .filter_map(|trial| Some((trial.read.as_deref().ok()?, trial.filter.as_ref()?)))
        .collect();
    let own: Vec<Reading> = both
        .iter()
        .flat_map(|(read, _)| read.iter().map(Reading::physical))
        .collect();
    let other = both.iter().flat_map(|(_, filter)| filter.iter());
    [
        Figures::new(&own.iter().collect::<Vec<_>>()),
        Figures::new(&other.collect::<Vec<_>>()),
    ]
}

/// A reading that is far out, with its user.
#[derive(Clone, Debug, PartialEq)]
pub struct Far<'a> {
    /// The user and all its readings.
    pub trial: &'a Trial,
    /// The reading.
    pub reading: &'a Reading,
    /// Its largest error in standard deviations.
    pub deviations: f64,
}

/// The users with the largest errors in standard deviations, the largest first, each once.
pub fn worst(trials: &[Trial], count: usize) -> Vec<Far<'_>> {
    let size = |reading: &Reading| {
        let worst = reading.worst().map(|q| q.error_deviations().abs());
        worst.unwrap_or(0.0)
    };
    let mut found: Vec<Far> = trials
        .iter()
        .filter_map(|trial| {
            let readings = trial.readings().iter();
            let reading = readings.max_by(|a, b| size(a).total_cmp(&size(b)))?;
            Some(Far {
                trial,
                reading,
                deviations: size(reading),
            })
        })
        .collect();
    found.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
    found.truncate(count);
    found
}
