//! What a loop tells.

use core::ffi::{CStr, c_char};

use trendid::servo as core_servo;

/// State of a loop.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopState {
    /// Nothing controls: before a commissioning, and behind an abort. The valve is in its middle,
    /// as far as that is known.
    Idle = 0,
    /// The axis is moved; too early for a model.
    Exciting = 1,
    /// The axis is moved, and models are validated.
    Identifying = 2,
    /// A model passed; the controller takes the axis over.
    Verified = 3,
    /// The controller runs, the model follows the drive.
    Adapting = 4,
    /// The controller runs, nothing moves enough to learn from: gains stay.
    Frozen = 5,
    /// A model was rejected, the last verified model is in force.
    Rejected = 6,
    /// There is no usable model, or the machine has a fault: the axis stops, then the valve is in
    /// its middle.
    Failed = 7,
}

impl From<core_servo::State> for LoopState {
    fn from(state: core_servo::State) -> Self {
        use core_servo::State as Core;
        match state {
            Core::Idle => Self::Idle,
            Core::Exciting => Self::Exciting,
            Core::Identifying => Self::Identifying,
            Core::Verified => Self::Verified,
            Core::Adapting => Self::Adapting,
            Core::Frozen => Self::Frozen,
            Core::Rejected(_) => Self::Rejected,
            // A state that is not known is none to go on in.
            _ => Self::Failed,
        }
    }
}

/// The code of a reason: 0 for none, then the reasons of the core in their order.
pub(crate) fn reason_code(reason: Option<core_servo::Reason>) -> u8 {
    reason.map_or(0, |reason| (reason as u8).saturating_add(1))
}

/// The texts of the reasons, by their code.
const REASONS: [&CStr; 18] = [
    c"no reason",
    c"a parameter is not a finite number",
    c"the axis moves against the command: sign of sensor or valve is wrong, or the supply is lost",
    c"gain, frequency or damping is out of range for this axis",
    c"the model is unstable where the drive cannot be",
    c"the parameters are not certain enough",
    c"the model does not follow held-out samples: wrong order, structure or delay",
    c"the model in use follows held-out samples better",
    c"the axis does not move when commanded: it is blocked or the valve stays closed",
    c"the axis moves, but not with the command: the valve is stuck",
    c"the position code never changes: the sensor is stuck",
    c"the sensor reported errors",
    c"the valve reported an error",
    c"the axis came to the end of its travel",
    c"stopped by the user",
    c"the measured position jumped to where the axis cannot be",
    c"the axis does not follow its reference",
    c"the full command lasts longer than any move",
];

/// Why a model was refused or the axis stopped, in static memory: a `trendid_reason`, 0 for none.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_reason_text(reason: u8) -> *const c_char {
    let text = REASONS.get(usize::from(reason)).copied();
    text.unwrap_or(c"a reason that this version of the interface does not name")
        .as_ptr()
}

/// Why a model was refused, or the axis was stopped. New reasons come last.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// No reason.
    None = 0,
    /// A parameter is not finite.
    NotFinite = 1,
    /// The drive moves against the command.
    WrongSign = 2,
    /// Gain, natural frequency or damping is out of range.
    OutOfRange = 3,
    /// The model without its integrator is unstable.
    Unstable = 4,
    /// The standard deviations of the parameters are too large.
    Uncertain = 5,
    /// In a free simulation the model does not follow: wrong order, structure or delay.
    PoorFit = 6,
    /// The model in use follows better.
    NotBetter = 7,
    /// The axis does not move although the valve is commanded.
    Blocked = 8,
    /// The axis moves, but not with the command.
    ValveStuck = 9,
    /// The position code does not change at all.
    SensorStuck = 10,
    /// The sensor failed.
    SensorFault = 11,
    /// The valve reported an error.
    ValveFault = 12,
    /// The axis came to the end of its travel.
    TravelEnd = 13,
    /// The user stopped it.
    Aborted = 14,
    /// The measured position jumped to where the axis cannot be.
    Implausible = 15,
    /// The axis stayed behind its reference.
    FollowingError = 16,
    /// The command was full for longer than the travel explains.
    Saturated = 17,
}

