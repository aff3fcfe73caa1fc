//! Delays that are not of whole samples, without noise, from an exact simulation that shares nothing
//! with the library.

use trendid_identify::{Choice, Freedom, Options, Problem, Signals, Structure, identify};

/// `prod (s - p_i) y = b u(t - delay)`, mode by mode: the input changes within the sample.
fn response(u: &[f64], dt: f64, poles: &[f64], b: f64, delay: f64) -> Vec<f64> {
    let (whole, part) = (delay.floor() as usize, delay.fract());
    let at = |k: usize, late: usize| if k < late { 0.0 } else { u[k - late] };
    let mut y = vec![0.0; u.len()];
    for p in poles {
        let others = poles.iter().filter(|q| *q != p);
        let residue = others.fold(b, |residue, q| residue / (p - q));
        let gain = |t: f64| residue * (p * t).exp_m1() / p;
        let mut x = 0.0;
        for (k, y) in y.iter_mut().enumerate() {
            *y += x;
            x = (p * part * dt).exp() * x + gain(part * dt) * at(k, whole + 1);
            let rest = (1.0 - part) * dt;
            x = (p * rest).exp() * x + gain(rest) * at(k, whole);
        }
    }
    y
}

/// Binary commands held for 37 samples, rates up to a twentieth of the sampling.
#[test]
fn a_delay_between_samples_costs_no_accuracy() {
    let dt = 0.01;
    let mut seed = 5_u64;
    let mut level = 0.0;
    let u: Vec<f64> = (0..4000)
        .map(|k| {
            if k % 37 == 0 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                level = if seed >> 63 == 0 { -1.0 } else { 1.0 };
            }
            level
        })
        .collect();
    let mut largest = [0.0_f64; 4];
    for order in 1..=3 {
        for tenths in 1..=9 {
            let delay = 3.0 + 0.1 * f64::from(tenths);
            let poles: Vec<f64> = [-3.0, -5.0, -9.0][..order].to_vec();
            let (mut a, b) = (vec![1.0], 2.0);
            for p in &poles {
                a.insert(0, 0.0);
                for i in 0..a.len() - 1 {
                    a[i] -= p * a[i + 1];
                }
            }
            let b = b * a[0];
            let y = response(&u, dt, &poles, b, delay);
            let signals = Signals::held(dt, &u, &y);
            let structure = Structure {
                order,
                integrator: false,
                zeros: 0,
                constant: false,
            };
            let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
            let freedom = Freedom {
                pole: Choice::Auto,
                delay: Choice::Auto,
            };
            let found = identify(&problem, freedom, 0, &()).expect("a model");
            let truth = a[..order].iter().chain([&b]);
            let off = truth
                .zip(&found.estimate.theta)
                .map(|(truth, found)| (found / truth - 1.0).abs());
            let off = off.fold(0.0, f64::max);
            let late = (found.delay - delay).abs();
            largest[order] = largest[order].max(off);
            largest[0] = largest[0].max(late);
            println!(
                "order {order}, delay {delay}: {:.4} %, {late:.4} samples",
                100.0 * off
            );
        }
    }
    println!("largest: {largest:?}");
    assert!(largest[1..].iter().all(|off| *off <= 5e-4) && largest[0] < 0.01);
}
