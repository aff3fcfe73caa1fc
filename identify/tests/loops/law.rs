//! Controllers by the equations that are printed, with the digits of the report.

use nalgebra::{DMatrix, DVector};
use trendid_identify::tune::{Gains, Model};

use super::plant::Plant;

/// Digits of a gain in the report.
const DIGITS: usize = 6;

/// A gain as it is printed.
pub(crate) fn printed(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1)
        .parse()
        .expect("a number")
}

/// The difference equations of the report, with its digits.
pub(crate) struct Law {
    gains: Gains,
    dt: f64,
    /// Whatever the equations keep.
    state: Vec<f64>,
    observer: Option<Observer>,
}

/// `x(k+1) = A x + B0 (u(k-d) + w) + B1 (u(k-d-1) + w)`, `y = C x`.
pub(crate) struct Observer {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: [DVector<f64>; 2],
    pub(crate) c: DVector<f64>,
    pub(crate) delay: usize,
    pub(crate) x: DVector<f64>,
    w: f64,
    /// u(k-1), u(k-2) ..
    past: Vec<f64>,
}

impl Observer {
    pub(crate) fn of(plant: &Plant, derivatives: bool) -> Self {
        let Model { a, b, delay } = &plant.model;
        let m = a.len();
        let mut wide = DMatrix::zeros(m + 1, m + 1);
        for i in 0..m {
            if i + 1 < m {
                wide[(i, i + 1)] = 1.0;
            }
            wide[(m - 1, i)] = -a[i];
        }
        wide[(m - 1, m)] = if derivatives { b[0] } else { 1.0 };
        let over = |t: f64| {
            let step = (&wide * t).exp();
            let input = step.view((0, m), (m, 1)).column(0).into_owned();
            (step.view((0, 0), (m, m)).into_owned(), input)
        };
        let samples = delay / plant.dt;
        let part = samples - samples.floor();
        let (rest, newer) = over((1.0 - part) * plant.dt);
        let older = &rest * over(part * plant.dt).1;
        let c = |i: usize| match derivatives {
            true => f64::from(u8::from(i == 0)),
            false => b.get(i).copied().unwrap_or(0.0),
        };
        Self {
            a: over(plant.dt).0,
            b: [newer, older],
            c: DVector::from_fn(m, |i, _| c(i)),
            delay: samples.floor() as usize,
            x: DVector::zeros(m),
            w: 0.0,
            past: vec![0.0; samples.floor() as usize + 2],
        }
    }
}

impl Law {
    pub(crate) fn of(plant: &Plant, gains: &Gains) -> Self {
        let observer = match gains {
            Gains::StateFeedback(f) => Some(Observer::of(plant, f.derivatives)),
            _ => None,
        };
        Self {
            gains: gains.clone(),
            dt: plant.dt,
            state: vec![0.0; 5],
            observer,
        }
    }

    pub(crate) fn step(&mut self, r: f64, y: f64) -> f64 {
        let (dt, s) = (self.dt, &mut self.state);
        match &self.gains {
            Gains::Cascade(c) => {
                let [alpha, integral] = [dt / (c.tf + dt), c.kp * dt / c.ti].map(printed);
                s[0] += alpha * ((y - s[1]) / dt - s[0]);
                let e = printed(c.kv) * (r - y) - s[0];
                let u = printed(c.kp) * e + s[2];
                s[2] += integral * e;
                s[1] = y;
                u
            }
            Gains::Pid(c) => {
                let [beta, derivative] = [c.tf, c.kp * c.td].map(|v| printed(v / (c.tf + dt)));
                let e = r - y;
                s[0] = beta * s[0] + derivative * (s[1] - y);
                let u = printed(c.kp) * e + s[2] + s[0];
                s[2] += printed(c.kp * dt / c.ti) * e;
                s[1] = y;
                u
            }
            Gains::StateFeedback(f) => {
                let Some(o) = &mut self.observer else {
                    return 0.0;
                };
                // The inputs under way, the disturbance with each.
                let mut ahead = o.x.clone();
                for j in 0..o.delay {
                    let [newer, older] = [o.past[o.delay - 1 - j], o.past[o.delay - j]];
                    ahead = &o.a * ahead + &o.b[0] * (newer + o.w) + &o.b[1] * (older + o.w);
                }
                let k = f.k.iter().zip(ahead.iter()).map(|(k, x)| printed(*k) * x);
                let v1 = o.past[0] + o.w;
                let u = printed(f.n) * r - k.sum::<f64>() - printed(f.k_input) * v1 - o.w;
                o.past.rotate_right(1);
                o.past[0] = u;
                let error = y - o.c.dot(&o.x);
                let [newer, older] = [o.past[o.delay], o.past[o.delay + 1]];
                let l = DVector::from_fn(o.x.len(), |i, _| printed(f.l[i]));
                o.x = &o.a * &o.x + &o.b[0] * (newer + o.w) + &o.b[1] * (older + o.w) + l * error;
                o.w += printed(f.l[o.x.len()]) * error;
                u
            }
        }
    }
}