/// What one sample of a loop did.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// State after the sample, a `trendid_loop_state`.
    pub state: LoopState,
    /// Why a model was rejected or the loop failed: a `trendid_reason`, 0 for none.
    pub reason: u8,
    /// Whether a model reached the controller in this sample.
    pub retuned: bool,
    /// Whether there is an innovation.
    pub has_innovation: bool,
    /// The command for the valve, -1 to 1, on a step of the output: write it now.
    pub command: f32,
    /// Measured position, in the unit of y; where the axis should be when the sensor failed.
    pub position: f32,
    /// The reference, in the unit of y; the position outside of control.
    pub reference: f32,
    /// Velocity of the reference, in units of y per s.
    pub reference_velocity: f32,
    /// Innovation of the identifier, in the unit of y; 0 where there is none.
    pub innovation: f32,
    /// Readings that failed, since the start.
    pub failed_readings: u32,
    /// Readings that the axis cannot have reached; each was replaced by the expected position.
    pub implausible_readings: u32,
    /// Samples at the full command.
    pub saturated_samples: u32,
    /// Oscillations at rest that were noticed.
    pub oscillations: u32,
    /// Faults that stopped the axis; a commissioning that gives up is none.
    pub stops: u32,
    /// Factor on the bandwidth of the controller; 1 unless an oscillation was noticed.
    pub derating: f32,
    /// Departures from where the axis was while its reference rests: slips, creep and every half
    /// wave of a cycle.
    pub moves_at_rest: u32,
}

impl From<core_servo::Report> for Report {
    #[inline]
    fn from(report: core_servo::Report) -> Self {
        let faults = report.faults;
        Self {
            state: report.state.into(),
            reason: reason_code(report.state.reason()),
            retuned: report.retuned,
            has_innovation: report.innovation.is_some(),
            command: report.command,
            position: report.position,
            reference: report.setpoint.position,
            reference_velocity: report.setpoint.velocity,
            innovation: report.innovation.unwrap_or(0.0),
            failed_readings: faults.failed_readings,
            implausible_readings: faults.implausible_readings,
            saturated_samples: faults.saturated_samples,
            oscillations: faults.oscillations,
            stops: faults.stops,
            derating: faults.derating,
            moves_at_rest: faults.moves_at_rest,
        }
    }
}

/// A position drive of order 3 behind a valve: `x''' = - a1 x' - a2 x'' + b0 (q(u) + offset)`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Square of the natural frequency, in 1/s^2.
    pub a1: f32,
    /// Twice damping times natural frequency, in 1/s.
    pub a2: f32,
    /// Gain of the command, in units of y per s^3.
    pub b0: f32,
    /// Half width of the dead zone of the valve, in the unit of u.
    pub dead_zone: f32,
    /// Effective command at a command of zero.
    pub offset: f32,
    /// Coulomb friction, as the acceleration that it takes away, in units of y per s^2.
    pub friction: f32,
}

impl From<core_servo::Model> for Model {
    fn from(model: core_servo::Model) -> Self {
        let [a1, a2, b0, dead_zone, offset, friction] = model.fields();
        Self {
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
        }
    }
}

impl From<Model> for core_servo::Model {
    fn from(model: Model) -> Self {
        let Model {
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
        } = model;
        Self::from_fields([a1, a2, b0, dead_zone, offset, friction])
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use core_servo::Reason as Core;

    use super::*;

    #[test]
    fn reasons_are_those_of_the_core() {
        let all = [
            (Core::NotFinite, Reason::NotFinite),
            (Core::WrongSign, Reason::WrongSign),
            (Core::OutOfRange, Reason::OutOfRange),
            (Core::Unstable, Reason::Unstable),
            (Core::Uncertain, Reason::Uncertain),
            (Core::PoorFit, Reason::PoorFit),
            (Core::NotBetter, Reason::NotBetter),
            (Core::Blocked, Reason::Blocked),
            (Core::ValveStuck, Reason::ValveStuck),
            (Core::SensorStuck, Reason::SensorStuck),
            (Core::SensorFault, Reason::SensorFault),
            (Core::ValveFault, Reason::ValveFault),
            (Core::TravelEnd, Reason::TravelEnd),
            (Core::Aborted, Reason::Aborted),
            (Core::Implausible, Reason::Implausible),
            (Core::FollowingError, Reason::FollowingError),
            (Core::Saturated, Reason::Saturated),
        ];
        assert_eq!(all.len() + 1, REASONS.len());
        for (core, reason) in all {
            assert_eq!(reason_code(Some(core)), reason as u8);
            // SAFETY: a text in static memory that ends with 0.
            let text = unsafe { CStr::from_ptr(trendid_reason_text(reason as u8)) };
            assert_eq!(text.to_str(), Ok(core.to_string().as_str()));
        }
        assert_eq!(reason_code(None), Reason::None as u8);
    }
}
