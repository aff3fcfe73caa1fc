//! Delays that are not of whole samples, without noise, from an exact simulation that shares nothing
//! with the library.

mod draws;

use draws::Uniform;
use trendid_identify::structure_choice::{Range, select};
use trendid_identify::{Choice, Freedom, Hold, Options, Problem, Signals, Structure, identify};

/// `prod (s - p_i) y = b u(t - delay)`, mode by mode: the input changes within the sample.
fn response(u: &[f64], hold: Hold, dt: f64, poles: &[f64], b: f64, delay: f64) -> Vec<f64> {
    let (whole, part) = (delay.floor() as usize, delay.fract());
    let at = |k: usize, late: usize| if k < late { u[0] } else { u[k - late] };
    let mut y = vec![0.0; u.len()];
    for p in poles {
        let others = poles.iter().filter(|q| *q != p);
        let residue = others.fold(b, |residue, q| residue / (p - q));
        // From the value `from` to the value `to` within t.
        let moved = |x: f64, t: f64, from: f64, to: f64| {
            let gain = (p * t).exp_m1() / p;
            let slope = (to - from) / t;
            (p * t).exp() * x + residue * (gain * from + (gain - t) / p * slope)
        };
        let mut x = -residue * u[0] / p;
        for (k, y) in y.iter_mut().enumerate().take(u.len() - 1) {
            *y += x;
            let (before, now, next) = (at(k, whole + 1), at(k, whole), at(k + 1, whole));
            // To the change within the sample, and from there.
            let [[from, to], [on, end]] = match hold {
                Hold::First => {
                    let straight = |from: f64, to: f64| to + part * (from - to);
                    [[straight(before, now), now], [now, straight(now, next)]]
                }
                _ => [[before; 2], [now; 2]],
            };
            x = moved(x, part * dt, from, to);
            x = moved(x, (1.0 - part) * dt, on, end);
        }
        *y.last_mut().expect("a sample") += x;
    }
    y
}

/// Commands of one of two levels: held, or on the way from one to the next, for 37 samples.
fn commands(hold: Hold) -> Vec<f64> {
    let (mut seed, mut level, mut before) = (5_u64, 0.0, 0.0);
    let command = |k: usize| {
        if k.is_multiple_of(37) {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            before = level;
            level = if seed >> 63 == 0 { -1.0 } else { 1.0 };
        }
        let way = (k % 37) as f64 / 37.0;
        match hold {
            Hold::First => before + way * (level - before),
            _ => level,
        }
    };
    (0..4000).map(command).collect()
}

/// Largest relative error of a parameter of the orders 1 to 3, and before them that of the delay.
fn errors(hold: Hold, rates: [f64; 3]) -> [f64; 4] {
    let (dt, u) = (0.01, commands(hold));
    let mut largest = [0.0_f64; 4];
    for order in 1..=3 {
        for tenths in 1..=9 {
            let delay = 3.0 + 0.1 * f64::from(tenths);
            let poles: Vec<f64> = rates[..order].iter().map(|rate| -rate).collect();
            let (mut a, b) = (vec![1.0], 2.0);
            for p in &poles {
                a.insert(0, 0.0);
                for i in 0..a.len() - 1 {
                    a[i] -= p * a[i + 1];
                }
            }
            let b = b * a[0];
            let y = response(&u, hold, dt, &poles, b, delay);
            let mut signals = Signals::held(dt, &u, &y);
            signals.inputs[0].hold = hold;
            let structure = Structure::of_order(order);
            let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
            let freedom = Freedom {
                pole: Choice::Auto,
                delay: Choice::Auto,
            };
            let found = identify(&problem, freedom, 0, &()).expect("a model");
            // What was searched is not missed.
            assert_eq!(found.delay_missed(), None, "order {order}, delay {delay}");
            let truth = a[..order].iter().chain([&b]);
            let off = truth
                .zip(&found.estimate.theta)
                .map(|(truth, found)| (found / truth - 1.0).abs());
            let off = off.fold(0.0, f64::max);
            let late = (found.delay - delay).abs();
            largest[order] = largest[order].max(off);
            largest[0] = largest[0].max(late);
            println!(
                "order {order}, delay {delay}: {:.5} %, {late:.5} samples",
                100.0 * off
            );
        }
    }
    println!("{hold:?}, largest: {largest:?}");
    largest
}

/// Rates up to a twentieth of the sampling.
#[test]
fn a_delay_between_samples_costs_no_accuracy() {
    let largest = errors(Hold::Zero, [3.0, 5.0, 9.0]);
    assert!(largest[1..].iter().all(|off| *off <= 5e-4) && largest[0] < 0.01);
}

/// Rates up to a third of the sampling: each corner of the input is within a sample.
#[test]
fn corners_between_samples_cost_no_accuracy() {
    let largest = errors(Hold::First, [10.0, 17.0, 30.0]);
    assert!(largest[1..].iter().all(|off| *off <= 1e-3) && largest[0] < 0.01);
}

/// An integrator alone has no poles but those of its filter, which are not its own.
#[test]
fn an_integrator_is_late_by_parts_of_a_sample() {
    let (dt, gain, u) = (0.01, 3.0, commands(Hold::Zero));
    for tenths in 0..=9 {
        let part = 0.1 * f64::from(tenths);
        let mut y = vec![0.0; u.len()];
        for k in 2..u.len() {
            y[k] = y[k - 1] + gain * dt * (part * u[k - 2] + (1.0 - part) * u[k - 1]);
        }
        let signals = Signals::held(dt, &u, &y);
        let structure = Structure {
            integrator: true,
            ..Structure::of_order(1)
        };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        for pole in [1.0, 5.0, 20.0] {
            let freedom = Freedom {
                pole: Choice::Given(Some(pole)),
                delay: Choice::Auto,
            };
            let found = identify(&problem, freedom, 0, &()).expect("a model");
            let late = (found.delay - part).abs();
            println!("pole {pole}, delay {part:.1}: {late:.6} samples");
            assert!(late < 1e-4, "pole {pole}: {} for {part}", found.delay);
        }
    }
}

/// Behind noise of a thousandth, where a whole delay beside that of the record would be made up for
/// by a zero, or by a pole more.
#[test]
fn no_zero_and_no_pole_stands_for_a_part_of_a_sample() {
    let u = commands(Hold::Zero);
    let mut draw = Uniform::of(7);
    for poles in [&[-3.0][..], &[-10.0], &[-3.0, -9.0], &[-10.0, -17.0]] {
        for delay in [0.5, 2.5] {
            let b = poles.iter().product::<f64>().abs();
            let mut y = response(&u, Hold::Zero, 0.01, poles, b, delay);
            y.iter_mut().for_each(|y| *y += 1e-3 * draw.normal());
            let signals = Signals::held(0.01, &u, &y);
            let range = Range {
                max_order: 2,
                integrating: false,
                constant: false,
            };
            let freedom = Freedom {
                pole: Choice::Auto,
                delay: Choice::Auto,
            };
            let selection = select(&signals, range, Options::default(), freedom, &());
            let selection = selection.expect("a structure");
            let found = &selection.candidates[selection.recommended];
            let structure = Structure::of_order(poles.len());
            assert_eq!(found.structure, structure, "{poles:?}, delay {delay}");
            let late = (found.compared_delay - delay).abs();
            assert!(
                late < 0.2,
                "{poles:?}: {} for {delay}",
                found.compared_delay
            );
        }
    }
}
