//! The states of the supervisor, and the reasons for which it refuses a model or stops the drive.

use core::fmt;

/// Why a model was refused, or the drive was stopped.
///
/// The order is part of the link's protocol: new reasons come last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
#[non_exhaustive]
pub enum Reason {
    /// A parameter is not finite.
    NotFinite,
    /// The drive moves against the command: the sign of sensor or valve is wrong, or a supply that
    /// is lost lets the air of the drive out through the inlet that the command opens. The position
    /// does not tell which.
    WrongSign,
    /// Gain, natural frequency or damping is out of the range of the drive's data.
    OutOfRange,
    /// The model without its integrator is unstable.
    Unstable,
    /// The standard deviations of the parameters are too large.
    Uncertain,
    /// In a free simulation the model does not follow: wrong order, structure or delay.
    PoorFit,
    /// The model in use follows better.
    NotBetter,
    /// The axis does not move although the valve is commanded: it is blocked, or the valve stays
    /// closed.
    Blocked,
    /// The axis moves, but not with the command: the valve is stuck open.
    ValveStuck,
    /// The position code does not change at all, not even by noise.
    SensorStuck,
    /// The sensor reported errors for 3 ms in a row, or for more than half of the readings, or the
    /// caller skipped as many.
    SensorFault,
    /// The valve reported an error.
    ValveFault,
    /// The axis came to the end of its travel.
    TravelEnd,
    /// The user stopped it.
    Aborted,
    /// The measured position jumped to where the axis cannot be, and stayed there.
    Implausible,
    /// The axis stayed behind its reference by more than the motion of the reference explains.
    FollowingError,
    /// The command was full for longer than the travel of the axis explains.
    Saturated,
}

impl Reason {
    /// Whether the estimate itself is wrong and begins again.
    pub(crate) const fn rejects_estimate(self) -> bool {
        matches!(
            self,
            Self::NotFinite | Self::WrongSign | Self::Unstable | Self::OutOfRange
        )
    }

    /// Whether the machine has a fault: with a wrong sign the verified model would drive the axis
    /// to its end.
    pub(crate) const fn is_fault(self) -> bool {
        matches!(
            self,
            Self::WrongSign
                | Self::SensorStuck
                | Self::ValveStuck
                | Self::Blocked
                | Self::TravelEnd
        )
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a parameter is not a finite number",
            Self::WrongSign => {
                "the axis moves against the command: sign of sensor or valve is wrong, or the supply is lost"
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
            Self::Implausible => "the measured position jumped to where the axis cannot be",
            Self::FollowingError => "the axis does not follow its reference",
            Self::Saturated => "the full command lasts longer than any move",
        })
    }
}

/// State of the supervisor.
///
/// ```text
/// Idle -> Exciting -> Identifying -> Verified -> Adapting <-> Frozen
///             |            |                        |
///             `------------+-> Failed(reason)       `-> Rejected(reason) -> Frozen, each in control -> Failed(reason)
///                          `-> Rejected(reason) when an older verified model exists
/// ```
///
/// The order is part of the link's protocol: new states come last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
#[non_exhaustive]
pub enum State {
    /// Nothing controls: before a commissioning, and behind an abort. The valve is in its middle,
    /// as far as that is known.
    Idle,
    /// The axis is moved; too early for a model.
    Exciting,
    /// The axis is moved, and models are validated.
    Identifying,
    /// A model passed; the controller takes the axis over.
    Verified,
    /// The controller runs, the model follows the drive.
    Adapting,
    /// The controller runs, nothing moves enough to learn from: gains stay.
    Frozen,
    /// A model was rejected, the last verified model is in force.
    Rejected(Reason),
    /// There is no usable model, or the machine has a fault: the axis stops, then the valve is in
    /// its middle.
    Failed(Reason),
}

impl State {
    /// The code of the state on the link.
    pub const fn code(self) -> u8 {
        match self {
            Self::Idle => 0,
            Self::Exciting => 1,
            Self::Identifying => 2,
            Self::Verified => 3,
            Self::Adapting => 4,
            Self::Frozen => 5,
            Self::Rejected(_) => 6,
            Self::Failed(_) => 7,
        }
    }

    /// Why a model was rejected or the drive failed.
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Self::Rejected(reason) | Self::Failed(reason) => Some(reason),
            _ => None,
        }
    }

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

#[cfg(test)]
mod tests {
    extern crate std;

    use std::collections::BTreeSet;
    use std::string::ToString;

    use super::*;

    #[test]
    fn every_reason_has_a_sentence_of_its_own() {
        use Reason as R;
        let all = [
            (R::NotFinite, true, false),
            (R::WrongSign, true, true),
            (R::OutOfRange, true, false),
            (R::Unstable, true, false),
            (R::Uncertain, false, false),
            (R::PoorFit, false, false),
            (R::NotBetter, false, false),
            (R::Blocked, false, true),
            (R::ValveStuck, false, true),
            (R::SensorStuck, false, true),
            (R::SensorFault, false, false),
            (R::ValveFault, false, false),
            (R::TravelEnd, false, true),
            (R::Aborted, false, false),
            (R::Implausible, false, false),
            (R::FollowingError, false, false),
            (R::Saturated, false, false),
        ];
        let texts: BTreeSet<_> = all.iter().map(|(reason, ..)| reason.to_string()).collect();
        assert_eq!(texts.len(), all.len());
        assert!(texts.iter().all(|text| text.len() > 10));
        for (number, (reason, estimate, fault)) in all.into_iter().enumerate() {
            // The order is that of the wire.
            assert_eq!(reason as usize, number);
            assert_eq!(reason.rejects_estimate(), estimate, "{reason:?}");
            assert_eq!(reason.is_fault(), fault, "{reason:?}");
        }
    }

    #[test]
    fn every_state_has_its_code_its_text_and_its_part_in_the_loop() {
        let reason = Reason::PoorFit;
        let all = [
            (State::Idle, "idle", false, false),
            (State::Exciting, "exciting", true, false),
            (State::Identifying, "identifying", true, false),
            (State::Verified, "verified", false, true),
            (State::Adapting, "adapting", false, true),
            (State::Frozen, "frozen", false, true),
            (State::Rejected(reason), "rejected: ", false, true),
            (State::Failed(reason), "failed: ", false, false),
        ];
        for (number, (state, text, commissions, controls)) in all.into_iter().enumerate() {
            assert_eq!(usize::from(state.code()), number);
            assert!(state.to_string().starts_with(text), "{state}");
            assert_eq!(state.is_commissioning(), commissions, "{state}");
            assert_eq!(state.is_controlling(), controls, "{state}");
            let known = number >= 6;
            assert_eq!(state.reason(), known.then_some(reason), "{state}");
            assert_eq!(state.to_string().contains(&reason.to_string()), known);
        }
    }
}
