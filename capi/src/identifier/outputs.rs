//! What an identifier gives.

use core::mem::MaybeUninit;

use trendid::Estimate as CoreEstimate;
use trendid::estimation::Parameter as CoreParameter;
use trendid::model::{Physical, Pole as CorePole};

/// Most parameters of a model.
pub const PARAMETERS_MAX: usize = 8;

/// Highest order of a model.
pub const ORDER_MAX: usize = 4;

/// Most inputs of a model: those of the caller, and the sign of a command with a dead zone.
pub const MODEL_INPUTS_MAX: usize = 3;

/// What one sample did.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleKind {
    /// The trends are settling.
    WarmingUp = 0,
    /// An input was not finite or far beyond its range: the sample was refused, its time passed.
    InputRefused = 1,
    /// The position was not finite or far beyond its range: the sample was refused, its time
    /// passed.
    OutputRefused = 2,
    /// The position was implausible (a spike) and replaced by its prediction.
    Replaced = 3,
    /// The sample was predicted; the estimate is held, by the caller or because the drive does not
    /// move.
    Held = 4,
    /// The sample was predicted and the estimate updated.
    Estimated = 5,
}

/// What one sample did.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// What happened.
    pub kind: SampleKind,
    /// Position of the refused input among those of the caller; else 0.
    pub input: u8,
    /// Samples until the first estimate, while warming up; else 0.
    pub remaining: u32,
    /// Measured minus predicted position, in the unit of y, where there was a prediction; else 0.
    pub innovation: f32,
}

impl From<trendid::Outcome> for Outcome {
    #[inline(always)]
    fn from(outcome: trendid::Outcome) -> Self {
        use trendid::Outcome as Core;
        use trendid::identifier::Refusal;
        let of = |kind, innovation| Self {
            kind,
            input: 0,
            remaining: 0,
            innovation,
        };
        match outcome {
            Core::WarmingUp { remaining } => Self {
                remaining,
                ..of(SampleKind::WarmingUp, 0.0)
            },
            Core::Refused(Refusal::Input(input)) => Self {
                input: input as u8,
                ..of(SampleKind::InputRefused, 0.0)
            },
            Core::Refused(_) => of(SampleKind::OutputRefused, 0.0),
            Core::Replaced { innovation } => of(SampleKind::Replaced, innovation),
            Core::Held { innovation } => of(SampleKind::Held, innovation),
            Core::Estimated { innovation } => of(SampleKind::Estimated, innovation),
            _ => of(SampleKind::Held, 0.0),
        }
    }
}

const _: () = assert!(
    core::mem::offset_of!(Outcome, kind) == 0
        && core::mem::offset_of!(Outcome, input) == 1
        && core::mem::offset_of!(Outcome, remaining) == 4
        && core::mem::offset_of!(Outcome, innovation) == 8
);

impl Outcome {
    /// The outcome as three words, its padding 0: one store in the place of two of a byte.
    #[inline(always)]
    pub(crate) const fn words(self) -> [u32; 3] {
        let first = u32::from_ne_bytes([self.kind as u8, self.input, 0, 0]);
        [first, self.remaining, self.innovation.to_bits()]
    }
}

/// What a parameter means.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// a_power, of y.
    A = 0,
    /// b_power of an input.
    B = 1,
    /// The contribution of a constant input 1.
    Constant = 2,
    /// Minus the error of the first position, in the unit of y.
    InitialState = 3,
}

/// The meaning of one entry of theta.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parameter {
    /// Of y, of an input, or neither.
    pub kind: ParameterKind,
    /// Which input of the model; with a dead zone 0 is the command, 1 its sign.
    pub input: u8,
    /// The power of s.
    pub power: u8,
}

impl From<CoreParameter> for Parameter {
    fn from(parameter: CoreParameter) -> Self {
        let of = |kind, input: usize, power: usize| Self {
            kind,
            input: input as u8,
            power: power as u8,
        };
        match parameter {
            CoreParameter::Output { power } => of(ParameterKind::A, 0, power),
            CoreParameter::Input { input, power } => of(ParameterKind::B, input, power),
            CoreParameter::Constant => of(ParameterKind::Constant, 0, 0),
            CoreParameter::InitialState => of(ParameterKind::InitialState, 0, 0),
        }
    }
}

