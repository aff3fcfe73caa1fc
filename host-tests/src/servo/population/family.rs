//! The families of axes and the ranges of their properties.

use crate::servo::population::range::Range;

/// What kind of drive moves the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// A pneumatic cylinder with a proportional valve.
    Pneumatic,
    /// The same with a rod through one of its chambers: quicker one way than the other.
    SingleRod,
    /// A linear drive of third order without friction, behind a valve.
    Linear,
    /// An electric ball screw with its own velocity control.
    BallScrew,
    /// A hydraulic cylinder: stiff and badly damped.
    Hydraulic,
    /// The same with one rod: quicker one way than the other.
    Differential,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Pneumatic,
        Self::SingleRod,
        Self::Linear,
        Self::BallScrew,
        Self::Hydraulic,
        Self::Differential,
    ];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pneumatic => "pneumatic",
            Self::SingleRod => "single-rod",
            Self::Linear => "linear",
            Self::BallScrew => "ball-screw",
            Self::Hydraulic => "hydraulic",
            Self::Differential => "differential",
        }
    }

    /// The family of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.name() == name)
    }

    /// Natural frequency in the middle of the travel \[rad/s\].
    pub const fn omega0(self) -> Range {
        match self {
            Self::Pneumatic | Self::SingleRod => Range::ratio(8.0, 30.0, 90.0),
            Self::Linear => Range::ratio(5.0, 30.0, 100.0),
            Self::BallScrew => Range::ratio(20.0, 50.0, 100.0),
            Self::Hydraulic | Self::Differential => Range::ratio(40.0, 80.0, 150.0),
        }
    }

    /// Damping, of a pneumatic axis what its parts make it.
    pub const fn xi(self) -> Range {
        match self {
            Self::Pneumatic | Self::SingleRod => Range::ratio(1e-3, 0.2, 10.0),
            Self::Linear => Range::ratio(0.1, 0.5, 1.2),
            Self::BallScrew => Range::ratio(0.4, 0.7, 1.0),
            Self::Hydraulic | Self::Differential => Range::ratio(0.05, 0.12, 0.3),
        }
    }

    /// Bandwidth of the valve \[Hz\].
    pub const fn valve_hz(self) -> Range {
        match self {
            Self::Hydraulic | Self::Differential => Range::ratio(60.0, 100.0, 150.0),
            _ => Range::ratio(25.0, 100.0, 150.0),
        }
    }

    /// Half width of the dead zone of the valve, in units of the command.
    pub const fn dead_zone(self) -> Range {
        match self {
            Self::Pneumatic | Self::SingleRod | Self::Linear => Range::even(0.0, 0.04, 0.15),
            Self::BallScrew => Range::even(0.0, 0.002, 0.01),
            Self::Hydraulic | Self::Differential => Range::even(0.0, 0.02, 0.05),
        }
    }

    /// Offset of the valve, in units of the command.
    pub const fn offset(self) -> Range {
        match self {
            Self::Pneumatic | Self::SingleRod | Self::Linear => Range::even(-0.08, 0.0, 0.08),
            Self::BallScrew | Self::Hydraulic | Self::Differential => Range::even(-0.02, 0.0, 0.02),
        }
    }

    /// Coulomb friction over stiffness, as a part of the travel; of a pneumatic axis over that of
    /// ordinary seals.
    pub const fn friction(self) -> Range {
        match self {
            Self::Pneumatic | Self::SingleRod => Range::even(0.0, 1.0, 3.0),
            Self::Linear => Range::even(0.0, 0.0, 0.0),
            Self::BallScrew => Range::even(0.0, 5e-5, 2e-4),
            Self::Hydraulic | Self::Differential => Range::even(0.0, 4e-5, 1.2e-4),
        }
    }
}

/// Bore of a pneumatic cylinder \[m\].
pub const BORE: Range = Range::ratio(0.012, 0.032, 0.063);
/// Rod of a cylinder with one rod over its bore: ISO 15552 and ISO 6432 have 0.32 to 0.5.
pub const ROD: Range = Range::even(0.32, 0.4, 0.5);
/// Area on the side of the rod over that of the piston, of a hydraulic cylinder: that of rods of
/// 0.45 to 0.7 of the bore.
pub const ROD_SIDE: Range = Range::even(0.5, 0.7, 0.8);
/// Travel \[mm\].
pub const STROKE: Range = Range::ratio(80.0, 300.0, 1000.0);
/// Moving mass of a pneumatic axis \[kg\].
pub const MASS: Range = Range::ratio(0.5, 5.0, 60.0);
/// Flow of the valve over what the axis needs.
pub const VALVE_SIZE: Range = Range::ratio(0.4, 1.0, 2.0);
/// Dead time \[s\].
pub const DEAD_TIME: Range = Range::even(0.0, 1e-3, 8e-3);
/// Supply pressure above ambient \[bar\].
pub const SUPPLY: Range = Range::even(4.0, 6.0, 8.0);
/// Breakaway over Coulomb friction.
pub const BREAKAWAY: Range = Range::even(1.0, 1.5, 2.5);
/// Viscous friction over that of ordinary seals.
pub const VISCOUS: Range = Range::ratio(0.2, 1.0, 3.0);
/// Gravity along the axis \[g\].
pub const GRAVITY: Range = Range::even(-1.0, 0.0, 1.0);
/// Leaks of the valve and past the piston, each as a part of the flow of the valve.
pub const LEAK: Range = Range::even(0.0, 0.002, 0.02);
/// Dead volume of a chamber over its length.
pub const DEAD_VOLUME: Range = Range::even(0.03, 0.05, 0.12);
/// Resolution of the sensor \[mm\].
pub const RESOLUTION: Range = Range::ratio(1e-3, 1e-2, 0.1);
/// Half width of the noise of the sensor \[mm\].
pub const NOISE: Range = Range::even(0.0, 0.01, 0.05);
/// Place at the start over the travel.
pub const START: Range = Range::even(0.08, 0.5, 0.92);
/// Jitter of the sampling instants over the sample time.
pub const JITTER: Range = Range::even(0.0, 0.02, 0.1);
/// Share of slots in which the loop does not run.
pub const MISSED: Range = Range::even(0.0, 0.0, 0.01);
/// Sample times \[s\]; that of a usual machine is in the middle.
pub const SAMPLE_TIMES: [f64; 3] = [5e-4, 1e-3, 2e-3];
/// Rough bandwidth that the user states over the natural frequency: the documented range.
pub const STATED_BANDWIDTH: Range = Range::ratio(0.8, 1.0, 1.4);
/// Load and breakaway over supply times area, at most; other axes are drawn again.
pub const LOAD_MAX: f64 = 0.4;
