//! The states of the supervisor, and the reasons for which it refuses a model or stops the drive.

use core::fmt;

/// Why a model was refused, or the drive was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// A parameter is not finite.
    NotFinite,
    /// The drive answers with the wrong sign.
    WrongSign,
    /// Gain, natural frequency or damping is out of the range of the drive's data.
    OutOfRange,
    /// The model without its integrator is not stable.
    Unstable,
    /// The parameters are not certain enough.
    Uncertain,
    /// In a free simulation the model does not follow: wrong order, structure or delay.
    PoorFit,
    /// The model in use follows better.
    NotBetter,
    /// The axis does not move although the valve is commanded: it is blocked, or the valve stays closed.
    Blocked,
    /// The axis moves, but not with the command: the valve is stuck open.
    ValveStuck,
    /// The position code does not change at all, not even by noise.
    SensorStuck,
    /// The sensor reported errors in three samples running.
    SensorFault,
    /// The valve reported an error.
    ValveFault,
    /// The axis came to the end of its travel.
    TravelEnd,
    /// The user stopped it.
    Aborted,
}

impl Reason {
    /// Whether it says that the estimate itself went astray, and must begin again.
    pub(crate) const fn is_astray(self) -> bool {
        matches!(
            self,
            Self::NotFinite | Self::WrongSign | Self::Unstable | Self::OutOfRange
        )
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a parameter is not a finite number",
            Self::WrongSign => {
                "the axis moves against the command: sign of sensor or valve is wrong"
            }
            Self::OutOfRange => "gain, frequency or damping is out of range for this axis",
            Self::Unstable => "the model is unstable where the drive cannot be",
            Self::Uncertain => "the parameters are not certain enough",
            Self::PoorFit => {
                "the model does not follow held-out samples: wrong order, structure or delay"
            }
            Self::NotBetter => "the model in use follows held-out samples better",
            Self::Blocked => {
                "the axis does not move when commanded: it is blocked or the valve stays closed"
            }
            Self::ValveStuck => "the axis moves, but not with the command: the valve is stuck",
            Self::SensorStuck => "the position code never changes: the sensor is stuck",
            Self::SensorFault => "the sensor reported errors",
            Self::ValveFault => "the valve reported an error",
            Self::TravelEnd => "the axis came to the end of its travel",
            Self::Aborted => "stopped by the user",
        })
    }
}

/// State of the supervisor.
///
/// ```text
/// Idle -> Exciting -> Identifying -> Verified -> Adapting <-> Frozen
///             |            |                        |
///             `------------+-> Failed(reason)       `-> Rejected(reason) -> Frozen
///                          `-> Rejected(reason) when older good gains exist
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// No model yet, the valve is at zero.
    Idle,
    /// The axis is moved; too early for a model.
    Exciting,
    /// The axis is moved, and models are put to trial.
    Identifying,
    /// A model passed; the controller takes the axis over.
    Verified,
    /// The controller runs, the model follows the drive.
    Adapting,
    /// The controller runs, nothing moves enough to learn from: gains stay.
    Frozen,
    /// A model was refused, the last good gains are in force.
    Rejected(Reason),
    /// There is no usable model, or the machine is defect: the valve is at zero.
    Failed(Reason),
}

impl State {
    /// Whether the axis is moved by the excitation.
    pub const fn is_commissioning(self) -> bool {
        matches!(self, Self::Exciting | Self::Identifying)
    }

    /// Whether the controller has the axis.
    pub const fn is_controlling(self) -> bool {
        matches!(
            self,
            Self::Verified | Self::Adapting | Self::Frozen | Self::Rejected(_)
        )
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Idle => f.write_str("idle"),
            Self::Exciting => f.write_str("exciting"),
            Self::Identifying => f.write_str("identifying"),
            Self::Verified => f.write_str("verified"),
            Self::Adapting => f.write_str("adapting"),
            Self::Frozen => f.write_str("frozen"),
            Self::Rejected(reason) => write!(f, "rejected: {reason}"),
            Self::Failed(reason) => write!(f, "failed: {reason}"),
        }
    }
}
