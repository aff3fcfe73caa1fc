//! One axis with the loop, the loop with fixed gains, and the practitioner.

use trendid::servo::Reason;

use crate::servo::population::adaptive::{Commissioned, LoopPositioner};
use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::family::Family;
use crate::servo::population::practitioner::Practitioner;
use crate::servo::population::range::Purpose;
use crate::servo::population::search::tuned;
use crate::servo::population::sequence::{Exercise, Motion};

/// What the loop made of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoopRun {
    /// Why the settings were refused.
    pub settings: Option<String>,
    /// The commissioning.
    pub commissioned: Commissioned,
    /// Motion under control, when it came to that.
    pub motion: Option<Motion>,
    /// Why the loop stopped the axis in control.
    pub stopped: Option<Reason>,
    /// Hardest blow to an end stop, commissioning included \[mm/s\].
    pub blow_mm_s: f64,
}

/// One axis with everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The axis.
    pub axis: AxisDraw,
    /// The loop.
    pub adaptive: LoopRun,
    /// The loop with the gains of its commissioning.
    pub fixed: LoopRun,
    /// The practitioner, and his hardest blow to an end stop \[mm/s\].
    pub practitioner: Motion,
    /// Hardest blow to an end stop by the practitioner's controller \[mm/s\].
    pub practitioner_blow_mm_s: f64,
}

impl Trial {
    /// Draws an axis and runs everything on it.
    pub fn run(family: Family, usual: bool, seed: u64) -> Self {
        let axis = AxisDraw::new(family, usual, seed);
        let (practitioner, practitioner_blow_mm_s) = practitioner(&axis);
        Self {
            axis,
            adaptive: with_loop(&axis, true),
            fixed: with_loop(&axis, false),
            practitioner,
            practitioner_blow_mm_s,
        }
    }
}

/// Commissions the loop from power-up, and no more.
pub fn commissioned(family: Family, usual: bool, seed: u64) -> LoopRun {
    run_loop(&AxisDraw::new(family, usual, seed), true, false)
}

/// Commissions the loop from power-up and runs the sequence with it.
pub fn with_loop(axis: &AxisDraw, adaptive: bool) -> LoopRun {
    run_loop(axis, adaptive, true)
}

fn run_loop(axis: &AxisDraw, adaptive: bool, moves: bool) -> LoopRun {
    let mut bench = Bench::new(axis, Purpose::Disturbance);
    let mut run = LoopRun::default();
    match LoopPositioner::new(axis, adaptive) {
        Err(error) => run.settings = Some(error.to_string()),
        Ok(mut positioner) => {
            run.commissioned = positioner.commission(&mut bench);
            if moves && run.commissioned.verified_s.is_some() {
                run.motion = Some(Exercise::new(&mut bench, &mut positioner).run());
                run.stopped = positioner.stopped();
            }
        }
    }
    run.blow_mm_s = bench.blow_mm_s;
    run
}

/// Tunes the controller of a practitioner on the axis and runs the sequence with it, rightly wired.
pub fn practitioner(axis: &AxisDraw) -> (Motion, f64) {
    let gains = tuned(axis);
    let mut bench = Bench::new(axis, Purpose::Disturbance);
    bench.reversed = false;
    let mut controller = Practitioner::new(axis, &gains, bench.measure_mm());
    let motion = Exercise::new(&mut bench, &mut controller).run();
    (motion, bench.blow_mm_s)
}
