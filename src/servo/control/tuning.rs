//! The bandwidth as a result: the fastest poles whose margins hold.

use crate::math::sqrt;
use crate::servo::control::compensator::{Responses, ScaledDrive};
use crate::servo::control::margins::Margins;
use crate::servo::control::place::{stiffening, stiffness};
use crate::servo::control::poles::Poles;
use crate::servo::control::sweep::{FrequencySweep, Swept, ratio};
use crate::servo::design::TuningDesign;
use crate::servo::model::Model;

/// Largest standard deviation of the flow that noise and resolution make.
const COMMAND_NOISE: f32 = 0.03;
/// Place near an end, over the travel, where the margins must hold too.
const NEAR_END: f32 = 0.1;
/// Largest bandwidth over w0, and times the sample time; steps of the search, and the least
/// bandwidth over w0.
const BANDWIDTH_MAX: f32 = 3.0;
const BANDWIDTH_STEP: f32 = 0.15;
const BANDWIDTH_RATIO: f32 = 0.85;
const BANDWIDTH_MIN: f32 = 0.15;
/// Largest observer pole times the sample time: its correction is a rectangle.
pub(crate) const OBSERVER_STEP: f32 = 0.3;
/// Observer over pair and damping of the pair: what is tried.
const OBSERVERS: [f32; 4] = [6.0, 4.0, 2.5, 1.6];
const DAMPINGS: [f32; 2] = [0.8, 1.6];
const CASES: usize = OBSERVERS.len() * DAMPINGS.len();
/// Disturbance over bandwidth: faster, its phase meets that of large flows, where a valve gives
/// less than its gain.
const DISTURBANCE: f32 = 0.3;

/// The search, in pieces of at most some 300 instructions: see [`Tuning::step`].
///
/// Eight cases, each from its largest bandwidth down by 0.85 to the first whose margins hold, in
/// the middle and near an end. A case that cannot have more integral gain than the best one is left
/// at its first frequency.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tuning {
    design: TuningDesign,
    /// Natural frequency.
    frequency: f32,
    /// The drive in its own time, in the middle of the travel.
    drive: ScaledDrive,
    /// The drives there and near an end, with what they do over the delay; `None` before each is
    /// tried for the first time.
    places: [Option<(ScaledDrive, Responses)>; 2],
    step: f32,
    /// Ratio of two frequencies of a sweep; 0 before the first piece.
    ratio: f32,
    noise: f32,
    case: usize,
    bandwidth: f32,
    /// The controller that is tried; `None` before its gains are known.
    sweep: Option<FrequencySweep>,
    near_end: bool,
    /// Margins and variance of the flow in the middle, while the place near an end is tried.
    middle: Margins,
    variance: f32,
    integral: f32,
    best: Option<(Poles, Margins, f32)>,
}

impl Tuning {
    /// A search for the poles of a model.
    #[inline]
    pub(crate) fn new(design: &TuningDesign, model: &Model) -> Self {
        let w0 = sqrt(model.a1);
        let step = w0 * design.sample_time;
        let mut tuning = Self {
            design: *design,
            frequency: w0,
            drive: ScaledDrive {
                a1: 1.0,
                a2: model.a2 / w0,
                b0: 1.0,
                delay: w0 * design.delay,
            },
            step,
            places: [None; 2],
            ratio: 0.0,
            noise: design.noise * w0 * model.a1 / model.b0,
            case: 0,
            bandwidth: 0.0,
            sweep: None,
            near_end: false,
            middle: Margins::NONE,
            variance: 0.0,
            integral: 0.0,
            best: None,
        };
        tuning.open(0);
        tuning
    }

    /// The result: the poles with the largest integral gain whose margins hold, or the slowest
    /// ones.
    pub(crate) fn poles(&self) -> (Poles, Option<Margins>) {
        match self.best {
            Some((poles, margins, _)) => (poles, Some(margins)),
            None => (slowest(self.frequency, self.step), None),
        }
    }

    /// The poles of a loop that does little, for a model whose search has not begun.
    pub(crate) fn slowest(design: &TuningDesign, model: &Model) -> Poles {
        let w0 = sqrt(model.a1);
        slowest(w0, w0 * design.sample_time)
    }

    /// Whether some poles hold already; the others are only faster.
    pub(crate) const fn has_some(&self) -> bool {
        self.best.is_some()
    }

    /// Begins a case at its largest bandwidth.
    fn open(&mut self, case: usize) {
        self.case = case;
        let most = self.design.bandwidth_max / self.frequency;
        let mut bandwidth = BANDWIDTH_MAX;
        for limit in [most, BANDWIDTH_STEP / self.step] {
            if limit < bandwidth {
                bandwidth = limit;
            }
        }
        self.bandwidth = bandwidth;
        self.near_end = false;
        self.sweep = None;
    }

