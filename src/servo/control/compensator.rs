//! The loop in the frequency domain: controller with observer and prediction over the delay, on any
//! drive beside its own.

use crate::math::complex::Complex;
use crate::servo::control::poles::Poles;

/// A drive `b0 e^(-s T) / (s (s^2 + a2 s + a1))`; in units of its own time 1/w0, a1 and b0 are 1 in
/// the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScaledDrive {
    pub(crate) a1: f32,
    pub(crate) a2: f32,
    pub(crate) b0: f32,
    pub(crate) delay: f32,
}

/// The controller of a drive: feedback over b0, observer, transition over the delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compensator {
    drive: ScaledDrive,
    poles: Poles,
    /// Gains of x, v, p and the disturbance, over b0.
    k: [f32; 4],
    /// The same behind the prediction: k times the transition matrix.
    predicted: [f32; 4],
    l: [f32; 4],
    /// Where a unit of flow leads over the delay: the transition matrix times (0, 0, b0).
    arrived: [f32; 3],
}

const fn of(re: f32, im: f32) -> Complex {
    Complex { re, im }
}

/// `j x a`.
fn turned(a: Complex, x: f32) -> Complex {
    of(-x * a.im, x * a.re)
}

/// `e^(-j angle)`, to some 1e-6: quarter turns taken off, then the series of sine and cosine to the
/// 7th power.
pub(crate) fn lag(angle: f32) -> Complex {
    let quarters = (angle * core::f32::consts::FRAC_2_PI + 0.5) as u32;
    let x = angle - quarters as f32 * core::f32::consts::FRAC_PI_2;
    let s = x * x;
    let sin = x * (1.0 - s * (1.0 / 6.0) * (1.0 - s * (1.0 / 20.0) * (1.0 - s * (1.0 / 42.0))));
    let cos = 1.0 - 0.5 * s * (1.0 - s * (1.0 / 12.0) * (1.0 - s * (1.0 / 30.0)));
    let (re, im) = match quarters % 4 {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    };
    Complex { re, im: -im }
}

impl Compensator {
    /// The controller with these poles for a drive of this natural frequency. `drive.delay` is
    /// predicted, with the responses of the drive.
    pub(crate) fn new(
        drive: ScaledDrive,
        responses: &Responses,
        poles: Poles,
        frequency: f32,
    ) -> Self {
        let [k0, k1, k2] = poles.feedback(drive.a1, drive.a2, frequency).k;
        let k = [k0, k1, k2, 1.0].map(|k| k / drive.b0);
        Self {
            drive,
            poles,
            k,
            predicted: responses.behind(&drive, k),
            l: poles.correction(drive.a1, drive.a2),
            arrived: responses.arrived(&drive),
        }
    }

    /// From the measured position to the flow, at `w`: `f = -C y`; `late` is `e^(-j w T)` of the
    /// delay. With s = j w, the characteristic polynomial O of the observer, D = s^2 + a2 s + a1:
    ///
    /// ```text
    /// G = k Phi (s - A + L c)^-1 O,    without the part of r that stays in v, p and d
    /// C = k Phi (s - A + L c)^-1 L / (1 + k Phi (s - A + L c)^-1 B e^(-s T) + k (s - A)^-1 (B - Phi B e^(-s T)))
    /// ```
    pub(crate) fn at(&self, w: f32, late: Complex) -> Complex {
        let ScaledDrive { a1, a2, b0, .. } = self.drive;
        let [k0, k1, k2, _] = self.k;
        let [l1, l2, l3, l4] = self.l;
        let [g0, g1, g2, g3] = self.predicted;
        let [bx, bv, bp] = self.arrived;
        let (square, over) = (w * w, 1.0 / w);
        let speed = of(g1 + g2 * a2, g2 * w);
        let late_of_d = g3 * l4 * over;
        let g = speed.times(of(l1, w)).plus(of(g0 + g2 * l2, late_of_d));
        let seen = g.times(self.observer(w));
        // The innovation.
        let numerator = of(
            l4 - square * (a2 * l1 + l2),
            w * (a1 * l1 + l3 - square * l1),
        );
        let kept = of(l1 * speed.re + g2 * l2, l1 * speed.im + late_of_d);
        let through = seen.times(numerator).minus(kept);
        // Unit flow into the observer, delayed; and what the flows on their way will do:
        // (s - A)^-1 B is v = b0/D, p = (s + a2) v, x = v/s, and (s - A)^-1 Phi B is like it.
        let forced = receptance(a1, a2, w).times(of(k1 + k2 * a2, k2 * w - k0 * over));
        let then = forced
            .times(of(bp, bv * w))
            .minus(of(k2 * bv, k0 * bx * over));
        let direct = turned(seen, w * b0);
        let passed = of(1.0 + b0 * forced.re, b0 * forced.im);
        let denominator = passed.plus(direct.minus(then).times(late));
        through.times(denominator.inverse())
    }

