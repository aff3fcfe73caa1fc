//! Records with a delay that is searched, whose input says little: what the deviations contain.
//!
//! From a simulation that shares nothing with the library, behind white or slow noise.

mod draws;

use draws::Uniform;
use trendid_identify::structure_choice::{Range, select};
use trendid_identify::{Choice, Error, Freedom, Options, Problem, Signals, Structure, identify};

const SEARCHED: Freedom = Freedom {
    pole: Choice::Auto,
    delay: Choice::Auto,
};

/// Draws of each kind, from a seed on with which nothing was tuned.
const RECORDS: u64 = 200;
const FIRST_SEED: u64 = 700_001;

/// What the input is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// One step, after a tenth to a half of the record.
    Step,
    /// One sine from the first sample on, from rest.
    Sine,
    /// Levels held for one to six time constants.
    Steps,
}

/// `prod (s + r_i) y = b u(t - delay)` of order 1 or 2 with noise.
struct Drawn {
    dt: f64,
    structure: Structure,
    truth: Vec<f64>,
    delay: f64,
    u: Vec<f64>,
    y: Vec<f64>,
}

impl Drawn {
    fn of(seed: u64, kind: Kind) -> Self {
        let mut draw = Uniform::of(seed);
        let dt = draw.between(0.5e-3, 10e-3);
        let samples = 2000 + (2000.0 * draw.next()) as usize;
        let rate = draw.between(15.0 / (samples as f64 * dt), 0.05 / dt);
        let order = 1 + (seed % 2) as usize;
        let rates: Vec<f64> = (0..order)
            .map(|i| rate * (1.0 + i as f64 * (1.0 + draw.next())))
            .collect();
        let a = match *rates.as_slice() {
            [r] => vec![r],
            [r, s] => vec![r * s, r + s],
            _ => unreachable!("order 1 or 2"),
        };
        let gain = draw.between(0.3, 30.0);
        let delay = (41.0 * draw.next()) as usize;
        let begin = ((0.1 + 0.4 * draw.next()) * samples as f64) as usize;
        let hold = (draw.between(1.0, 6.0) / (rate * dt)) as usize;
        let speed = rate * draw.between(0.3, 3.0) * dt;
        let mut level = 0.0;
        let u: Vec<f64> = (0..samples)
            .map(|k| match kind {
                Kind::Step => f64::from(u8::from(k >= begin)),
                Kind::Sine => (speed * k as f64).sin(),
                Kind::Steps => {
                    if k.is_multiple_of(hold.max(1)) {
                        level = 2.0 * draw.next() - 1.0;
                    }
                    level
                }
            })
            .collect();
        let mut y = response(&u, dt, &rates, gain, delay);
        add_noise(&mut y, &mut draw);
        let mut truth = a.clone();
        truth.push(gain * a[0]);
        let constant = (seed / 2).is_multiple_of(2);
        truth.extend(constant.then_some(0.0));
        Self {
            dt,
            structure: Structure {
                constant,
                ..Structure::of_order(order)
            },
            truth,
            delay: delay as f64,
            u,
            y,
        }
    }
}

/// Without noise, from rest.
fn response(u: &[f64], dt: f64, rates: &[f64], gain: f64, delay: usize) -> Vec<f64> {
    // The lags one behind the other, the held input exact: those behind it by steps of 1/50.
    let mut x = vec![0.0; rates.len()];
    let mut y = Vec::new();
    for k in 0..u.len() {
        y.push(gain * x[rates.len() - 1]);
        let acts = if k < delay { 0.0 } else { u[k - delay] };
        for _ in 0..50 {
            let mut before = (acts, acts);
            for (x, r) in x.iter_mut().zip(rates) {
                let z = 0.5 * r * dt / 50.0;
                let next = (*x * (1.0 - z) + z * (before.0 + before.1)) / (1.0 + z);
                before = (*x, next);
                *x = next;
            }
        }
    }
    y
}

