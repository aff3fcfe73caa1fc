//! What happens to the drive in a scenario, and which refusal is right for it.

use trendid::servo::Reason;

/// What happens to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scenario {
    /// Commissioning, 60 mm steps, sines of 0.5 and 1 Hz.
    Nominal,
    /// The moving mass is tripled in motion.
    Mass,
    /// The supply falls from 6 to 4 bar in motion.
    Supply,
    /// The valve loses 30 % of its gain in motion.
    ValveGain,
    /// Friction doubles in motion.
    Friction,
    /// 60 s at rest, then motion.
    Rest,
    /// The valve is connected the wrong way round.
    WrongSign,
    /// The plant is not what the model assumes: a spring holds it and the valve is slow.
    WrongOrder,
    /// The sensor repeats its last code.
    StuckSensor,
    /// The spool stays where it is.
    StuckValve,
    /// The slide is clamped.
    BlockedAxis,
}

impl Scenario {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Nominal,
        Self::Mass,
        Self::Supply,
        Self::ValveGain,
        Self::Friction,
        Self::Rest,
        Self::WrongSign,
        Self::WrongOrder,
        Self::StuckSensor,
        Self::StuckValve,
        Self::BlockedAxis,
    ];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Mass => "mass",
            Self::Supply => "supply",
            Self::ValveGain => "valve-gain",
            Self::Friction => "friction",
            Self::Rest => "rest",
            Self::WrongSign => "wrong-sign",
            Self::WrongOrder => "wrong-order",
            Self::StuckSensor => "stuck-sensor",
            Self::StuckValve => "stuck-valve",
            Self::BlockedAxis => "blocked-axis",
        }
    }

    /// The scenario of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// One sentence for a person.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Nominal => "commissioning, 60 mm steps, sines of 0.5 and 1 Hz",
            Self::Mass => "the moving mass is tripled in motion",
            Self::Supply => "the supply falls from 6 to 4 bar in motion",
            Self::ValveGain => "the valve loses 30 % of its gain in motion",
            Self::Friction => "friction doubles in motion",
            Self::Rest => "60 s at rest under noise, then motion",
            Self::WrongSign => "the valve is connected the wrong way round",
            Self::WrongOrder => "the plant has another order than the model",
            Self::StuckSensor => "the sensor repeats its last code",
            Self::StuckValve => "the spool stays where it is",
            Self::BlockedAxis => "the slide is clamped",
        }
    }

    /// Whether the drive changes in motion.
    pub const fn is_change(self) -> bool {
        matches!(
            self,
            Self::Mass | Self::Supply | Self::ValveGain | Self::Friction
        )
    }

    /// Whether the drive has a fault that must be refused, and the reasons that are right for it.
    pub fn expected(self) -> Option<&'static [Reason]> {
        match self {
            Self::WrongSign => Some(&[Reason::WrongSign]),
            Self::WrongOrder => Some(&[Reason::PoorFit]),
            Self::StuckSensor => Some(&[Reason::SensorStuck]),
            Self::StuckValve => Some(&[Reason::ValveStuck]),
            Self::BlockedAxis => Some(&[Reason::Blocked]),
            _ => None,
        }
    }
}
