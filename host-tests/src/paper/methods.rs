//! What Table 1 is run over: the conditions, the trend filters and the methods, with their names in
//! the file.

use trendid::trends::Scheme;

use crate::paper::table1::{Printed, TABLE1, Varied};
use crate::signals::noise::{Condition, Reading};

/// One condition of the table in one reading, with the paper's figures for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// What the block varies: drift, noise, resolution, sampling, or white (the noise block without
    /// drift and rounding).
    pub vary: &'static str,
    /// Widths, interval and reading.
    pub condition: Condition,
    /// Printed figures of Goodwin's scheme.
    pub goodwin: Printed,
    /// Printed figures of the modified Tustin scheme.
    pub tustin: Printed,
}

impl Setting {
    /// The 19 rows of the paper, then the four rows of its noise block with the white noise alone.
    pub fn all(reading: Reading) -> Vec<Self> {
        let printed = TABLE1.iter().map(|row| Self {
            vary: row.varied.name(),
            condition: row.condition(reading),
            goodwin: row.goodwin,
            tustin: row.tustin,
        });
        let white = TABLE1
            .iter()
            .filter(|row| row.varied == Varied::Noise)
            .map(|row| Self {
                vary: "white",
                condition: Condition {
                    w_um: 0.0,
                    eps_um: 0.0,
                    ..row.condition(reading)
                },
                goodwin: row.goodwin,
                tustin: row.tustin,
            });
        printed.chain(white).collect()
    }

    /// Duration at which the reading is judged unless asked otherwise \[s\]: 0.5 in ABSOLUTE, 3 in
    /// RELATIVE.
    pub fn usual_duration(&self) -> f64 {
        match self.condition.reading {
            Reading::Absolute => 0.5,
            Reading::Relative => 3.0,
        }
    }

    /// Name of the reading as in the file.
    pub fn reading(&self) -> &'static str {
        match self.condition.reading {
            Reading::Absolute => "absolute",
            Reading::Relative => "relative",
        }
    }

    /// The paper's figures of a scheme.
    pub fn printed(&self, scheme: Scheme) -> Printed {
        match scheme {
            Scheme::Goodwin => self.goodwin,
            Scheme::Tustin => self.tustin,
        }
    }
}

/// Trends in front of the recursion, with the structure that goes with them; the plant's rough
/// bandwidth is 20 rad/s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The paper's raw trends, theta = (a1, a2, b0).
    None,
    /// The default of the core, [`for_bandwidth`](trendid::trends::FilteredTrends::for_bandwidth):
    /// `(s + 2.2)(s^2 + 30.8 s + 484)`, with a constant and the start.
    Default,
    /// Drift as a parabola over a short record: `(s + 3.5)(s^2 + 59.5 s + 1225)`, with a constant,
    /// the start and the time as a second input; the constant and the slope of the drift are known
    /// to be small, and never withdrawn.
    Ramp,
    /// Linear integral filter of Sagara and Zhao over 70 ms, theta = (a1, a2, b0).
    Span,
    /// The default filter with the numerators of the hold,
    /// [`ExactTrends`](trendid::trends::ExactTrends), for slow sampling; behind modified Tustin
    /// only.
    Exact,
}

impl Filter {
    /// Every filter, in the order of the table.
    pub const ALL: [Self; 5] = [
        Self::None,
        Self::Default,
        Self::Ramp,
        Self::Span,
        Self::Exact,
    ];

    /// Whether the filter goes with a scheme.
    pub fn goes_with(self, scheme: Scheme) -> bool {
        self != Self::Exact || scheme == Scheme::Tustin
    }

    /// Name as in the file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Default => "default",
            Self::Ramp => "ramp",
            Self::Span => "span",
            Self::Exact => "exact",
        }
    }

    /// One line for the legend.
    pub const fn legend(self) -> &'static str {
        match self {
            Self::None => "raw trends of the paper",
            Self::Default => {
                "FilteredTrends::for_bandwidth(20 rad/s) = (s + 2.2)(s^2 + 30.8 s + 484), with constant and start"
            }
            Self::Ramp => {
                "(s + 3.5)(s^2 + 59.5 s + 1225), with constant, start and the time as an input: drift as a parabola"
            }
            Self::Span => "linear integral filter (Sagara and Zhao) over 70 ms",
            Self::Exact => {
                "ExactTrends::for_bandwidth(20 rad/s): as default, with the numerators of the hold, those of the filter"
            }
        }
    }
}

/// Who estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The core.
    Core {
        /// Goodwin or Tustin.
        scheme: Scheme,
        /// Trends in front of the recursion.
        filter: Filter,
        /// Whether the noise bias is taken out at the read-out, as the core does; otherwise bare
        /// least squares.
        compensated: bool,
    },
    /// The core with instruments beside its recursion,
    /// [`Instrumented`](trendid::instruments::Instrumented): modified Tustin behind the default
    /// filter, read out at the end of the record.
    Instruments,
    /// [`ExtendedKalman`](crate::oracles::ekf::ExtendedKalman) that knows the noise level.
    Kalman,
    /// [`output_error`](crate::oracles::output_error::output_error) over the whole record, started
    /// 20 % off.
    OutputError,
}

impl Method {
    /// The core as its users get it: modified Tustin, default filter, noise bias taken out.
    pub const DEFAULT: Self = Self::Core {
        scheme: Scheme::Tustin,
        filter: Filter::Default,
        compensated: true,
    };

    /// Every method, in the order of the table.
    pub fn all() -> Vec<Self> {
        let mut methods = vec![Self::OutputError, Self::Kalman];
        for filter in Filter::ALL {
            for scheme in [Scheme::Goodwin, Scheme::Tustin] {
                if !filter.goes_with(scheme) {
                    continue;
                }
                // The core compensates behind a chain only: elsewhere both read-outs are the same
                // numbers.
                let chain = !matches!(filter, Filter::None | Filter::Span);
                for compensated in [false, true].into_iter().take(1 + usize::from(chain)) {
                    methods.push(Self::Core {
                        scheme,
                        filter,
                        compensated,
                    });
                }
            }
        }
        methods.push(Self::Instruments);
        methods
    }

    /// Scheme as in the file, empty for opponents.
    pub const fn scheme(self) -> &'static str {
        match self {
            Self::Core {
                scheme: Scheme::Goodwin,
                ..
            } => "goodwin",
            Self::Core {
                scheme: Scheme::Tustin,
                ..
            }
            | Self::Instruments => "tustin",
            _ => "",
        }
    }

    /// Filter as in the file, empty for opponents.
    pub const fn filter(self) -> &'static str {
        match self {
            Self::Core { filter, .. } => filter.name(),
            Self::Instruments => Filter::Default.name(),
            _ => "",
        }
    }

    /// Estimator as in the file.
    pub const fn estimator(self) -> &'static str {
        match self {
            Self::Core {
                compensated: true, ..
            } => "ls+bias",
            Self::Core { .. } => "ls",
            Self::Instruments => "instruments",
            Self::Kalman => "ekf",
            Self::OutputError => "output-error",
        }
    }
}
