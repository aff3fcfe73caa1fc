//! Plants with zeros, drawn at random, and what they make of their input: exact, mode by mode.

use trendid_identify::{Signals, Structure};

use crate::draws::Uniform;

/// A complex number.
type Complex = (f64, f64);

fn times(x: Complex, y: Complex) -> Complex {
    (x.0 * y.0 - x.1 * y.1, x.0 * y.1 + x.1 * y.0)
}

fn over(x: Complex, y: Complex) -> Complex {
    let size = y.0 * y.0 + y.1 * y.1;
    let (re, im) = times(x, (y.0, -y.1));
    (re / size, im / size)
}

fn exp(x: Complex) -> Complex {
    (x.0.exp() * x.1.cos(), x.0.exp() * x.1.sin())
}

/// Lower coefficients of `prod (s - r)` of roots that are real or in pairs.
fn polynomial(roots: &[Complex]) -> Vec<f64> {
    let mut a = vec![(1.0, 0.0)];
    for r in roots {
        a.insert(0, (0.0, 0.0));
        for i in 0..a.len() - 1 {
            let part = times(*r, a[i + 1]);
            a[i] = (a[i].0 - part.0, a[i].1 - part.1);
        }
    }
    a.truncate(roots.len());
    a.into_iter().map(|a| a.0).collect()
}

/// Distinct poles in the s plane, and b_0 .. of the numerator.
struct Plant {
    poles: Vec<Complex>,
    b: Vec<f64>,
}

impl Plant {
    /// Order 2 or 3 by the seed, its zeros to both sides; the slowest pole at `rate`.
    fn of(draw: &mut Uniform, order: usize, rate: f64) -> Self {
        let integrator = draw.next() < 0.3;
        let mut poles: Vec<Complex> = (0..order)
            .map(|i| (-rate * (1.0 + i as f64 * (1.0 + draw.next())), 0.0))
            .collect();
        if draw.next() < 0.4 {
            let (size, damping) = (poles[order - 1].0.abs(), draw.between(0.1, 0.9));
            let im = size * (1.0 - damping * damping).sqrt();
            poles[order - 1] = (-damping * size, im);
            poles[order - 2] = (-damping * size, -im);
        }
        if integrator && poles[0].1 == 0.0 {
            poles[0] = (0.0, 0.0);
        }
        let zeros = 1 + draw.below(order - 1);
        let mut zero = |_| {
            let sign = if draw.next() < 0.7 { -1.0 } else { 1.0 };
            (sign * rate * draw.between(0.3, 10.0), 0.0)
        };
        let mut b = polynomial(&(0..zeros).map(&mut zero).collect::<Vec<_>>());
        b.push(1.0);
        let a = polynomial(&poles);
        let rest = a[usize::from(poles[0] == (0.0, 0.0))];
        let scale = draw.between(0.3, 30.0) * rest / b[0];
        b.iter_mut().for_each(|b| *b *= scale);
        Self { poles, b }
    }

    fn residue(&self, p: Complex) -> Complex {
        let mut residue = (0.0, 0.0);
        for b in self.b.iter().rev() {
            residue = times(residue, p);
            residue.0 += b;
        }
        let others = self.poles.iter().filter(|q| **q != p);
        others.fold(residue, |residue, q| over(residue, (p.0 - q.0, p.1 - q.1)))
    }

    /// The output for an input that is held, so many samples late; at rest before the record.
    fn response(&self, u: &[f64], dt: f64, delay: f64) -> Vec<f64> {
        let (whole, part) = (delay.floor() as usize, delay.fract());
        let at = |k: usize, late: usize| if k < late { 0.0 } else { u[k - late] };
        let mut y = vec![0.0; u.len()];
        for p in &self.poles {
            let residue = self.residue(*p);
            let moved = |x: Complex, t: f64, u: f64| {
                let decay = exp((p.0 * t, p.1 * t));
                let gain = match *p {
                    (0.0, 0.0) => (t, 0.0),
                    p => over((decay.0 - 1.0, decay.1), p),
                };
                let (free, forced) = (times(decay, x), times(residue, gain));
                (free.0 + forced.0 * u, free.1 + forced.1 * u)
            };
            let mut x = (0.0, 0.0);
            for (k, y) in y.iter_mut().enumerate() {
                *y += x.0;
                x = moved(x, part * dt, at(k, whole + 1));
                x = moved(x, (1.0 - part) * dt, at(k, whole));
            }
        }
        y
    }
}

/// Binary commands, steps or a sweep of a rate in parts of the sampling.
fn command(draw: &mut Uniform, kind: u64, (samples, rate): (usize, f64)) -> Vec<f64> {
    let hold = ((draw.between(0.3, 3.0) / rate) as usize).clamp(5, samples / 20);
    let (mut level, mut phase) = (0.0, 0.0_f64);
    let next = |k: usize| {
        if kind == 2 {
            phase += 0.2 * rate * 25_f64.powf(k as f64 / samples as f64);
            return phase.sin();
        }
        if k.is_multiple_of(hold) {
            level = draw.either_side();
        }
        if kind == 0 { level.signum() } else { level }
    };
    (0..samples).map(next).collect()
}

/// A record.
pub(crate) struct Drawn {
    pub(crate) structure: Structure,
    /// theta, from a_0 or behind an integrator a_1 on.
    pub(crate) truth: Vec<f64>,
    /// In samples; of whole ones in a fifth of the records.
    pub(crate) delay: f64,
    dt: f64,
    u: Vec<f64>,
    y: Vec<f64>,
}

impl Drawn {
    /// With white noise of a share of the movement.
    pub(crate) fn of(seed: u64, noise: f64) -> Self {
        let mut draw = Uniform::of(seed);
        let dt = draw.between(0.5e-3, 10e-3);
        let samples = 2000 + draw.below(3000);
        let rate = draw.between(20.0 / (samples as f64 * dt), 0.05 / dt);
        let order = 2 + (seed % 2) as usize;
        let plant = Plant::of(&mut draw, order, rate);
        let integrator = plant.poles[0] == (0.0, 0.0);
        let delay = 30.0 * draw.next();
        let delay = match draw.next() < 0.2 {
            true => delay.floor(),
            false => delay,
        };
        let u = command(&mut draw, seed / 3 % 3, (samples, rate * dt));
        let mut y = plant.response(&u, dt, delay);
        let n = y.len() as f64;
        let mean = y.iter().sum::<f64>() / n;
        let size = (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
        let constant = (seed / 9).is_multiple_of(2);
        let offset = match constant && !integrator {
            true => 1.4 * size * draw.either_side(),
            false => 0.0,
        };
        let noise = noise * size;
        y.iter_mut()
            .for_each(|y| *y += offset + noise * draw.normal());
        let a = polynomial(&plant.poles);
        let mut truth = a[usize::from(integrator)..].to_vec();
        truth.extend(&plant.b);
        truth.extend(constant.then_some(a[0] * offset));
        Self {
            structure: Structure {
                integrator,
                constant,
                zeros: plant.b.len() - 1,
                ..Structure::of_order(order)
            },
            truth,
            delay,
            dt,
            u,
            y,
        }
    }

    pub(crate) fn signals(&self) -> Signals<'_> {
        Signals::held(self.dt, &self.u, &self.y)
    }
}
