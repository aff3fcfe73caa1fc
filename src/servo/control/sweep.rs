//! A controller along the frequencies: sensitivity on the drive as identified and on drives that
//! are off, noise, margins.

use crate::math::complex::Complex;
use crate::math::{pow, sqrt};
use crate::servo::control::compensator::{Compensator, Drive, lag, response};
use crate::servo::control::margins::Margins;
use crate::servo::control::poles::Poles;

/// Largest sensitivity of the drive as identified, and of one that is off, squared.
const SENSITIVITY: [f32; 2] = [2.2 * 2.2, 4.0 * 4.0];
/// Errors of a1 and b0 over their values, beside one sample of delay more; a2 is too small by as
/// much.
const CORNERS: [[f32; 2]; 4] = [[0.15, 0.15], [-0.15, 0.15], [0.15, -0.15], [-0.15, -0.15]];
/// Frequencies from this share of w0 to that of the sampling.
const FREQUENCIES: usize = 40;
const LOWEST: f32 = 0.03;

/// What a drive shows along the frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Trace {
    last: Complex,
    /// Turns of 1 + L about zero, in half crossings.
    turns: i32,
}

const BEGIN: Trace = Trace {
    last: Complex::ONE,
    turns: 0,
};

/// What a frequency shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Swept {
    /// The margins hold so far.
    On,
    /// They do not hold.
    Fails,
    /// They hold at all frequencies.
    Holds,
}

/// A controller on a drive and its corners, one frequency per call; in units of the drive's own
/// time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrequencySweep {
    drive: Drive,
    compensator: Compensator,
    /// Sample time, and ratio of two frequencies.
    step: f32,
    ratio: f32,
    at: usize,
    w: f32,
    traces: [Trace; 5],
    variance: f32,
    margins: Margins,
}

/// Ratio of two frequencies up to that of the sampling. Cost: one power.
pub(crate) fn ratio(step: f32) -> f32 {
    let highest = core::f32::consts::PI / step;
    pow(highest / LOWEST, 1.0 / (FREQUENCIES - 1) as f32)
}

impl FrequencySweep {
    /// The controller of these poles on its own drive. Cost: the gains behind the prediction, some
    /// 1500 instructions.
    pub(crate) fn new(drive: Drive, poles: Poles, [step, ratio]: [f32; 2]) -> Self {
        Self {
            drive,
            compensator: Compensator::new(drive, poles, sqrt(drive.a1)),
            step,
            ratio,
            at: 0,
            w: LOWEST,
            traces: [BEGIN; 5],
            variance: 0.0,
            margins: Margins::NONE,
        }
    }

    /// Gain of the integral action, `lim |jw C|`.
    pub(crate) fn integral(&self) -> f32 {
        let late = lag(LOWEST * self.drive.delay);
        LOWEST * sqrt(self.compensator.at(LOWEST, late).size())
    }

    /// Variance of the flow over that of the position.
    pub(crate) const fn variance(&self) -> f32 {
        self.variance
    }

    pub(crate) const fn margins(&self) -> Margins {
        self.margins
    }

    /// One frequency. Cost: some 900 instructions.
    pub(crate) fn update(&mut self) -> Swept {
        if !self.holds() {
            return Swept::Fails;
        }
        self.at += 1;
        self.w *= self.ratio;
        if self.at < FREQUENCIES {
            return Swept::On;
        }
        let [own, off @ ..] = &self.traces;
        if off.iter().all(|trace| trace.turns == own.turns) {
            Swept::Holds
        } else {
            Swept::Fails
        }
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
        let [own, corners @ ..] = &mut self.traces;
        let closed = closed_of(&c, &self.drive, w, held);
        if !own.sees(closed, SENSITIVITY[0]) {
            return false;
        }
        let width = w * (self.ratio - 1.0) * self.step;
        self.variance += c.size() / closed.size() * width * core::f32::consts::FRAC_1_PI;
        self.margins.note(&own.last, &closed, w);
        own.last = closed;
        for (trace, [e1, e0]) in corners.iter_mut().zip(CORNERS) {
            let drive = Drive {
                a1: self.drive.a1 * (1.0 + e1),
                a2: self.drive.a2 * 0.85,
                b0: self.drive.b0 * (1.0 + e0),
                delay: self.drive.delay,
            };
            let closed = closed_of(&c, &drive, w, later);
            if !trace.sees(closed, SENSITIVITY[1]) {
                return false;
            }
            trace.last = closed;
        }
        true
    }
}

/// `1 + L` of a controller on a drive with this delay.
fn closed_of(c: &Complex, drive: &Drive, w: f32, late: Complex) -> Complex {
    let open = c.times(response(drive, w, late));
    Complex {
        re: 1.0 + open.re,
        im: open.im,
    }
}

impl Trace {
    /// Counts the turn of a further value of 1 + L; whether its sensitivity is small enough.
    /// Written so that NaN does not hold.
    fn sees(&mut self, closed: Complex, sensitivity: f32) -> bool {
        if !(closed.size() * sensitivity > 1.0) {
            return false;
        }
        let crosses = self.last.im * closed.im < 0.0;
        if crosses && self.last.re + closed.re < 0.0 {
            self.turns += if closed.im > 0.0 { 1 } else { -1 };
        }
        true
    }
}

#[cfg(test)]
mod tests;
