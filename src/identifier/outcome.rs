//! The outcome of one sample.

/// Why a sample was refused; no number of it entered any buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Refusal {
    /// This input is not finite, or more than 10^6 times its range.
    Input(usize),
    /// The output is not finite, or more than 10^6 times its range.
    Output,
}

/// Outcome of one sample.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Outcome {
    /// The trends are settling, or where y began is being found; `remaining` samples are left at
    /// least.
    WarmingUp {
        /// Samples until the first estimate, as far as is known.
        remaining: u32,
    },
    /// The sample was refused and entered no buffer; its time passed, bridged by the prediction of
    /// y.
    Refused(Refusal),
    /// y was implausible (a spike) and replaced by its prediction; the estimate was left alone.
    Replaced {
        /// y(k) minus its prediction, in the unit of y.
        innovation: f32,
    },
    /// The sample was predicted; the estimate is held: by the user, because the drive does not
    /// move, behind a lasting step of y, or while the filter forgets the drive before a change or
    /// the estimator what it owes.
    Held {
        /// y(k) minus its prediction, in the unit of y.
        innovation: f32,
    },
    /// The sample was predicted and the estimate updated.
    Estimated {
        /// y(k) minus its prediction, in the unit of y.
        innovation: f32,
    },
}

impl Outcome {
    /// y(k) minus its prediction, of a sample that was taken as it was measured; `None` for others.
    pub fn innovation(self) -> Option<f32> {
        match self {
            Self::Held { innovation } | Self::Estimated { innovation } => Some(innovation),
            Self::WarmingUp { .. } | Self::Refused(_) | Self::Replaced { .. } => None,
        }
    }
}
