//! The bandwidth as a result: the fastest poles whose margins hold.

use crate::math::complex::Complex;
use crate::math::{pow, sqrt};
use crate::servo::control::margins::{Compensator, Drive, lag, response};
use crate::servo::control::place::Place;
use crate::servo::control::poles::Poles;
use crate::servo::design::TuningDesign;
use crate::servo::model::Model;

/// Largest sensitivity of the drive as identified, and of one that is off, squared.
const SENSITIVITY: [f32; 2] = [2.2 * 2.2, 4.0 * 4.0];
/// Errors of a1 and b0 over their values, beside one sample of delay more; a2 is too small by as much.
const CORNERS: [[f32; 2]; 4] = [[0.15, 0.15], [-0.15, 0.15], [0.15, -0.15], [-0.15, -0.15]];
/// Largest standard deviation of the flow that noise and resolution make.
const COMMAND_NOISE: f32 = 0.03;
/// Place near an end, over the travel, where the margins must hold too.
const NEAR_END: f32 = 0.1;
/// Largest bandwidth over w0, and times the sample time; steps of the search, and the least bandwidth over w0.
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
/// Disturbance over bandwidth: faster, its phase meets that of large flows, where a valve gives less than its gain.
const DISTURBANCE: f32 = 0.3;
/// Frequencies from this share of w0 to that of the sampling.
const FREQUENCIES: usize = 40;
const LOWEST: f32 = 0.03;

/// How far a loop is from its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Margins {
    /// Largest sensitivity, `max 1/|1 + L|`.
    pub sensitivity: f32,
    /// Phase margin in rad, and the delay margin in s: the least of all crossings of |L| = 1.
    pub phase: f32,
    /// The delay that may come on top.
    pub delay: f32,
    /// Factor of the gain up to which the loop is stable.
    pub gain: f32,
}

impl Margins {
    const NONE: Self = Self {
        sensitivity: 0.0,
        phase: core::f32::consts::PI,
        delay: f32::INFINITY,
        gain: f32::INFINITY,
    };
}

/// What a drive shows along the frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Trace {
    last: Complex,
    /// Turns of 1 + L about zero, in half crossings.
    turns: i32,
}

/// The search; [`Tuning::step`] is one frequency.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tuning {
    design: TuningDesign,
    /// Natural frequency, and the drive in its own time.
    frequency: f32,
    drive: Drive,
    step: f32,
    noise: f32,
    ratio: f32,
    case: usize,
    bandwidth: f32,
    near_end: bool,
    compensator: Compensator,
    at: usize,
    w: f32,
    traces: [Trace; 5],
    variance: f32,
    margins: Margins,
    middle: Margins,
    integral: f32,
    best: Option<(Poles, Margins, f32)>,
}

impl Tuning {
    pub(crate) fn new(design: &TuningDesign, model: &Model) -> Self {
        let w0 = sqrt(model.a1);
        let step = w0 * design.sample_time;
        let drive = Drive {
            a1: 1.0,
            a2: model.a2 / w0,
            b0: 1.0,
            delay: w0 * design.delay,
        };
        let poles = slowest(w0, step);
        let highest = core::f32::consts::PI / step;
        let mut tuning = Self {
            design: *design,
            frequency: w0,
            drive,
            step,
            noise: design.noise * w0 * model.a1 / model.b0,
            ratio: pow(highest / LOWEST, 1.0 / (FREQUENCIES - 1) as f32),
            case: 0,
            bandwidth: 0.0,
            near_end: false,
            compensator: Compensator::new(drive, normalised(&poles, w0), 1.0),
            at: 0,
            w: LOWEST,
            traces: [Trace {
                last: Complex::ONE,
                turns: 0,
            }; 5],
            variance: 0.0,
            margins: Margins::NONE,
            middle: Margins::NONE,
            integral: 0.0,
            best: None,
        };
        tuning.open(0);
        tuning
    }

    /// The result: the poles with the largest integral gain whose margins hold, or the slowest ones.
    pub(crate) fn poles(&self) -> (Poles, Option<Margins>) {
        match self.best {
            Some((poles, margins, _)) => (poles, Some(margins)),
            None => (slowest(self.frequency, self.step), None),
        }
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
        self.begin();
    }

