//! States and reasons by their numbers on the wire.

use trendid::servo::{Reason, State};

/// The reasons in the order of their numbers on the wire.
const REASONS: [Reason; 17] = [
    Reason::NotFinite,
    Reason::WrongSign,
    Reason::OutOfRange,
    Reason::Unstable,
    Reason::Uncertain,
    Reason::PoorFit,
    Reason::NotBetter,
    Reason::Blocked,
    Reason::ValveStuck,
    Reason::SensorStuck,
    Reason::SensorFault,
    Reason::ValveFault,
    Reason::TravelEnd,
    Reason::Aborted,
    Reason::Implausible,
    Reason::FollowingError,
    Reason::Saturated,
];

// A reason that is not in its place would be told under another name.
const _: () = {
    let mut place = 0;
    while place < REASONS.len() {
        assert!(REASONS[place] as usize == place);
        place += 1;
    }
};

/// The reason with a number; `None` for one of a newer version.
#[must_use]
pub fn reason_of(number: u8) -> Option<Reason> {
    REASONS.get(usize::from(number)).copied()
}

/// The state with a number and the number of its reason.
#[must_use]
pub fn state_of(number: u8, reason: u8) -> Option<State> {
    Some(match number {
        0 => State::Idle,
        1 => State::Exciting,
        2 => State::Identifying,
        3 => State::Verified,
        4 => State::Adapting,
        5 => State::Frozen,
        6 => State::Rejected(reason_of(reason)?),
        7 => State::Failed(reason_of(reason)?),
        _ => return None,
    })
}
