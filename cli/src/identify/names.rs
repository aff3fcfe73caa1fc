//! Values of the arguments that are one of a few words.

use trendid_identify::{Hold, Scheme};

/// Unit of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum TimeUnit {
    S,
    Ms,
    Us,
    Ns,
}

impl TimeUnit {
    pub(crate) const fn seconds(self) -> f64 {
        match self {
            Self::S => 1.0,
            Self::Ms => 1e-3,
            Self::Us => 1e-6,
            Self::Ns => 1e-9,
        }
    }
}

/// How an input behaves between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum HoldName {
    /// Zero-order hold: constant until the next sample.
    Zoh,
    /// First-order hold: straight to the next sample.
    Foh,
}

impl From<HoldName> for Hold {
    fn from(name: HoldName) -> Self {
        match name {
            HoldName::Zoh => Self::Zero,
            HoldName::Foh => Self::First,
        }
    }
}

/// The two schemes of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SchemeName {
    Goodwin,
    Tustin,
}

impl From<SchemeName> for Scheme {
    fn from(name: SchemeName) -> Self {
        match name {
            SchemeName::Goodwin => Self::Goodwin,
            SchemeName::Tustin => Self::Tustin,
        }
    }
}
