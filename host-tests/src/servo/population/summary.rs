//! The figures of many axes.

use std::collections::BTreeMap;

use trendid::servo::Reason;

use crate::servo::population::sequence::Motion;
use crate::servo::population::trial::{LoopRun, Trial};

/// Speed at which touching an end stop counts as striking it \[mm/s\].
pub const BLOW_MM_S: f64 = 50.0;

/// Time within which a model counts as accepted in time \[s\].
pub const IN_TIME: f64 = 3.0;

/// Figures of the commissioning; shares are in per cent of all axes unless said otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommissioningFigures {
    /// A model was accepted within 3 s, and within 6 s of power-up.
    pub accepted_pct: f64,
    /// Within 6 s.
    pub accepted_6s_pct: f64,
    /// Time to acceptance of the accepted \[s\].
    pub verified_median_s: f64,
    /// The same that 95 % of the accepted keep \[s\].
    pub verified_p95_s: f64,
    /// Last reasons of the axes that were never accepted.
    pub refused: BTreeMap<String, usize>,
    /// A refusal named a fault that the axis does not have.
    pub wrong_reason_pct: f64,
    /// A model was accepted with the valve connected the wrong way round.
    pub wrong_sign_pct: f64,
    /// The natural frequency of the accepted model is within 10 %, of the accepted.
    pub w0_within_10pct: f64,
    /// Its velocity gain within 20 %, of the accepted.
    pub c_within_20pct: f64,
    /// One of both is wrong by more than 50 %, of the accepted.
    pub grossly_wrong_pct: f64,
    /// Errors of the dead zone and of the offset of the valve that 90 % of the accepted keep.
    pub dead_zone_p90: f64,
    /// The offset.
    pub offset_p90: f64,
    /// Error of the delay that 90 % keep \[ms\].
    pub delay_p90_ms: f64,
    /// Axes that struck an end stop at more than 50 mm/s while commissioning or after it.
    pub struck_pct: f64,
}

/// Figures of the motion of the axes that were controlled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionFigures {
    /// Axes that were controlled.
    pub controlled: usize,
    /// Control was given up during the sequence \[%\].
    pub given_up_pct: f64,
    /// Range at rest beyond 4 resolutions, 4 standard deviations of the noise and 0.05 mm \[%\].
    pub limit_cycle_pct: f64,
    /// The same while control goes on and its report counts no move \[%\].
    pub undetected_cycle_pct: f64,
    /// Largest error at the end of five large steps: median \[mm\].
    pub steady_state_median_mm: f64,
    /// The same that 90 % keep \[mm\].
    pub steady_state_p90_mm: f64,
    /// Largest error from the command of a step of 0.05 mm on: median \[mm\].
    pub small_step_median_mm: f64,
    /// Root mean square of the change of the command per sample: median.
    pub wear_median: f64,
    /// Large sines in which the error is not larger than that of the practitioner, of all \[%\].
    pub sine_no_worse_pct: f64,
    /// The same of the small sines.
    pub small_sine_no_worse_pct: f64,
}

/// Blows to the end stops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndStopFigures {
    /// Axes that struck an end at more than 50 mm/s \[%\].
    pub struck_pct: f64,
    /// Hardest blow \[mm/s\].
    pub hardest_mm_s: f64,
}

/// The figures of one controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControllerFigures {
    /// Of all axes, commissioning included.
    pub end_stops: EndStopFigures,
    /// Of the axes that it controlled.
    pub motion: MotionFigures,
}

/// All figures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Number of axes.
    pub axes: usize,
    /// Commissioning of the loop.
    pub commissioning: CommissioningFigures,
    /// The loop.
    pub adaptive: ControllerFigures,
    /// The loop with the gains of its commissioning.
    pub fixed: ControllerFigures,
    /// The practitioner on all axes.
    pub practitioner: ControllerFigures,
    /// The practitioner on the axes that the loop controlled.
    pub practitioner_same: ControllerFigures,
}

