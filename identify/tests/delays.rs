//! Records of linear plants behind a delay, from a simulation that shares nothing with the library:
//! any delay is found, with a constant or without, and without noise no parameter is further from
//! the truth than its standard deviation says.

mod draws;

use draws::Uniform;
use trendid_identify::structure_choice::{Range, select};
use trendid_identify::{Choice, Freedom, Options, Problem, Signals, Structure, identify};

/// A plant `prod (s - p) y = b u(t - delay) + constant` with real poles.
struct Drawn {
    dt: f64,
    structure: Structure,
    /// theta, from a_0 or behind an integrator a_1 on.
    truth: Vec<f64>,
    delay: usize,
    u: Vec<f64>,
    y: Vec<f64>,
}

impl Drawn {
    /// Order 1 to 3, 0.5 to 10 ms, a delay up to 150 samples; binary commands, steps or a sweep.
    fn of(seed: u64, integrator: bool, noise: f64) -> Self {
        let mut draw = Uniform::of(seed);
        let dt = draw.between(0.5e-3, 10e-3);
        let samples = 2000 + (3000.0 * draw.next()) as usize;
        let order = 1 + (seed % 3) as usize;
        let rate = draw.between(20.0 / (samples as f64 * dt), 0.05 / dt);
        let mut poles: Vec<f64> = (0..order)
            .map(|i| -rate * (1.0 + i as f64 * (1.0 + draw.next())))
            .collect();
        if integrator {
            poles[0] = 0.0;
        }
        let a = denominator(&poles);
        let b = draw.between(0.3, 30.0) * a.get(usize::from(integrator)).unwrap_or(&1.0);
        let delay = (151.0 * draw.next()) as usize;
        let hold = ((draw.between(0.3, 3.0) / (rate * dt)) as usize).clamp(5, samples / 20);
        let kind = seed / 3 % 3;
        let (mut level, mut phase) = (0.0, 0.0_f64);
        let mut command = |k: usize| {
            if kind == 2 {
                phase += 0.2 * rate * dt * 25_f64.powf(k as f64 / samples as f64);
                return phase.sin();
            }
            if k.is_multiple_of(hold) {
                level = 2.0 * draw.next() - 1.0;
            }
            if kind == 0 { level.signum() } else { level }
        };
        let u: Vec<f64> = (0..samples).map(&mut command).collect();
        let mut y = response(&u, dt, &poles, b, delay);
        let size = deviation(&y);
        let constant = (seed / 9).is_multiple_of(2);
        let offset = match constant && !integrator {
            true => 1.4 * size * (2.0 * draw.next() - 1.0),
            false => 0.0,
        };
        y.iter_mut()
            .for_each(|y| *y += offset + noise * size * draw.normal());
        let mut truth = a[usize::from(integrator)..].to_vec();
        truth.push(b);
        truth.extend(constant.then_some(a[0] * offset));
        Self {
            dt,
            structure: Structure {
                integrator,
                constant,
                ..Structure::of_order(order)
            },
            truth,
            delay,
            u,
            y,
        }
    }

    fn signals(&self) -> Signals<'_> {
        Signals::held(self.dt, &self.u, &self.y)
    }
}

/// a_0 .. a_{m-1} of the polynomial with these roots.
fn denominator(poles: &[f64]) -> Vec<f64> {
    let mut a = vec![1.0];
    for p in poles {
        a.insert(0, 0.0);
        for i in 0..a.len() - 1 {
            a[i] -= p * a[i + 1];
        }
    }
    a.truncate(poles.len());
    a
}

/// Exact, mode by mode, at rest before the record.
fn response(u: &[f64], dt: f64, poles: &[f64], b: f64, delay: usize) -> Vec<f64> {
    let mut y = vec![0.0; u.len()];
    for p in poles {
        let others = poles.iter().filter(|q| *q != p);
        let residue = others.fold(b, |residue, q| residue / (p - q));
        let gain = match *p {
            0.0 => dt,
            p => (p * dt).exp_m1() / p,
        };
        let mut x = 0.0;
        for k in 0..u.len() {
            y[k] += x;
            let acts = if k < delay { 0.0 } else { u[k - delay] };
            x = (p * dt).exp() * x + residue * gain * acts;
        }
    }
    y
}