    fn tried(&self) -> Poles {
        let case = self.case;
        let damping = DAMPINGS[case % 2];
        let observer = OBSERVERS[(case / 2) % 4];
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

    /// Begins a bandwidth in the middle.
    fn begin(&mut self) {
        self.near_end = false;
        self.variance = 0.0;
        self.enter();
        self.integral = LOWEST
            * sqrt(
                self.compensator
                    .at(LOWEST, lag(LOWEST * self.drive.delay))
                    .size(),
            );
    }

    /// Begins at a place.
    fn enter(&mut self) {
        let stiffness = self.stiffness();
        let drive = Drive {
            a1: stiffness,
            b0: stiffness,
            ..self.drive
        };
        self.compensator = Compensator::new(drive, self.tried(), sqrt(stiffness));
        self.at = 0;
        self.w = LOWEST;
        self.traces = [Trace {
            last: Complex::ONE,
            turns: 0,
        }; 5];
        self.margins = Margins::NONE;
    }

    fn stiffness(&self) -> f32 {
        if self.near_end {
            Place::at_share(self.design.dead_volume, NEAR_END)
        } else {
            1.0
        }
    }

    /// A frequency; whether the search is over. Cost: some 900 instructions.
    pub(crate) fn step(&mut self) -> bool {
        if self.case >= CASES {
            return true;
        }
        let better = self.best.is_none_or(|(_, _, other)| self.integral > other);
        if !better || self.bandwidth < BANDWIDTH_MIN {
            return self.next_case();
        }
        if !self.holds() {
            self.bandwidth *= BANDWIDTH_RATIO;
            self.begin();
            return false;
        }
        self.at += 1;
        self.w *= self.ratio;
        if self.at < FREQUENCIES {
            return false;
        }
        let same = self.traces.iter().all(|t| t.turns == self.traces[0].turns);
        let quiet = self.noise * self.noise * self.variance < COMMAND_NOISE * COMMAND_NOISE;
        if !(same && quiet) {
            self.bandwidth *= BANDWIDTH_RATIO;
            self.begin();
        } else if self.near_end {
            let poles = scaled(&self.tried(), self.frequency);
            let mut margins = self.middle;
            margins.delay /= self.frequency;
            self.best = Some((poles, margins, self.integral));
            return self.next_case();
        } else {
            self.middle = self.margins;
            self.near_end = true;
            self.enter();
        }
        false
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

    /// Whether the margins hold at the present frequency.
    fn holds(&mut self) -> bool {
        let w = self.w;
        let late = lag(w * self.drive.delay);
        let c = self.compensator.at(w, late);
        // Half a sample by the hold; in the corners one sample more.
        let half = lag(0.5 * w * self.step);
        let held = late.times(half);
        let later = held.times(half).times(half);
        let stiffness = self.stiffness();
        for j in 0..self.traces.len() {
            let [e1, e0] = if j == 0 {
                [0.0; 2]
            } else {
                CORNERS[(j - 1) % 4]
            };
            let off = j > 0;
            let drive = Drive {
                a1: stiffness * (1.0 + e1),
                a2: self.drive.a2 * if off { 0.85 } else { 1.0 },
                b0: stiffness * (1.0 + e0),
                delay: self.drive.delay,
            };
            let open = c.times(response(&drive, w, if off { later } else { held }));
            let closed = Complex {
                re: 1.0 + open.re,
                im: open.im,
            };
            let size = closed.size();
            // Written so that NaN does not hold.
            if !(size * SENSITIVITY[usize::from(off)] > 1.0) {
                return false;
            }
            let trace = &mut self.traces[j];
            let crosses = trace.last.im * closed.im < 0.0;
            if crosses && trace.last.re + closed.re < 0.0 {
                trace.turns += if closed.im > 0.0 { 1 } else { -1 };
            }
            if j == 0 {
                self.variance += c.size() / size
                    * w
                    * (self.ratio - 1.0)
                    * self.step
                    * core::f32::consts::FRAC_1_PI;
                note(&mut self.margins, &trace.last, &closed, w);
            }
            trace.last = closed;
        }
        true
    }
}

/// Notes what two neighbouring values of 1 + L show of the margins.
fn note(margins: &mut Margins, last: &Complex, closed: &Complex, w: f32) {
    let inverse = 1.0 / sqrt(closed.size());
    if inverse > margins.sensitivity {
        margins.sensitivity = inverse;
    }
    let open = |c: &Complex| (c.re - 1.0) * (c.re - 1.0) + c.im * c.im;
    if (open(last) - 1.0) * (open(closed) - 1.0) < 0.0 {
        // The chord from L to -1 of a unit circle.
        let chord = sqrt(closed.size());
        let angle = chord * (1.0 + chord * chord * (1.0 / 24.0));
        if angle < margins.phase {
            margins.phase = angle;
        }
        if angle / w < margins.delay {
            margins.delay = angle / w;
        }
    }
    let real = closed.re - 1.0;
    if last.im * closed.im < 0.0 && real < 0.0 && real > -1.0 {
        let gain = -1.0 / real;
        if gain < margins.gain {
            margins.gain = gain;
        }
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

fn normalised(poles: &Poles, frequency: f32) -> Poles {
    scaled(poles, 1.0 / frequency)
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
