//! A controller along the frequencies: sensitivity on the drive as identified and on drives that
//! are off, noise, margins.

use crate::math::complex::Complex;
use crate::math::{pow, sqrt};
use crate::servo::control::compensator::{Compensator, Drive, integrated, lag, receptance};
use crate::servo::control::margins::Margins;
use crate::servo::control::poles::Poles;

/// Largest sensitivity of the drive as identified, and of one that is off, squared.
const SENSITIVITY: [f32; 2] = [2.2 * 2.2, 4.0 * 4.0];
/// Factors on a1, and on b0, of the drives that are off, beside one sample of delay more; and on
/// a2.
const OFF: [f32; 2] = [1.15, 0.85];
const OFF_DAMPING: f32 = 0.85;
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
    own: Trace,
    /// By the factors on a1, then on b0.
    corners: [[Trace; 2]; 2],
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
            own: BEGIN,
            corners: [[BEGIN; 2]; 2],
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
        let off = self.corners.as_flattened();
        if off.iter().all(|trace| trace.turns == self.own.turns) {
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
        let Drive { a1, a2, b0, .. } = self.drive;
        let closed = closed(integrated(c, b0, w, held).times(receptance(a1, a2, w)), 1.0);
        if !self.own.sees(closed, SENSITIVITY[0]) {
            return false;
        }
        let width = w * (self.ratio - 1.0) * self.step;
        self.variance += c.size() / closed.size() * width * core::f32::consts::FRAC_1_PI;
        self.margins.note(&self.own.last, &closed, w);
        self.own.last = closed;
        self.corners_hold(integrated(c, b0, w, later))
    }

    /// The same on the drives that are off.
    fn corners_hold(&mut self, flow: Complex) -> bool {
        let Drive { a1, a2, .. } = self.drive;
        for (traces, off) in self.corners.iter_mut().zip(OFF) {
            let open = flow.times(receptance(off * a1, OFF_DAMPING * a2, self.w));
            for (trace, gain) in traces.iter_mut().zip(OFF) {
                let closed = closed(open, gain);
                if !trace.sees(closed, SENSITIVITY[1]) {
                    return false;
                }
                trace.last = closed;
            }
        }
        true
    }
}

/// `1 + L` under a factor on L.
fn closed(open: Complex, gain: f32) -> Complex {
    Complex {
        re: 1.0 + gain * open.re,
        im: gain * open.im,
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