fn deviation(y: &[f64]) -> f64 {
    let n = y.len() as f64;
    let mean = y.iter().sum::<f64>() / n;
    (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt()
}

const SEARCHED: Freedom = Freedom {
    pole: Choice::Auto,
    delay: Choice::Auto,
};

/// The shortest delays lead nowhere where the input changes more often than the delay is long.
#[test]
fn any_delay_is_found() {
    let mut missed = Vec::new();
    for seed in 1..=36_u64 {
        let noise = [0.0, 1e-3, 1e-2][(seed % 5 % 3) as usize];
        let drawn = Drawn::of(seed, false, noise);
        let signals = drawn.signals();
        let problem =
            Problem::new(&signals, drawn.structure, Options::default()).expect("a problem");
        match identify(&problem, SEARCHED, 0, &()) {
            Ok(found) => {
                let far = (found.delay - drawn.delay as f64).abs();
                if far > 1.0 && far > 3.0 * found.delay_sigma().unwrap_or(0.0) {
                    missed.push(format!("{seed}: {} for {}", found.delay, drawn.delay));
                }
            }
            Err(error) => missed.push(format!("{seed}: {error}")),
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// Records of 600 samples that move in the first hundred and thirty only, by commands which change
/// every four to seven: the longest delays that are searched have their inputs in none of them.
#[test]
fn a_delay_is_found_in_the_beginning_of_a_short_record() {
    let mut missed = Vec::new();
    for seed in 1..=12_u64 {
        let mut draw = Uniform(seed);
        let (dt, samples, delay) = (0.01, 600, 22 + (8.0 * draw.next()) as usize);
        let hold = 4 + seed as usize % 4;
        let mut level = 0.0;
        let command = |k: usize| {
            if k.is_multiple_of(hold) {
                level = (draw.next() - 0.5).signum();
            }
            if k < 100 { level } else { 0.0 }
        };
        let u: Vec<f64> = (0..samples).map(command).collect();
        let mut y = response(&u, dt, &[-20.0], 20.0, delay);
        y.iter_mut().for_each(|y| *y += 0.05 * draw.normal());
        let signals = Signals::held(dt, &u, &y);
        let structure = Structure::of_order(1);
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        match identify(&problem, SEARCHED, 0, &()) {
            Ok(found) if (found.delay - delay as f64).abs() <= 1.0 => {}
            Ok(found) => missed.push(format!("{seed}: {} for {delay}", found.delay)),
            Err(error) => missed.push(format!("{seed}: {error}")),
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// A lag behind a long delay is no integrator.
#[test]
fn a_lag_behind_any_delay_is_selected() {
    let mut missed = Vec::new();
    for seed in (3..=60_u64).step_by(3) {
        let drawn = Drawn::of(seed, false, 0.0);
        let range = Range {
            max_order: 1,
            integrating: false,
            constant: drawn.structure.constant,
        };
        let selection = select(&drawn.signals(), range, Options::default(), SEARCHED, &());
        let found = selection.map(|selection| {
            let recommended = &selection.candidates[selection.recommended];
            (recommended.structure, recommended.delay)
        });
        if found != Ok((drawn.structure, drawn.delay)) {
            missed.push((seed, found));
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// What is left without noise is rounding, and the deviations contain it.
#[test]
fn without_noise_deviations_contain_the_rounding() {
    let (mut largest, mut of_delay) = (0.0_f64, 0.0_f64);
    for seed in 1..=24_u64 {
        let drawn = Drawn::of(seed, seed % 4 == 3, 0.0);
        let signals = drawn.signals();
        let problem =
            Problem::new(&signals, drawn.structure, Options::default()).expect("a problem");
        let found = identify(&problem, SEARCHED, 0, &()).expect("a model");
        let e = &found.estimate;
        let each = drawn.truth.iter().zip(e.theta.iter().zip(&e.sigma));
        for (j, (truth, (value, sigma))) in each.enumerate() {
            let z = ((value - truth) / sigma).abs();
            assert!(
                z < 3.0,
                "seed {seed}, parameter {j}: {value} +- {sigma} for {truth}"
            );
            largest = largest.max(z);
        }
        let sigma = found.delay_sigma().expect("a deviation");
        of_delay = of_delay.max(((found.delay - drawn.delay as f64) / sigma).abs());
    }
    println!("largest: parameters {largest:.2}, delay {of_delay:.2}");
    assert!(of_delay < 3.0);
}
