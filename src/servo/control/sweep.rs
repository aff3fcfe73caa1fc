//! A controller along the frequencies: sensitivity on the drive as identified and on drives that
//! are off, noise, margins.

use crate::math::complex::Complex;
use crate::math::{pow, sqrt};
use crate::servo::control::compensator::{
    Compensator, Responses, ScaledDrive, integrated, lag, receptance,
};
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

/// A controller at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Reached {
    /// Square of its magnitude.
    size: f32,
    /// The open loop but for 1/D: with the delay of the drive and half a sample of the hold, and
    /// with one sample more.
    open: [Complex; 2],
}

/// What a step of a sweep shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Swept {
    /// The gain of the integral action, `lim |jw C|`.
    Begun(f32),
    /// The margins hold so far.
    On,
    /// They do not hold.
    Fails,
    /// They hold at all frequencies.
    Holds,
}

/// A controller on a drive and its corners, a frequency in two calls; in units of the drive's own
/// time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrequencySweep {
    drive: ScaledDrive,
    compensator: Compensator,
    /// Sample time, and ratio of two frequencies.
    step: f32,
    ratio: f32,
    at: usize,
    w: f32,
    /// The controller at this frequency, between its two calls.
    reached: Option<Reached>,
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
    /// The controller of these poles on its own drive. Cost: the gains, some 150 instructions.
    pub(crate) fn new(
        drive: ScaledDrive,
        responses: &Responses,
        poles: Poles,
        [step, ratio]: [f32; 2],
    ) -> Self {
        Self {
            drive,
            compensator: Compensator::new(drive, responses, poles, sqrt(drive.a1)),
            step,
            ratio,
            at: 0,
            w: LOWEST,
            reached: None,
            own: BEGIN,
            corners: [[BEGIN; 2]; 2],
            variance: 0.0,
            margins: Margins::NONE,
        }
    }

    /// Variance of the flow over that of the position.
    pub(crate) const fn variance(&self) -> f32 {
        self.variance
    }

    pub(crate) const fn margins(&self) -> Margins {
        self.margins
    }

    /// The controller at a frequency, then the margins there. Cost: some 300 instructions.
    pub(crate) fn update(&mut self) -> Swept {
        let Some(reached) = self.reached.take() else {
            return self.reach();
        };
        if !(self.own_holds(&reached) && self.corners_hold(reached.open[1])) {
            return Swept::Fails;
        }
        self.at += 1;
        self.w *= self.ratio;
        let off = self.corners.as_flattened();
        if self.at < FREQUENCIES {
            Swept::On
        } else if off.iter().all(|trace| trace.turns == self.own.turns) {
            Swept::Holds
        } else {
            Swept::Fails
        }
    }

    /// The controller at the present frequency.
    fn reach(&mut self) -> Swept {
        let w = self.w;
        let ScaledDrive { b0, delay, .. } = self.drive;
        let late = lag(w * delay);
        let c = self.compensator.at(w, late);
        // Half a sample by the hold; in the corners one sample more.
        let half = lag(0.5 * w * self.step);
        let held = late.times(half);
        let later = held.times(half).times(half);
        let size = c.size();
        self.reached = Some(Reached {
            size,
            open: [held, later].map(|late| integrated(c, b0, w, late)),
        });
        if self.at == 0 {
            Swept::Begun(w * sqrt(size))
        } else {
            Swept::On
        }
    }

    /// Whether the margins hold on the drive itself.
    fn own_holds(&mut self, reached: &Reached) -> bool {
        let ScaledDrive { a1, a2, .. } = self.drive;
        let w = self.w;
        let closed = closed(reached.open[0].times(receptance(a1, a2, w)), 1.0);
        let holds = self.own.sees(closed, SENSITIVITY[0]);
        if holds {
            let width = w * (self.ratio - 1.0) * self.step;
            let share = width * core::f32::consts::FRAC_1_PI;
            self.variance += reached.size / closed.size() * share;
            self.margins.note(&self.own.last, &closed, w);
            self.own.last = closed;
        }
        holds
    }

    /// Whether they hold on the drives that are off.
    fn corners_hold(&mut self, flow: Complex) -> bool {
        let ScaledDrive { a1, a2, .. } = self.drive;
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