    fn tried(&self) -> Poles {
        let damping = DAMPINGS[self.case % 2];
        let observer = OBSERVERS[(self.case / 2) % 4];
        let c = self.bandwidth;
        let pair = if c > 1.0 { c } else { 1.0 };
        let most = OBSERVER_STEP / self.step;
        let fast = observer * pair;
        Poles {
            bandwidth: c,
            damping,
            observer: if fast < most { fast } else { most },
            disturbance: DISTURBANCE * c,
        }
    }

    /// Whether the next piece begins something, which costs more than half of a frequency.
    pub(crate) const fn begins(&self) -> bool {
        self.sweep.is_none()
    }

    /// A piece of the search: its frequencies, one of its drives, the gains of a controller, or
    /// half of a frequency of it; whether the search is over.
    pub(crate) fn step(&mut self) -> bool {
        if self.case >= CASES {
            return true;
        }
        if self.ratio == 0.0 {
            self.ratio = ratio(self.step);
            return false;
        }
        let Some(sweep) = &mut self.sweep else {
            let place = usize::from(self.near_end);
            let Some((drive, responses)) = &self.places[place] else {
                self.places[place] = Some(self.drive());
                return false;
            };
            if self.bandwidth < BANDWIDTH_MIN {
                return self.next_case();
            }
            let frequencies = [self.step, self.ratio];
            let poles = self.tried();
            self.sweep = Some(FrequencySweep::new(*drive, responses, poles, frequencies));
            return false;
        };
        match sweep.update() {
            Swept::Begun(integral) if !self.near_end => {
                self.integral = integral;
                if self.best.is_some_and(|(_, _, best)| !(integral > best)) {
                    // No bandwidth of this case is better; the next piece opens another.
                    self.bandwidth = 0.0;
                    self.sweep = None;
                }
            }
            Swept::Begun(_) | Swept::On => {}
            Swept::Holds if self.is_quiet() => return self.passed(),
            Swept::Holds | Swept::Fails => {
                self.bandwidth *= BANDWIDTH_RATIO;
                self.near_end = false;
                self.sweep = None;
            }
        }
        false
    }

    /// The drive in the middle or near an end.
    fn drive(&self) -> (ScaledDrive, Responses) {
        let stiffness = if self.near_end {
            stiffness(stiffening(self.design.dead_volume), NEAR_END)
        } else {
            1.0
        };
        let drive = ScaledDrive {
            a1: stiffness,
            b0: stiffness,
            ..self.drive
        };
        (drive, Responses::new(&drive))
    }

    /// Variance of the flow in the middle, and of both places together near an end.
    fn variance(&self) -> f32 {
        let own = self.sweep.as_ref().map_or(0.0, FrequencySweep::variance);
        if self.near_end {
            self.variance + own
        } else {
            own
        }
    }

    /// Whether the flow that noise and resolution make is small enough.
    fn is_quiet(&self) -> bool {
        self.noise * self.noise * self.variance() < COMMAND_NOISE * COMMAND_NOISE
    }

    /// The margins hold at a place.
    fn passed(&mut self) -> bool {
        let variance = self.variance();
        let margins = self.sweep.take().map_or(Margins::NONE, |s| s.margins());
        if !self.near_end {
            self.middle = margins;
            self.variance = variance;
            self.near_end = true;
            return false;
        }
        let poles = scaled(&self.tried(), self.frequency);
        let mut margins = self.middle;
        margins.delay /= self.frequency;
        self.best = Some((poles, margins, self.integral));
        self.next_case()
    }

    fn next_case(&mut self) -> bool {
        let next = self.case + 1;
        if next < CASES {
            self.open(next);
        } else {
            self.case = CASES;
        }
        next >= CASES
    }
}

fn scaled(poles: &Poles, frequency: f32) -> Poles {
    Poles {
        bandwidth: frequency * poles.bandwidth,
        observer: frequency * poles.observer,
        disturbance: frequency * poles.disturbance,
        ..*poles
    }
}

/// The poles of a loop that does little: where no margins hold.
fn slowest(frequency: f32, step: f32) -> Poles {
    let most = OBSERVER_STEP / step;
    let observer = if most < 2.0 { most } else { 2.0 };
    scaled(
        &Poles {
            bandwidth: BANDWIDTH_MIN,
            damping: 1.6,
            observer,
            disturbance: 0.1 * BANDWIDTH_MIN,
        },
        frequency,
    )
}

/// The poles for a model, a few frequencies per sample.
#[derive(Debug, Clone)]
pub(crate) struct Tuned {
    pub(crate) model: Model,
    pub(crate) tuning: Tuning,
    pub(crate) done: bool,
}

impl Tuned {
    /// A search that begins; inline, where it stays, without a copy.
    #[inline]
    pub(crate) fn new(design: &TuningDesign, model: Model) -> Self {
        Self {
            model,
            tuning: Tuning::new(design, &model),
            done: false,
        }
    }
}
