//! The figures of a run, and what is wanted of them.

use trendid::servo::State;

use crate::servo::scenario::Scenario;

/// The figures of one run; `None` where the scenario does not come to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// The scenario.
    pub scenario: Scenario,
    /// The seed.
    pub seed: u64,
    /// Time of excitation until a model was verified \[s\].
    pub verified_at_s: Option<f64>,
    /// Largest true error in the last 0.5 s of 2 s after a step of 60 mm was commanded \[mm\].
    pub steady_state_mm: Option<f64>,
    /// From 10 to 90 % of the step, true position \[ms\].
    pub rise_ms: Option<f64>,
    /// Largest true position beyond the target, in % of the step.
    pub overshoot_pct: Option<f64>,
    /// Largest true error over two periods of a sine of 60 mm at 0.5 Hz, after one period \[mm\].
    pub tracking_0p5hz_mm: Option<f64>,
    /// The same at 1 Hz over three periods \[mm\].
    pub tracking_1hz_mm: Option<f64>,
    /// Time from the change until the true error stays within 1.5 times 0.7 mm on the sine of 0.5
    /// Hz \[s\].
    pub recovered_s: Option<f64>,
    /// Range of the true position over 60 s at rest \[mm\].
    pub rest_range_mm: Option<f64>,
    /// Whether the gains after the rest, or after a refusal, are bit for bit those before.
    pub gains_kept: Option<bool>,
    /// Models that reached the controller.
    pub accepted: u32,
    /// State at the end.
    pub state: State,
}

/// One figure of a run.
type Figure = fn(&Figures) -> Option<f64>;

impl Figures {
    /// A run that has come to nothing yet.
    pub(crate) const fn new(scenario: Scenario, seed: u64) -> Self {
        Self {
            scenario,
            seed,
            verified_at_s: None,
            steady_state_mm: None,
            rise_ms: None,
            overshoot_pct: None,
            tracking_0p5hz_mm: None,
            tracking_1hz_mm: None,
            recovered_s: None,
            rest_range_mm: None,
            gains_kept: None,
            accepted: 0,
            state: State::Idle,
        }
    }

    /// What is wanted of the axis, and by which factor more is granted after a change in motion.
    const WANTED: [(&str, f64, Figure); 5] = [
        ("steady state in mm", 0.05, |f| f.steady_state_mm),
        ("rise in ms", 200.0, |f| f.rise_ms),
        ("overshoot in %", 1.0, |f| f.overshoot_pct),
        ("0.5 Hz in mm", 0.7, |f| f.tracking_0p5hz_mm),
        ("1 Hz in mm", 1.2, |f| f.tracking_1hz_mm),
    ];

    /// The figures that are worse than wanted: name, figure, limit. After a change in motion one
    /// and a half times the limits are granted, and 2 s until the error is as small as that again.
    pub fn outside(&self) -> Vec<(&'static str, f64, f64)> {
        let share = if self.scenario.is_change() { 1.5 } else { 1.0 };
        let mut figures: Vec<_> = Self::WANTED
            .iter()
            .map(|(name, limit, of)| (*name, of(self), share * limit))
            .collect();
        if self.scenario.is_change() {
            figures.push(("recovery in s", self.recovered_s, 2.0));
        }
        figures
            .into_iter()
            .map(|(name, figure, limit)| (name, figure.unwrap_or(f64::INFINITY), limit))
            .filter(|(_, figure, limit)| figure > limit)
            .collect()
    }

    /// Whether a fault was refused with the reason that belongs to it.
    pub fn refused_rightly(&self) -> bool {
        match self.state {
            State::Rejected(reason) | State::Failed(reason) => self
                .scenario
                .expected()
                .is_some_and(|expected| expected.contains(&reason)),
            _ => false,
        }
    }
}