/// The model found, with its uncertainty; entries beyond the sizes of the model are 0.
///
/// A standard deviation is never NaN; it is infinite where nothing is known.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Order m.
    pub order: u8,
    /// Number of inputs of the model.
    pub inputs: u8,
    /// Number of parameters.
    pub parameters: u8,
    /// Whether every pole behind the integrators is stable.
    pub stable: bool,
    /// Whether `gain` exists.
    pub has_gain: bool,
    /// Whether `omega0` and `damping` exist.
    pub has_pair: bool,
    /// Whether the standard deviations of gain, omega0 and damping exist.
    pub has_physical_std: bool,
    /// The parameters: a_i in s^(i-m), b_i in the unit of y per unit of u per s^(m-i).
    pub theta: [f32; PARAMETERS_MAX],
    /// Their standard deviations.
    pub std: [f32; PARAMETERS_MAX],
    /// a_0 .. a_(m-1) of the transfer function.
    pub a: [f32; ORDER_MAX],
    /// b_0 .. b_(m-1) of each input.
    pub b: [[f32; ORDER_MAX]; MODEL_INPUTS_MAX],
    /// The contribution of the constant input, in units of y per s^m.
    pub constant: f32,
    /// Static gain, or velocity gain C behind an integrator, of the first input: y or y/s per unit
    /// of u.
    pub gain: f32,
    /// Natural frequency in rad/s.
    pub omega0: f32,
    /// Damping ratio.
    pub damping: f32,
    /// Standard deviation of `gain`.
    pub gain_std: f32,
    /// Standard deviation of `omega0`, in rad/s.
    pub omega0_std: f32,
    /// Standard deviation of `damping`.
    pub damping_std: f32,
    /// Time constants of the real poles, longest first, in s; 0 where there is none.
    pub time_constants: [f32; ORDER_MAX],
}

/// What an estimate rests on.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// The recursion.
    Recursion = 0,
    /// Instruments, with standard deviations from blocks of time.
    Instruments = 1,
    /// The recursion: there are too few blocks for instruments yet.
    TooFewBlocks = 2,
    /// The recursion: the instruments are weak, they hardly move with what the position does.
    WeakInstruments = 3,
}

/// A pole of the model.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// Real part in rad/s.
    pub re: f32,
    /// Imaginary part in rad/s.
    pub im: f32,
}

impl From<CorePole> for Pole {
    fn from(CorePole { re, im }: CorePole) -> Self {
        Self { re, im }
    }
}

/// As many numbers as there is room for.
#[inline(always)]
fn fill<const K: usize, const L: usize>(from: &[f32; K]) -> [f32; L] {
    core::array::from_fn(|k| from.get(k).copied().unwrap_or_default())
}

impl Estimate {
    /// Tells an estimate of the core, where it is to stand: a copy of it is 45 words.
    #[inline(always)]
    pub(crate) fn tell<const M: usize, const N: usize, const I: usize>(
        found: &CoreEstimate<M, N, I>,
        to: &mut MaybeUninit<Self>,
    ) {
        let std = found.physical_std();
        let transfer = found.transfer_function();
        let physical = Physical::of(&transfer, 0);
        // No constant: the compiler would call a function for nine zeros in a row.
        let none = [core::hint::black_box(0.0); ORDER_MAX];
        let [gain_std, omega0_std, damping_std] = std.unwrap_or([0.0; 3]);
        to.write(Self {
            order: M as u8,
            inputs: I as u8,
            parameters: N as u8,
            stable: physical.stable,
            has_gain: physical.gain.is_some(),
            has_pair: physical.omega0.is_some() && physical.damping.is_some(),
            has_physical_std: std.is_some(),
            theta: fill(&found.theta()),
            std: fill(&found.std()),
            a: fill(&transfer.a),
            b: core::array::from_fn(|k| transfer.b.get(k).map_or(none, fill)),
            constant: transfer.constant,
            gain: physical.gain.unwrap_or(0.0),
            omega0: physical.omega0.unwrap_or(0.0),
            damping: physical.damping.unwrap_or(0.0),
            gain_std,
            omega0_std,
            damping_std,
            time_constants: fill(&physical.time_constants.map(Option::unwrap_or_default)),
        });
    }
}

/// What is known beside the model.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Status {
    /// Prediction of the newest position from the samples before it, in the unit of y.
    pub prediction: f32,
    /// Standard deviation of the innovation, in the unit of y; 0 while `has_noise_std` is false.
    pub noise_std: f32,
    /// Sum of the squared innovations, in the unit of y squared.
    pub ise: f32,
    /// Sum of the absolute innovations, in the unit of y.
    pub iae: f32,
    /// Number of innovations in the sums.
    pub samples: u32,
    /// How many samples of the position were replaced by their prediction.
    pub replaced: u32,
    /// How many changes of the drive were found and followed; 0 without `follow_changes`.
    pub changes: u32,
    /// Half width of the dead zone, in the unit of u; 0 for a kind without one.
    pub dead_zone: f32,
    /// Standard deviation of `dead_zone`, infinite before the first correction; 0 for a kind
    /// without one.
    pub dead_zone_std: f32,
    /// Blocks of time that carry the standard deviations by instruments, 16 at most; 0 for those of
    /// the recursion.
    pub blocks: f32,
    /// Whether there are more samples than parameters.
    pub has_noise_std: bool,
    /// What the estimate rests on: the recursion, but for the kinds with instruments.
    pub way: Way,
}
