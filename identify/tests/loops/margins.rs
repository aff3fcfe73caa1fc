//! Margins from the modes of the plant and the equations of the controller, on a grid of its own.

use nalgebra::{DMatrix, DVector};
use trendid_identify::tune::{Gains, Margins, TunedLoop};

use super::C;
use super::law::Observer;
use super::plant::Plant;

/// From y to -u by the equations themselves: what a sine of the output gives, by its pulse answer.
fn controller(plant: &Plant, found: &TunedLoop, z: C) -> C {
    let dt = plant.dt;
    let q = z.inv();
    let one = C::new(1.0, 0.0);
    match &found.gains {
        Gains::Cascade(c) => {
            let alpha = dt / (c.tf + dt);
            let v = alpha / (one - q * (1.0 - alpha)) * (one - q) / dt;
            let pi = q / (one - q) * (c.kp * dt / c.ti) + c.kp;
            pi * (v + c.kv)
        }
        Gains::Pid(c) => {
            let beta = c.tf / (c.tf + dt);
            let d = (one - q) / (one - q * beta) * (c.kp * c.td / (c.tf + dt));
            q / (one - q) * (c.kp * dt / c.ti) + d + c.kp
        }
        Gains::StateFeedback(f) => {
            let o = Observer::of(plant, f.derivatives);
            let (m, d) = (o.x.len(), o.delay);
            // Unknowns x, w, u of a sine y = 1.
            let mut left = DMatrix::from_element(m + 2, m + 2, C::new(0.0, 0.0));
            let mut right = DVector::from_element(m + 2, C::new(0.0, 0.0));
            let both = &o.b[0] + &o.b[1];
            for i in 0..m {
                left[(i, i)] += z;
                for j in 0..m {
                    left[(i, j)] -= C::new(o.a[(i, j)] - f.l[i] * o.c[j], 0.0);
                }
                left[(i, m)] -= both[i];
                left[(i, m + 1)] -= q.powi(d as i32) * o.b[0][i] + q.powi(d as i32 + 1) * o.b[1][i];
                right[i] = C::new(f.l[i], 0.0);
            }
            left[(m, m)] = z - 1.0;
            for j in 0..m {
                left[(m, j)] += f.l[m] * o.c[j];
            }
            right[m] = C::new(f.l[m], 0.0);
            let mut ahead = DMatrix::from_element(m, m + 2, C::new(0.0, 0.0));
            (0..m).for_each(|i| ahead[(i, i)] = one);
            let a = o.a.map(|v| C::new(v, 0.0));
            for j in 0..d {
                ahead = &a * ahead;
                for i in 0..m {
                    ahead[(i, m)] += both[i];
                    let [newer, older] = [(d - j) as i32, (d - j) as i32 + 1];
                    ahead[(i, m + 1)] += q.powi(newer) * o.b[0][i] + q.powi(older) * o.b[1][i];
                }
            }
            for j in 0..m + 2 {
                for i in 0..m {
                    left[(m + 1, j)] += ahead[(i, j)] * f.k[i];
                }
            }
            left[(m + 1, m)] += 1.0 + f.k_input;
            left[(m + 1, m + 1)] += q * f.k_input + 1.0;
            let found = left.lu().solve(&right).expect("no pole on the circle");
            -found[m + 1]
        }
    }
}

/// Frequencies, finer and further than those of the library.
fn frequencies(plant: &Plant, bandwidth: f64) -> Vec<f64> {
    let top = std::f64::consts::PI / plant.dt * 0.9999;
    let decades = (top / (1e-3 * bandwidth)).log10();
    let even = (0..2000).map(|k| top * 10_f64.powf(-decades * f64::from(k) / 2000.0));
    let mut grid: Vec<f64> = even.collect();
    for p in &plant.poles {
        // Around a resonance by parts of its width.
        let (w, half) = (p.im, -p.re);
        if w > 0.0 {
            grid.extend((-200..=200).map(|k| w + half * (0.03 * f64::from(k)).sinh()));
        }
    }
    grid.retain(|w| *w > 0.0 && *w < top);
    grid.sort_by(f64::total_cmp);
    grid
}

/// Margins by the signs between neighbours of that grid.
pub(crate) fn margins(plant: &Plant, found: &TunedLoop) -> Margins {
    let dt = plant.dt;
    let modes = plant.modes();
    let grid = frequencies(plant, found.bandwidth);
    let open = |w: f64| {
        let z = C::new(0.0, w * dt).exp();
        plant.response(&modes, z) * controller(plant, found, z)
    };
    let values: Vec<C> = grid.iter().map(|w| open(*w)).collect();
    let mut peak = 0;
    let mut m = Margins {
        gain: f64::INFINITY,
        phase_deg: f64::INFINITY,
        delay: f64::INFINITY,
        max_sensitivity: 0.0,
        crossover: 0.0,
        stable: true,
    };
    for (k, l) in values.iter().enumerate() {
        let sensitivity = (l + 1.0).inv().norm();
        if sensitivity > m.max_sensitivity {
            m.max_sensitivity = sensitivity;
            peak = k;
        }
        let Some(next) = values.get(k + 1) else { break };
        let share = |a: f64, b: f64| a / (a - b);
        if (l.norm() > 1.0) != (next.norm() > 1.0) {
            let s = share(l.norm().ln(), next.norm().ln());
            let w = grid[k] + s * (grid[k + 1] - grid[k]);
            let lag = (-open(w)).arg().to_degrees();
            m.phase_deg = m.phase_deg.min(lag.abs());
            m.delay = m.delay.min(lag.rem_euclid(360.0).to_radians() / w);
            m.crossover = m.crossover.max(w);
        }
        if l.im * next.im < 0.0 {
            let s = share(l.im, next.im);
            let real = l.re + s * (next.re - l.re);
            if real < 0.0 {
                m.gain = m.gain.min((-real).max(-1.0 / real));
            }
        }
    }
    // Between the neighbours of the largest.
    let [low, high] = [
        grid[peak.saturating_sub(1)],
        grid[(peak + 1).min(grid.len() - 1)],
    ];
    for k in 0..=100 {
        let l = open(low + (high - low) * f64::from(k) / 100.0);
        m.max_sensitivity = m.max_sensitivity.max((l + 1.0).inv().norm());
    }
    m
}
