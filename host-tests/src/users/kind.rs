//! Structures that a user may tell.

/// A structure of a model, which is also that of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Order 3 behind an integrator, constant and initial state: the one to start with.
    Servo,
    /// Order 3 behind an integrator, nothing else.
    ServoPlain,
    /// As [`Kind::Servo`] with a zero.
    ServoZero,
    /// As [`Kind::Servo`] behind a valve with a dead zone, whose width is found.
    ServoDeadZone,
    /// Order 4 behind an integrator, constant and initial state.
    Fourth,
    /// Order 2 behind an integrator, constant and initial state.
    Motor,
    /// Order 2 behind an integrator, nothing else.
    MotorPlain,
    /// Order 2 with a constant.
    Oscillator,
    /// Order 2.
    OscillatorPlain,
    /// Order 2 with a zero.
    OscillatorZero,
    /// Order 1 with a constant.
    Lag,
    /// Order 1.
    LagPlain,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Servo,
        Self::ServoPlain,
        Self::ServoZero,
        Self::ServoDeadZone,
        Self::Fourth,
        Self::Motor,
        Self::MotorPlain,
        Self::Oscillator,
        Self::OscillatorPlain,
        Self::OscillatorZero,
        Self::Lag,
        Self::LagPlain,
    ];

    /// Name on the command line and in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Servo => "servo",
            Self::ServoPlain => "servo-plain",
            Self::ServoZero => "servo-zero",
            Self::ServoDeadZone => "servo-dead-zone",
            Self::Fourth => "fourth",
            Self::Motor => "motor",
            Self::MotorPlain => "motor-plain",
            Self::Oscillator => "oscillator",
            Self::OscillatorPlain => "oscillator-plain",
            Self::OscillatorZero => "oscillator-zero",
            Self::Lag => "lag",
            Self::LagPlain => "lag-plain",
        }
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether the drive integrates: its output is a position.
    pub const fn integrates(self) -> bool {
        matches!(
            self,
            Self::Servo
                | Self::ServoPlain
                | Self::ServoZero
                | Self::ServoDeadZone
                | Self::Fourth
                | Self::Motor
                | Self::MotorPlain
        )
    }

    /// Whether the model has a constant, so that the valve may have an offset; that of a valve with
    /// a dead zone has none.
    pub const fn has_offset(self) -> bool {
        matches!(
            self,
            Self::Servo
                | Self::ServoZero
                | Self::Fourth
                | Self::Motor
                | Self::Oscillator
                | Self::Lag
        )
    }

    /// Denominator and numerator, ascending, the first monic, of natural frequency w \[rad/s\] and
    /// damping xi; `gain` is the static gain, or behind an integrator the travel in 1/w under a
    /// command of 1, `zero` and `pole` the further ones \[rad/s\].
    pub fn coefficients(
        self,
        w: f64,
        xi: f64,
        gain: f64,
        [zero, pole]: [f64; 2],
    ) -> (Vec<f64>, Vec<f64>) {
        let (w2, a1) = (w * w, 2.0 * xi * w);
        let b0 = |factor: f64| vec![gain * factor];
        let with_zero = |factor: f64| vec![gain * factor, gain * factor / zero];
        match self {
            Self::Servo | Self::ServoPlain | Self::ServoDeadZone => (vec![0.0, w2, a1], b0(w * w2)),
            Self::ServoZero => (vec![0.0, w2, a1], with_zero(w * w2)),
            Self::Fourth => (
                vec![0.0, w2 * pole, w2 + a1 * pole, pole + a1],
                b0(w * w2 * pole),
            ),
            Self::Motor | Self::MotorPlain => (vec![0.0, w], b0(w2)),
            Self::Oscillator | Self::OscillatorPlain => (vec![w2, a1], b0(w2)),
            Self::OscillatorZero => (vec![w2, a1], with_zero(w2)),
            Self::Lag | Self::LagPlain => (vec![w], b0(w)),
        }
    }
}
