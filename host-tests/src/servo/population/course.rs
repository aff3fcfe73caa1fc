//! What an axis does after its commissioning, and how its loop came through it.

use trendid::servo::Reason;

use crate::servo::population::adaptive::LoopPositioner;
use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::range::Purpose;
use crate::servo::population::sequence::Exercise;

/// How a loop came through.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The seed of the axis.
    pub seed: u64,
    /// Hardest blow to an end stop \[mm/s\].
    pub blow_mm_s: f64,
    /// Why the loop stopped.
    pub stopped: Option<Reason>,
    /// Oscillations that were noticed.
    pub oscillations: u32,
    /// Factor on the bandwidth at the end.
    pub derating: f32,
    /// Models that reached the controller.
    pub models: u32,
}

/// Commissions an axis and lets it do something, until the loop ends it. `dead_volume` is what the
/// user states. `None` of an axis that is not accepted.
pub fn course(
    axis: &AxisDraw,
    adaptive: bool,
    dead_volume: Option<f32>,
    does: impl FnOnce(&mut Exercise<'_, LoopPositioner>) -> Option<()>,
) -> Option<Course> {
    let mut bench = Bench::new(axis, Purpose::Disturbance);
    let mut positioner = LoopPositioner::knowing(axis, adaptive, dead_volume).ok()?;
    let _ = positioner.commission(&mut bench).verified_s?;
    // A run that the loop ended has the figures that it came to.
    let _ = does(&mut Exercise::new(&mut bench, &mut positioner));
    let faults = positioner.faults();
    Some(Course {
        seed: axis.seed,
        blow_mm_s: bench.blow_mm_s,
        stopped: positioner.stopped(),
        oscillations: faults.map_or(0, |faults| faults.oscillations),
        derating: faults.map_or(1.0, |faults| faults.derating),
        models: positioner.servo().supervisor().counts().0,
    })
}
