//! One axis with its loop, sample by sample.

use trendid::servo::State;

use crate::servo::population::adaptive::{LoopPositioner, Seen};
use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::range::Purpose;
use crate::servo::population::sequence::Exercise;
use crate::servo::population::trial::LoopRun;

/// A run with all of its samples.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What came of it.
    pub run: LoopRun,
    /// Its samples, one per sample time.
    pub samples: Vec<Seen>,
}

/// The run of [`with_loop`](super::trial::with_loop) with its samples.
pub fn shown(axis: &AxisDraw, adaptive: bool) -> Shown {
    let mut bench = Bench::new(axis, Purpose::Disturbance);
    let mut run = LoopRun::default();
    let mut samples = Vec::new();
    match LoopPositioner::new(axis, adaptive) {
        Err(error) => run.settings = Some(error.to_string()),
        Ok(mut positioner) => {
            positioner.remember();
            run.commissioned = positioner.commission(&mut bench);
            if run.commissioned.verified_s.is_some() {
                run.motion = Some(Exercise::new(&mut bench, &mut positioner).run());
                run.stopped = positioner.stopped();
            }
            samples = positioner.remembered();
        }
    }
    run.blow_mm_s = bench.blow_mm_s;
    Shown { run, samples }
}

/// The states in the order in which they came, each with its first sample.
pub fn states(samples: &[Seen]) -> Vec<(usize, State)> {
    let mut states: Vec<(usize, State)> = Vec::new();
    for (k, seen) in samples.iter().enumerate() {
        if states
            .last()
            .is_none_or(|(_, last)| *last != seen.report.state)
        {
            states.push((k, seen.report.state));
        }
    }
    states
}
