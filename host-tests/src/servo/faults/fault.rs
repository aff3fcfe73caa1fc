//! The faults, and the reasons that are right for them.

use trendid::servo::Reason;

/// What breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Fault {
    /// No reading succeeds any more.
    LostReadings,
    /// Two of three readings fail.
    GappyReadings,
    /// The code stays.
    StuckCode,
    /// The position stays under the noise of the sensor.
    StuckValue,
    /// Positions are counted the other way from here on.
    SensorSign,
    /// All codes are a quarter of the travel off from here on.
    Jump,
    /// One code is a quarter of the travel off, once in 0.1 s.
    Spikes,
    /// The code stays for 100 ms.
    ShortlyStuck,
    /// The valve stays closed.
    ClosedValve,
    /// The spool stays where it is.
    StuckValve,
    /// The valve opens the other way.
    ReversedValve,
    /// The valve refuses its commands and closes.
    FailedValve,
    /// The slide is clamped.
    BlockedAxis,
    /// The supply is gone.
    LostSupply,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::LostReadings,
        Self::GappyReadings,
        Self::StuckCode,
        Self::StuckValue,
        Self::SensorSign,
        Self::Jump,
        Self::Spikes,
        Self::ShortlyStuck,
        Self::ClosedValve,
        Self::StuckValve,
        Self::ReversedValve,
        Self::FailedValve,
        Self::BlockedAxis,
        Self::LostSupply,
    ];

    /// Key of the figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LostReadings => "lost_readings",
            Self::GappyReadings => "gappy_readings",
            Self::StuckCode => "stuck_code",
            Self::StuckValue => "stuck_value",
            Self::SensorSign => "sensor_sign",
            Self::Jump => "jump",
            Self::Spikes => "spikes",
            Self::ShortlyStuck => "shortly_stuck",
            Self::ClosedValve => "closed_valve",
            Self::StuckValve => "stuck_valve",
            Self::ReversedValve => "reversed_valve",
            Self::FailedValve => "failed_valve",
            Self::BlockedAxis => "blocked_axis",
            Self::LostSupply => "lost_supply",
        }
    }

    /// Whether the loop must bear it without a stop; a stop for one of [`Fault::reasons`] is right
    /// as well.
    pub const fn is_borne(self) -> bool {
        matches!(self, Self::Spikes | Self::ShortlyStuck)
    }

    /// Whether the axis moves the other way from then on.
    pub const fn changes_sign(self) -> bool {
        matches!(self, Self::SensorSign | Self::ReversedValve)
    }

    /// The reasons that are right. Where position and commands are the same for two faults, both
    /// are: a valve that stays closed, a clamped slide, a position that stays under its noise; a
    /// spool stuck where friction or an end of the travel holds the axis is as good as closed, and
    /// where leaks move the axis a closed one is a spool stuck near its middle. A
    /// supply that is lost lets the air out through the inlet that a command opens, so that the
    /// axis moves against it as behind a reversed valve.
    ///
    /// `silent`: the noise of the sensor does not reach from code to code, so that an axis at rest
    /// has one code.
    pub const fn reasons(self, silent: bool) -> &'static [Reason] {
        match self {
            Self::LostReadings | Self::GappyReadings => &[Reason::SensorFault],
            Self::StuckCode if !silent => &[Reason::SensorStuck],
            // What ends with a jump.
            Self::ShortlyStuck => &[Reason::SensorStuck, Reason::Blocked, Reason::Implausible],
            Self::ClosedValve if silent => {
                &[Reason::SensorStuck, Reason::Blocked, Reason::ValveStuck]
            }
            Self::StuckCode | Self::StuckValue | Self::BlockedAxis if silent => {
                &[Reason::SensorStuck, Reason::Blocked]
            }
            Self::StuckCode => &[Reason::SensorStuck],
            Self::StuckValue | Self::BlockedAxis => &[Reason::Blocked],
            Self::ClosedValve => &[Reason::Blocked, Reason::ValveStuck],
            Self::ReversedValve => &[Reason::WrongSign],
            // At speed, positions that run back at once cannot be.
            Self::SensorSign => &[Reason::WrongSign, Reason::Implausible],
            Self::Jump => &[Reason::Implausible],
            Self::Spikes => &[],
            Self::StuckValve if silent => {
                &[Reason::ValveStuck, Reason::Blocked, Reason::SensorStuck]
            }
            Self::StuckValve => &[Reason::ValveStuck, Reason::Blocked],
            Self::FailedValve => &[Reason::ValveFault],
            // Without air the axis stops, falls or is late.
            Self::LostSupply if silent => &[
                Reason::SensorStuck,
                Reason::Blocked,
                Reason::ValveStuck,
                Reason::WrongSign,
                Reason::FollowingError,
                Reason::Saturated,
            ],
            Self::LostSupply => &[
                Reason::Blocked,
                Reason::ValveStuck,
                Reason::WrongSign,
                Reason::FollowingError,
                Reason::Saturated,
            ],
        }
    }

    /// Whether it needs the mechanics of a pneumatic axis.
    pub const fn is_mechanical(self) -> bool {
        matches!(self, Self::BlockedAxis | Self::LostSupply)
    }
}