/// Value below which a part of the values lies; `NaN` of none.
pub fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    sorted
        .get((part * last).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

/// Share in per cent; `NaN` of nothing.
fn share<T>(of: &[T], counts: impl Fn(&T) -> bool) -> f64 {
    100.0 * of.iter().filter(|t| counts(t)).count() as f64 / of.len() as f64
}

/// Whether a refusal names a fault that the axis did not have at the time.
fn is_wrong(reason: Reason, reversed: bool) -> bool {
    match reason {
        Reason::WrongSign => !reversed,
        Reason::Blocked
        | Reason::ValveStuck
        | Reason::SensorStuck
        | Reason::SensorFault
        | Reason::ValveFault => true,
        _ => false,
    }
}

/// Why an axis was not accepted.
pub fn refusal(run: &LoopRun) -> Option<String> {
    if run.commissioned.verified_s.is_some() {
        return None;
    }
    if run.settings.is_some() {
        return Some("Settings".into());
    }
    let last = run.commissioned.refusals.last();
    Some(last.map_or_else(|| "Undecided".into(), |(reason, _)| format!("{reason:?}")))
}

impl CommissioningFigures {
    /// The figures of runs.
    pub fn new(runs: &[&LoopRun]) -> Self {
        let done: Vec<_> = runs.iter().map(|r| &r.commissioned).collect();
        let times: Vec<f64> = done.iter().filter_map(|c| c.verified_s).collect();
        let ratios: Vec<[f64; 2]> = done.iter().filter_map(|c| c.ratios).collect();
        let within_90 = |k: usize| {
            let errors: Vec<f64> = done
                .iter()
                .filter_map(|c| Some(c.valve_errors?[k].abs()))
                .collect();
            quantile(&errors, 0.9)
        };
        let mut refused = BTreeMap::new();
        for reason in runs.iter().filter_map(|run| refusal(run)) {
            *refused.entry(reason).or_insert(0) += 1;
        }
        Self {
            accepted_pct: share(&done, |c| c.verified_s.is_some_and(|t| t <= IN_TIME)),
            accepted_6s_pct: share(&done, |c| c.verified_s.is_some()),
            verified_median_s: quantile(&times, 0.5),
            verified_p95_s: quantile(&times, 0.95),
            refused,
            wrong_reason_pct: share(&done, |c| c.refusals.iter().any(|&(r, w)| is_wrong(r, w))),
            wrong_sign_pct: share(&done, |c| c.wrong_sign),
            w0_within_10pct: share(&ratios, |[_, w0]| (w0 - 1.0).abs() <= 0.1),
            c_within_20pct: share(&ratios, |[c, _]| (c - 1.0).abs() <= 0.2),
            grossly_wrong_pct: share(&ratios, |r| r.iter().any(|x| (x - 1.0).abs() > 0.5)),
            dead_zone_p90: within_90(0),
            offset_p90: within_90(1),
            delay_p90_ms: 1e3 * within_90(2),
            struck_pct: share(runs, |run| run.blow_mm_s > BLOW_MM_S),
        }
    }
}

/// Whether an axis cycles at rest.
pub fn cycles(trial: &Trial, motion: &Motion) -> bool {
    motion
        .rest_range_mm
        .is_some_and(|range| range > trial.axis.cycle_mm())
}

/// Share of sines that are followed no worse than by the practitioner; a sine that was not run is
/// worse.
fn no_worse(pairs: &[(&Trial, &Motion)], sines: impl Fn(&Motion) -> [Option<f64>; 3]) -> f64 {
    let compared: Vec<bool> = pairs
        .iter()
        .flat_map(|(trial, motion)| {
            let other = sines(&trial.practitioner);
            let own = sines(motion);
            own.into_iter().zip(other).map(|(own, other)| {
                let bound = other.unwrap_or(f64::INFINITY);
                own.is_some_and(|error| error <= bound)
            })
        })
        .collect();
    share(&compared, |no_worse| *no_worse)
}

impl MotionFigures {
    fn new(pairs: &[(&Trial, &Motion)]) -> Self {
        let median_of = |of: fn(&Motion) -> Option<f64>, part: f64| {
            let values: Vec<f64> = pairs
                .iter()
                .map(|(_, m)| of(m).unwrap_or(f64::INFINITY))
                .collect();
            quantile(&values, part)
        };
        Self {
            controlled: pairs.len(),
            given_up_pct: share(pairs, |(_, m)| !m.alive),
            limit_cycle_pct: share(pairs, |(t, m)| cycles(t, m)),
            undetected_cycle_pct: share(pairs, |(t, m)| cycles(t, m) && m.alive && !m.rest_noticed),
            steady_state_median_mm: median_of(|m| m.steady_state_mm, 0.5),
            steady_state_p90_mm: median_of(|m| m.steady_state_mm, 0.9),
            small_step_median_mm: median_of(|m| m.excursion_mm, 0.5),
            wear_median: median_of(|m| Some(m.wear), 0.5),
            sine_no_worse_pct: no_worse(pairs, |m| m.large_sines_mm),
            small_sine_no_worse_pct: no_worse(pairs, |m| m.small_sines_mm),
        }
    }
}

impl EndStopFigures {
    fn new(blows: &[f64]) -> Self {
        Self {
            struck_pct: share(blows, |blow| *blow > BLOW_MM_S),
            hardest_mm_s: blows.iter().copied().fold(0.0, f64::max),
        }
    }
}

impl ControllerFigures {
    fn of_loop(trials: &[Trial], of: impl Fn(&Trial) -> &LoopRun) -> Self {
        let blows: Vec<f64> = trials.iter().map(|t| of(t).blow_mm_s).collect();
        let pairs: Vec<_> = trials
            .iter()
            .filter_map(|t| Some((t, of(t).motion.as_ref()?)))
            .collect();
        Self {
            end_stops: EndStopFigures::new(&blows),
            motion: MotionFigures::new(&pairs),
        }
    }

    fn of_practitioner(trials: &[&Trial]) -> Self {
        let blows: Vec<f64> = trials.iter().map(|t| t.practitioner_blow_mm_s).collect();
        let pairs: Vec<_> = trials.iter().map(|t| (*t, &t.practitioner)).collect();
        Self {
            end_stops: EndStopFigures::new(&blows),
            motion: MotionFigures::new(&pairs),
        }
    }
}

impl Summary {
    /// The figures of trials.
    pub fn new(trials: &[Trial]) -> Self {
        let runs: Vec<&LoopRun> = trials.iter().map(|t| &t.adaptive).collect();
        let all: Vec<&Trial> = trials.iter().collect();
        let same: Vec<&Trial> = trials
            .iter()
            .filter(|t| t.adaptive.motion.is_some())
            .collect();
        Self {
            axes: trials.len(),
            commissioning: CommissioningFigures::new(&runs),
            adaptive: ControllerFigures::of_loop(trials, |t| &t.adaptive),
            fixed: ControllerFigures::of_loop(trials, |t| &t.fixed),
            practitioner: ControllerFigures::of_practitioner(&all),
            practitioner_same: ControllerFigures::of_practitioner(&same),
        }
    }
}
