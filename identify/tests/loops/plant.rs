//! A plant by its modes.

use trendid_identify::tune::Model;

use super::C;
use crate::draws::Uniform;

/// `B(s)/prod (s - p)` behind a delay, every `dt`.
pub(crate) struct Plant {
    pub(crate) poles: Vec<C>,
    pub(crate) model: Model,
    pub(crate) dt: f64,
}

impl Plant {
    pub(crate) fn of(seed: u64) -> Self {
        let mut draw = Uniform(seed);
        for _ in 0..9 {
            draw.next();
        }
        let order = 1 + (4.0 * draw.next()) as usize;
        let dt = draw.between(1e-4, 1e-1);
        let speed = draw.between(1e-4, 0.7) / dt;
        let mut poles: Vec<C> = Vec::new();
        if draw.next() < 0.4 {
            poles.push(C::new(0.0, 0.0));
        }
        while poles.len() < order {
            let rate = speed * draw.between(0.2, 5.0);
            if order - poles.len() >= 2 && draw.next() < 0.5 {
                let damping = draw.between(3e-3, 0.95);
                let im = rate * (1.0 - damping * damping).sqrt();
                poles.extend([C::new(-damping * rate, im), C::new(-damping * rate, -im)]);
            } else {
                poles.push(C::new(-rate, 0.0));
            }
        }
        let mut a = vec![C::new(1.0, 0.0)];
        for p in &poles {
            a.insert(0, C::new(0.0, 0.0));
            for i in 0..a.len() - 1 {
                let next = a[i + 1];
                a[i] -= p * next;
            }
        }
        a.truncate(order);
        let a: Vec<f64> = a.iter().map(|a| a.re).collect();
        let gain = 10_f64.powf(1.5 * draw.normal()) * if draw.next() < 0.3 { -1.0 } else { 1.0 };
        let scale: f64 = poles
            .iter()
            .map(|p| p.norm())
            .filter(|p| *p > 0.0)
            .product();
        let mut b = vec![gain * scale];
        if order >= 2 && draw.next() < 0.4 {
            let side = if draw.next() < 0.4 { -1.0 } else { 1.0 };
            b.push(b[0] * side / (speed * draw.between(0.5, 30.0)));
        }
        let longest = [0.0, 1.0, 3.0, 10.0, 40.0][(5.0 * draw.next()) as usize];
        let samples = longest * draw.next();
        let samples = if draw.next() < 0.3 {
            samples.floor()
        } else {
            samples
        };
        let model = Model {
            a,
            b,
            delay: samples * dt,
        };
        Self { poles, model, dt }
    }

    /// Of each mode its factor over a sample, and its shares of the newer and the older input.
    pub(crate) fn modes(&self) -> Vec<[C; 3]> {
        let samples = self.model.delay / self.dt;
        let part = samples - samples.floor();
        let grown = |p: C, t: f64| match p.norm() == 0.0 {
            true => C::new(t, 0.0),
            // (e^{pt} - 1)/p without cancellation.
            false => (p * (0.5 * t)).exp() * 2.0 * (p * (0.5 * t)).sinh() / p,
        };
        let mode = |(i, p): (usize, &C)| {
            let others = self.poles.iter().enumerate().filter(|(j, _)| *j != i);
            let away = others.fold(C::new(1.0, 0.0), |away, (_, q)| away * (p - q));
            let b = self
                .model
                .b
                .iter()
                .rev()
                .fold(C::new(0.0, 0.0), |s, b| s * p + b);
            let rest = (1.0 - part) * self.dt;
            let newer = grown(*p, rest);
            let older = (p * rest).exp() * grown(*p, part * self.dt);
            [(p * self.dt).exp(), b / away * newer, b / away * older]
        };
        self.poles.iter().enumerate().map(mode).collect()
    }

    pub(crate) fn response(&self, modes: &[[C; 3]], z: C) -> C {
        let late = z.powi(-((self.model.delay / self.dt).floor() as i32));
        let each = modes
            .iter()
            .map(|[a, newer, older]| (newer + older / z) / (z - a));
        each.sum::<C>() * late
    }
}
