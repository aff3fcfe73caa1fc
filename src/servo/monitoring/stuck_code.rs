//! A code that stays while the axis moves.

use crate::servo::design::MonitoringDesign;
use crate::servo::design::constants::{CODE_CHANGING_NOISE, STUCK_RUN_RATIO};
use crate::servo::monitoring::bounds::Bounds;

/// Samples and expected motion since the code last changed.
///
/// Noise that spans more than a code changes it within a few samples, moving or not: the longest
/// run of equal codes in good work is the measure. Beyond eight times that run the code counts
/// as stuck as soon as the model expects motion of ten codes and sixteen sigma in the run, however
/// slowly. Where the noise is below 0.75 codes, runs at rest may be long; there the expected motion
/// must exceed what can hold the axis back: friction, a stop that is harder than expected (1/w of
/// the speed at its begin) or the swing after it, which friction ended, and for all of the run a
/// flow as wrong as dead zone and offset may be. Cost: about 20 instructions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StuckCode {
    /// Expected motion of many codes.
    many: f32,
    sample_time: f32,
    least_run: u32,
    /// Whether the noise spans more than a code.
    spans: bool,
    /// Samples since the code changed, and the longest run of good work.
    run: u32,
    longest: u32,
    /// Expected motion since the code changed.
    motion: f32,
    /// Expected speed when the code changed last.
    speed: f32,
    /// How often the code changed in good work.
    changes: u32,
}

/// Changes of the code after which its runs are known.
const KNOWN_CHANGES: u32 = 200;

impl StuckCode {
    pub(crate) const fn new(design: &MonitoringDesign) -> Self {
        Self {
            many: design.many_codes,
            sample_time: design.sample_time,
            least_run: design.least_run,
            spans: design.noise >= CODE_CHANGING_NOISE * design.resolution,
            run: 0,
            longest: 0,
            motion: 0.0,
            speed: 0.0,
            changes: 0,
        }
    }

    /// Begins again: what comes next is good work of another model.
    pub(crate) const fn restart(&mut self) {
        self.run = 0;
        self.motion = 0.0;
    }

    /// One sample with the expected velocity, and the displacement by which a swing may set it
    /// apart; whether the code is stuck.
    #[inline]
    pub(crate) fn update(
        &mut self,
        same: bool,
        velocity: f32,
        swing: f32,
        bounds: &Bounds,
    ) -> bool {
        if !same {
            self.changes = self.changes.saturating_add(1);
            if self.run > self.longest {
                self.longest = self.run;
            }
            self.run = 0;
            self.motion = 0.0;
            self.speed = velocity.abs();
            return false;
        }
        self.run = self.run.saturating_add(1);
        self.motion += self.sample_time * velocity;
        let motion = self.motion.abs();
        let rare = STUCK_RUN_RATIO.saturating_mul(self.longest);
        let known = self.spans && self.changes > KNOWN_CHANGES;
        let long = known && self.run > self.least_run && self.run > rare;
        let drift = self.sample_time * self.run as f32 * bounds.drift;
        let stops = self.speed * bounds.stuck.stopping;
        let held = bounds.stuck.held + drift + if swing > stops { swing } else { stops };
        (long && motion > self.many) || motion > self.many + held
    }

    /// Samples since the code changed.
    pub(crate) const fn run(&self) -> u32 {
        self.run
    }
}