    /// 1 over the polynomial of the observer.
    fn observer(&self, w: f32) -> Complex {
        let o = of(self.poles.observer, w);
        let d = of(self.poles.disturbance, w);
        o.times(o).times(o.times(d)).inverse()
    }
}

/// The flow of a controller on a drive at `w` but for 1/D: `b0 e^(-s T) C / s`; `late` is
/// `e^(-s T)`.
pub(crate) fn integrated(c: Complex, b0: f32, w: f32, late: Complex) -> Complex {
    turned(c.times(late), -b0 / w)
}

/// `1/D = 1 / (s^2 + a2 s + a1)` at `w`.
pub(crate) fn receptance(a1: f32, a2: f32, w: f32) -> Complex {
    of(a1 - w * w, a2 * w).inverse()
}

/// The responses of a drive to a unit acceleration at time 0, after its delay: velocity v, its
/// derivative and its integrals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Responses {
    changed: f32,
    velocity: f32,
    moved: f32,
    /// The integral of `moved`.
    area: f32,
}

/// Terms of the series of both integrals.
const TERMS: usize = 10;

impl Responses {
    /// The two integrals by their series, from their smallest terms on:
    ///
    /// ```text
    /// v'' + a2 v' + a1 v = 0,   v = Sum d_n T^n / n!,   d_0 = 0, d_1 = 1, d_(n+1) = -a2 d_n - a1 d_(n-1)
    /// v  = T - a2 moved - a1 area         v' = 1 - a2 v - a1 moved
    /// ```
    ///
    /// Cost: some 120 instructions.
    pub(crate) fn new(drive: &ScaledDrive) -> Self {
        let time = drive.delay;
        let (damped, stiff) = (drive.a2 * time, drive.a1 * time * time);
        // d_n T^(n+1) / (n+1)!, of n and of n - 1.
        let (mut term, mut before) = (0.5 * time * time, 0.0);
        let (mut moved, mut area) = (0.0, 0.0);
        for n in 1..=TERMS {
            let (this, next) = ((n + 1) as f32, 1.0 / (n + 2) as f32);
            moved += term;
            area += term * time * next;
            let following = -next * (damped * term + stiff * before / this);
            (before, term) = (term, following);
        }
        let velocity = time - drive.a2 * moved - drive.a1 * area;
        Self {
            changed: 1.0 - drive.a2 * velocity - drive.a1 * moved,
            velocity,
            moved,
            area,
        }
    }

    /// `k e^(A T)` of x' = v, v' = p - a2 v, p' = -a1 v + d, d' = 0.
    fn behind(&self, drive: &ScaledDrive, [k0, k1, k2, k3]: [f32; 4]) -> [f32; 4] {
        let Self {
            changed,
            velocity,
            moved,
            area,
        } = *self;
        let ScaledDrive { a1, a2, .. } = *drive;
        [
            k0,
            k0 * velocity + k1 * changed - k2 * a1 * velocity,
            k0 * moved + k1 * velocity + k2 * (changed + a2 * velocity),
            k0 * area + k1 * moved + k2 * (velocity + a2 * moved) + k3,
        ]
    }

    /// `e^(A T) B` without the disturbance.
    fn arrived(&self, drive: &ScaledDrive) -> [f32; 3] {
        [
            self.moved,
            self.velocity,
            self.changed + drive.a2 * self.velocity,
        ]
        .map(|x| drive.b0 * x)
    }
}

#[cfg(test)]
mod tests;