/// White or slow, 0.3 to 3 % of the movement.
fn add_noise(y: &mut [f64], draw: &mut Uniform) {
    let n = y.len() as f64;
    let mean = y.iter().sum::<f64>() / n;
    let size = (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
    let noise = size * draw.between(3e-3, 3e-2);
    let slow = draw.next() < 0.5;
    let mut state = 0.0;
    for y in y {
        let white = draw.normal();
        state = 0.9 * state + (1.0_f64 - 0.81).sqrt() * white;
        *y += noise * if slow { state } else { white };
    }
}

/// Shares of parameters and delays within one and three standard deviations \[%\].
struct Coverage {
    within_1: f64,
    within_3: f64,
    refused: usize,
    records: usize,
}

fn coverage(kind: Kind, seeds: std::ops::Range<u64>) -> Coverage {
    let (mut z, mut refused, mut beyond) = (Vec::new(), 0, 0);
    let records = seeds.clone().count();
    for seed in seeds {
        let drawn = Drawn::of(seed, kind);
        let signals = Signals::held(drawn.dt, &drawn.u, &drawn.y);
        let problem =
            Problem::new(&signals, drawn.structure, Options::default()).expect("a problem");
        let found = match identify(&problem, SEARCHED, 0, &()) {
            Ok(found) => found,
            Err(_) => {
                refused += 1;
                continue;
            }
        };
        let e = &found.estimate;
        let truth = drawn.truth.iter().zip(e.theta.iter().zip(&e.sigma));
        let mut of_record: Vec<f64> = truth.map(|(t, (v, s))| (v - t) / s).collect();
        of_record.push((found.delay - drawn.delay) / found.delay_sigma().unwrap_or(0.0));
        if of_record.iter().any(|z| !(z.abs() < 3.0)) {
            beyond += 1;
        }
        z.extend(of_record);
    }
    let within = |limit: f64| {
        let n = z.iter().filter(|z| z.abs() < limit).count();
        100.0 * n as f64 / z.len().max(1) as f64
    };
    let found = Coverage {
        within_1: within(1.0),
        within_3: within(3.0),
        refused,
        records,
    };
    println!(
        "{kind:?}: within 1 sigma {:.1} %, within 3 {:.1} %; records beyond 3: {beyond}, refused {refused}, of {records}",
        found.within_1, found.within_3
    );
    found
}

fn assert_covered(kind: Kind) {
    let found = coverage(kind, FIRST_SEED..FIRST_SEED + RECORDS);
    assert!(found.within_3 >= 99.0, "{:.1} %", found.within_3);
    assert!(
        (64.0..76.0).contains(&found.within_1),
        "{:.1} %",
        found.within_1
    );
    assert!(found.refused as f64 <= 0.15 * found.records as f64);
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn deviations_of_one_step_contain_its_errors() {
    assert_covered(Kind::Step);
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn deviations_of_many_steps_contain_their_errors() {
    assert_covered(Kind::Steps);
}

/// Gain and phase of one frequency are two numbers, whatever the order.
#[test]
fn one_sine_with_a_delay_is_refused() {
    for seed in FIRST_SEED..FIRST_SEED + 20 {
        let drawn = Drawn::of(seed, Kind::Sine);
        let signals = Signals::held(drawn.dt, &drawn.u, &drawn.y);
        let problem =
            Problem::new(&signals, drawn.structure, Options::default()).expect("a problem");
        let unknowns = drawn.structure.order + 2;
        let refused = identify(&problem, SEARCHED, 0, &());
        assert_eq!(refused.err(), Some(Error::OneSine { unknowns }), "{seed}");
        let range = Range {
            max_order: 2,
            integrating: false,
            constant: true,
        };
        let refused = select(&signals, range, Options::default(), SEARCHED, &());
        assert_eq!(refused.err(), Some(Error::OneSineForAll), "{seed}");
    }
}
