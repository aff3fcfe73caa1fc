//! One fault in one state of the loop.

use rand::RngExt;
use trendid::servo::{Reason, State};

use crate::servo::faults::fault::Fault;
use crate::servo::faults::machine::Machine;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::range::{Purpose, stream};
use crate::servo::population::sequence::amplitude;

/// When the fault comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Situation {
    /// While the axis is excited, from power-up.
    Commissioning,
    /// In the sample in which a commissioning has verified its model.
    Verified,
    /// A short while after a move, the reference at rest; it moves again 1.5 s later.
    Rest,
    /// In a sine of 0.5 Hz.
    Motion,
    /// The same with gains that stay as they are.
    FixedGains,
    /// After 2 s at rest, the state is frozen; it moves 1.5 s later.
    Frozen,
}

impl Situation {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Commissioning,
        Self::Verified,
        Self::Rest,
        Self::Motion,
        Self::FixedGains,
        Self::Frozen,
    ];

    /// Key of the figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Commissioning => "commissioning",
            Self::Verified => "verified",
            Self::Rest => "rest",
            Self::Motion => "motion",
            Self::FixedGains => "fixed_gains",
            Self::Frozen => "frozen",
        }
    }

    const fn is_commissioned(self) -> bool {
        matches!(self, Self::Commissioning | Self::Verified)
    }
}

/// What came of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultRun {
    /// The axis.
    pub seed: u64,
    /// The fault.
    pub fault: Fault,
    /// The state.
    pub situation: Situation,
    /// Why the loop stopped, and the time from the fault to that \[s\].
    pub stopped: Option<(Reason, f64)>,
    /// Whether the loop goes on, and may: it bears the fault.
    pub borne: bool,
    /// Whether the reason is one of the right ones, or the fault was rightly borne.
    pub right: bool,
    /// Hardest blow to an end stop after the fault \[mm/s\].
    pub blow_mm_s: f64,
    /// The same with the valve closed at the moment of the fault: what physics allows.
    pub physics_mm_s: f64,
    /// The same with the valve closed at the moment at which the loop noticed.
    pub noticed_mm_s: f64,
}

/// Time after a fault in which it must be noticed \[s\].
const OBSERVED: f64 = 6.0;

/// Brings the machine to the moment before a fault; `None` when it does not come to that.
pub fn prepare(axis: &AxisDraw, situation: Situation) -> Option<Machine> {
    let adaptive = situation != Situation::FixedGains;
    let mut machine = Machine::new(axis, adaptive, !situation.is_commissioned())?;
    let mut random = stream(axis.seed, Purpose::Sequence);
    let length = axis.stroke_mm();
    let mut place = || length * random.random_range(0.2..0.8);
    let wait = wait_of(axis.seed);
    if situation.is_commissioned() {
        machine.servo.commission();
        let end = machine.bench.time() + 3.0;
        while machine.bench.time() < end {
            let state = machine.step().state;
            if situation == Situation::Commissioning && machine.bench.time() > wait {
                return state.is_commissioning().then_some(machine);
            }
            if state == State::Verified {
                return Some(machine);
            }
        }
        return None;
    }
    let _ = machine.servo.move_to(place() as f32);
    match situation {
        Situation::Motion | Situation::FixedGains => {
            machine.pass(2.0);
            let _ = machine.servo.move_to((0.5 * length) as f32);
            machine.pass(3.0);
            let size = amplitude(axis, 0.2, 0.5);
            machine.servo.oscillate(size as f32, 0.5).ok()?;
            machine.pass(2.0 + 6.0 * wait);
        }
        Situation::Frozen => machine.pass(4.0),
        _ => {
            arrive(&mut machine);
            machine.pass(0.05);
        }
    }
    let state = machine.servo.supervisor().state();
    state.is_controlling().then_some(machine)
}

/// Time before a fault that belongs to a seed \[s\]: 0.05 to 0.35.
fn wait_of(seed: u64) -> f64 {
    0.05 + 0.3 * stream(seed, Purpose::Tuning).random::<f64>()
}

/// Waits until the reference rests.
fn arrive(machine: &mut Machine) {
    let end = machine.bench.time() + 10.0;
    let mut moved = false;
    while machine.bench.time() < end {
        let rests = machine.step().setpoint.is_rest();
        moved |= !rests;
        if moved && rests {
            return;
        }
    }
}

/// Goes on until the sign is known: one that changes before is that of other wiring.
fn await_sign(machine: &mut Machine) -> Option<()> {
    let end = machine.bench.time() + 3.0;
    while machine.bench.time() < end {
        match machine.step().state {
            State::Exciting => {}
            State::Identifying => {
                machine.pass(wait_of(machine.seed()));
                let state = machine.servo.supervisor().state();
                return state.is_commissioning().then_some(());
            }
            _ => return None,
        }
    }
    None
}

/// Runs one fault; `None` when the axis does not come to the situation.
pub fn run(axis: &AxisDraw, situation: Situation, fault: Fault) -> Option<FaultRun> {
    broken(prepare(axis, situation)?, axis, situation, fault)
}

/// Runs one fault from its moment on.
pub fn broken(
    mut machine: Machine,
    axis: &AxisDraw,
    situation: Situation,
    fault: Fault,
) -> Option<FaultRun> {
    if fault.is_mechanical() {
        machine.bench.pneumatic_mut()?;
    }
    if fault.changes_sign() && situation == Situation::Commissioning {
        await_sign(&mut machine)?;
    }
    machine.break_down(fault);
    let physics_mm_s = machine.closing();
    let begin = machine.bench.time();
    let (mut stopped, mut noticed_mm_s, mut moved) = (None, 0.0, false);
    while machine.bench.time() < begin + OBSERVED {
        let passed = machine.bench.time() - begin;
        if !moved && passed > 1.5 && situation != Situation::Commissioning {
            moved = true;
            if !matches!(situation, Situation::Motion | Situation::FixedGains) {
                // To the other half of the travel.
                let here = machine.bench.position_mm() / axis.stroke_mm();
                let target = if here < 0.5 { 0.7 } else { 0.3 };
                let _ = machine.servo.move_to((target * axis.stroke_mm()) as f32);
            }
        }
        let report = machine.step();
        if let (State::Failed(reason), None) = (report.state, stopped) {
            stopped = Some((reason, machine.bench.time() - begin));
            noticed_mm_s = machine.closing().max(machine.bench.blow_mm_s);
        }
    }
    let silent = machine.is_silent();
    let borne = stopped.is_none() && fault.is_borne();
    let right = stopped.map_or(borne, |(reason, _)| fault.reasons(silent).contains(&reason));
    Some(FaultRun {
        seed: axis.seed,
        fault,
        situation,
        stopped,
        borne,
        right,
        blow_mm_s: machine.bench.blow_mm_s,
        physics_mm_s,
        noticed_mm_s,
    })
}
