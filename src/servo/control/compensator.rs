//! The loop in the frequency domain: controller with observer and prediction over the delay, on any
//! drive beside its own.

use crate::math::complex::Complex;
use crate::servo::control::poles::Poles;

/// A drive `b0 e^(-s T) / (s (s^2 + a2 s + a1))`; in units of its own time 1/w0, a1 and b0 are 1 in
/// the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    pub(crate) a1: f32,
    pub(crate) a2: f32,
    pub(crate) b0: f32,
    pub(crate) delay: f32,
}

/// The controller of a drive: feedback over b0, observer, transition over the delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compensator {
    drive: Drive,
    poles: Poles,
    /// Gains of x, v, p and the disturbance, over b0.
    k: [f32; 4],
    /// The same behind the prediction: k times the transition matrix.
    predicted: [f32; 4],
    l: [f32; 4],
    /// Where a unit of flow leads over the delay: the transition matrix times (0, 0, b0).
    arrived: [f32; 3],
}

fn times(a: Complex, x: f32) -> Complex {
    Complex {
        re: a.re * x,
        im: a.im * x,
    }
}

fn plus(a: Complex, b: Complex) -> Complex {
    Complex {
        re: a.re + b.re,
        im: a.im + b.im,
    }
}

/// `a + x`.
fn shifted(a: Complex, x: f32) -> Complex {
    Complex {
        re: a.re + x,
        im: a.im,
    }
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
    /// predicted.
    pub(crate) fn new(drive: Drive, poles: Poles, frequency: f32) -> Self {
        let [k0, k1, k2] = poles.feedback(drive.a1, drive.a2, frequency).k;
        let k = [k0, k1, k2, 1.0].map(|k| k / drive.b0);
        Self {
            drive,
            poles,
            k,
            predicted: transposed(&drive, k),
            l: poles.correction(drive.a1, drive.a2),
            arrived: arrived(&drive),
        }
    }

    /// From the measured position to the flow, at `w`: `f = -C y`; `late` is `e^(-j w T)` of the
    /// delay.
    pub(crate) fn at(&self, w: f32, late: Complex) -> Complex {
        let s = Complex { re: 0.0, im: w };
        let Drive { a1, a2, b0, .. } = self.drive;
        let observer = self.observer(s);
        // Unit flow into the observer, delayed; and the innovation.
        let [l1, l2, l3, l4] = self.l;
        let direct = self.observed(s, observer, [0.0, 0.0, b0, 0.0]).times(late);
        let through = self.observed(s, observer, [l1, l2, l3, l4]);
        // What the flows on their way will do: k (s - A)^-1 (B - Phi B e^(-s T)).
        let [k0, k1, k2, _] = self.k;
        let own = plus(s.times(s), shifted(times(s, a2), a1)).inverse();
        // (s - A)^-1 B: v = b0/D, p = (s + a2) v, x = v/s.
        let v = times(own, b0);
        let p = v.times(shifted(s, a2));
        let x = v.times(s.inverse());
        let now = plus(plus(times(x, k0), times(v, k1)), times(p, k2));
        let [bx, bv, bp] = self.arrived;
        // (s - A)^-1 Phi B.
        let vv = own.times(shifted(times(s, bv), bp));
        let pp = shifted(vv.times(shifted(s, a2)), -bv);
        let xx = shifted(vv, bx).times(s.inverse());
        let then = plus(plus(times(xx, k0), times(vv, k1)), times(pp, k2));
        let pending = now.minus(then.times(late));
        let denominator = plus(plus(Complex::ONE, direct), pending);
        through.times(denominator.inverse())
    }

    /// 1 over the polynomial of the observer.
    fn observer(&self, s: Complex) -> Complex {
        let o = shifted(s, self.poles.observer);
        let d = shifted(s, self.poles.disturbance);
        o.times(o).times(o).times(d).inverse()
    }

    /// `k Phi (s - A + L c)^-1 r`.
    fn observed(&self, s: Complex, observer: Complex, [rx, rv, rp, rd]: [f32; 4]) -> Complex {
        let Drive { a1, a2, .. } = self.drive;
        let [l1, l2, _, l4] = self.l;
        let square = s.times(s);
        let first = plus(times(square.times(shifted(s, a2)), rx), times(s, a1 * rx));
        let rest = shifted(plus(times(square, rv), times(s, rp)), rd);
        let x = plus(first, rest).times(observer);
        let v = shifted(x.times(shifted(s, l1)), -rx);
        let p = shifted(plus(v.times(shifted(s, a2)), times(x, l2)), -rv);
        let d = shifted(times(x, -l4), rd).times(s.inverse());
        let [g0, g1, g2, g3] = self.predicted;
        plus(
            plus(times(x, g0), times(v, g1)),
            plus(times(p, g2), times(d, g3)),
        )
    }
}

/// The drive's `b0 e^(-s T) / (s (s^2 + a2 s + a1))` at `w`; `late` is `e^(-j w T)` of its delay.
pub(crate) fn response(drive: &Drive, w: f32, late: Complex) -> Complex {
    let s = Complex { re: 0.0, im: w };
    let own = Complex {
        re: drive.a1 - w * w,
        im: drive.a2 * w,
    };
    times(late, drive.b0).times(own.times(s).inverse())
}

/// `A z` of x' = v, v' = p - a2 v, p' = -a1 v + d, d' = 0.
fn derivative(drive: &Drive, [_, v, p, d]: [f32; 4]) -> [f32; 4] {
    [v, p - drive.a2 * v, d - drive.a1 * v, 0.0]
}

/// Terms of the series of the transition matrix.
const TERMS: usize = 10;

/// `e^(A T) z`.
fn transition(drive: &Drive, z: [f32; 4]) -> [f32; 4] {
    let (mut sum, mut term) = (z, z);
    for n in 1..=TERMS {
        let share = drive.delay / n as f32;
        term = derivative(drive, term).map(|x| share * x);
        for (sum, term) in sum.iter_mut().zip(term) {
            *sum += term;
        }
    }
    sum
}

/// `k e^(A T)`.
fn transposed(drive: &Drive, k: [f32; 4]) -> [f32; 4] {
    let (mut sum, mut term) = (k, k);
    for n in 1..=TERMS {
        let share = drive.delay / n as f32;
        // k A.
        let [x, v, p, _] = term;
        term = [0.0, x - drive.a2 * v - drive.a1 * p, v, p].map(|x| share * x);
        for (sum, term) in sum.iter_mut().zip(term) {
            *sum += term;
        }
    }
    sum
}

/// `e^(A T) B` without the disturbance.
fn arrived(drive: &Drive) -> [f32; 3] {
    let [x, v, p, _] = transition(drive, [0.0, 0.0, drive.b0, 0.0]);
    [x, v, p]
}

#[cfg(test)]
mod tests;
