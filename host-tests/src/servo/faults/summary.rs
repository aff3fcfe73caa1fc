//! Figures of many faults.

use std::collections::BTreeMap;

use crate::servo::faults::fault::Fault;
use crate::servo::faults::trial::FaultRun;
use crate::servo::population::summary::BLOW_MM_S;

/// Figures of a fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultFigures {
    /// Runs.
    pub runs: usize,
    /// The loop stopped, or bore what it must bear \[%\].
    pub detected_pct: f64,
    /// For the right reason \[%\].
    pub right_reason_pct: f64,
    /// Hardest blow to an end stop \[mm/s\].
    pub end_stop_max_mm_s: f64,
    /// The same of those runs in which a valve that closes at the moment of the fault prevents it
    /// \[mm/s\].
    pub avoidable_max_mm_s: f64,
    /// Blows beyond 50 mm/s that a valve that closes at the moment of the fault prevents \[%\].
    pub avoidable_pct: f64,
    /// Time from the fault to the stop: median \[s\].
    pub noticed_median_s: f64,
    /// Reasons that were given.
    pub reasons: BTreeMap<String, usize>,
}

impl FaultFigures {
    /// The figures of runs.
    pub fn new<'a>(runs: impl Iterator<Item = &'a FaultRun>) -> Self {
        let mut figures = Self::default();
        let mut times = Vec::new();
        let (mut detected, mut right, mut avoidable) = (0_usize, 0_usize, 0_usize);
        for run in runs {
            figures.runs += 1;
            detected += usize::from(run.stopped.is_some() || run.borne);
            right += usize::from(run.right);
            figures.end_stop_max_mm_s = figures.end_stop_max_mm_s.max(run.blow_mm_s);
            if run.physics_mm_s <= BLOW_MM_S {
                figures.avoidable_max_mm_s = figures.avoidable_max_mm_s.max(run.blow_mm_s);
                avoidable += usize::from(run.blow_mm_s > BLOW_MM_S);
            }
            let reason = run.stopped.map_or_else(
                || "none".to_owned(),
                |(reason, time)| {
                    times.push(time);
                    format!("{reason:?}")
                },
            );
            *figures.reasons.entry(reason).or_insert(0) += 1;
        }
        let share = |count: usize| 100.0 * count as f64 / figures.runs as f64;
        figures.detected_pct = share(detected);
        figures.right_reason_pct = share(right);
        figures.avoidable_pct = share(avoidable);
        figures.noticed_median_s = crate::servo::population::summary::quantile(&times, 0.5);
        figures
    }
}

/// The figures of every fault.
pub fn by_fault(runs: &[FaultRun]) -> Vec<(Fault, FaultFigures)> {
    Fault::ALL
        .into_iter()
        .map(|fault| {
            let own = runs.iter().filter(|run| run.fault == fault);
            (fault, FaultFigures::new(own))
        })
        .collect()
}
