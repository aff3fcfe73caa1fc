//! The linear model of the pneumatic axis against identifications by the f64 oracle.

use trendid_host_tests::oracles::least_squares::{
    InputTerms, Regression, Structure, least_squares,
};
use trendid_host_tests::oracles::trends::{Hold, Scheme};
use trendid_host_tests::plants::pneumatic::{AxisParameters, Friction, PneumaticAxis};
use trendid_host_tests::plants::polynomial::monic;
use trendid_host_tests::signals::excitation::Excitation;

const SERVO: AxisParameters = AxisParameters::SERVO;

fn binary(amplitude: f64, n: usize, seed: u64) -> Vec<f64> {
    Excitation::Prbs {
        amplitude,
        hold_s: 0.04,
        bits: 11,
    }
    .sequence(n, 1e-3, seed)
}

/// Identified C \[mm/s\], omega0 \[rad/s\], xi, and the mean opening of the valve, from 2 s in
/// closed loop with binary noise.
///
/// Least squares of the f64 oracle on filtered trends. The inputs are the command beyond the dead
/// zone, delayed by the spool, the direction of motion (friction) and a constant.
fn identified(p: &AxisParameters, amplitude: f64, seed: u64) -> ([f64; 3], f64) {
    let mut axis = PneumaticAxis::new(p, seed);
    let n = 2000;
    let (mut u, mut y, mut direction) = (Vec::new(), Vec::new(), Vec::new());
    let mut opening = 0.0;
    for r in binary(amplitude, n, seed) {
        let measured = axis.measure() - p.start_mm;
        let command: f64 = r - 0.002 * measured;
        y.push(measured);
        u.push((command.abs() - p.dead_zone).max(0.0) * command.signum());
        let v = axis.velocity_mm_s();
        direction.push(if v == 0.0 { 0.0 } else { v.signum() });
        axis.step(command);
        opening += axis.opening().abs() / n as f64;
    }
    let input = |b: &[usize], delay| InputTerms {
        b: b.to_vec(),
        delay,
        hold: Hold::Zero,
    };
    let mut structure = Structure {
        m: 3,
        a: vec![1, 2],
        inputs: vec![input(&[0], 2)],
        constant: true,
    };
    let mut inputs: Vec<&[f64]> = vec![&u];
    if p.friction.coulomb > 0.0 {
        structure.inputs.push(input(&[0, 1], 0));
        inputs.push(&direction);
    }
    let filter = monic(&[30.0; 3]);
    let rows = Regression::new(&structure, Scheme::Tustin, Some(&filter), 1e-3, &inputs, &y);
    let theta = least_squares(&rows.phi, &rows.target, None)
        .expect("an excited record")
        .theta;
    let (a1, a2, b0) = (theta[0], theta[1], theta[2]);
    ([b0 / a1, a1.sqrt(), 0.5 * a2 / a1.sqrt()], opening)
}

/// Relative errors of C and omega0 and absolute error of xi against the linear model.
fn against_linear(p: &AxisParameters, amplitude: f64, seed: u64) -> [f64; 3] {
    let ([gain, omega0, xi], opening) = identified(p, amplitude, seed);
    let linear = PneumaticAxis::new(p, seed).linearised(p.start_mm, opening);
    [
        gain / linear.gain - 1.0,
        omega0 / linear.omega0 - 1.0,
        xi - linear.xi,
    ]
}

#[test]
fn linear_model_is_exact_for_small_motions() {
    // Without dry friction, dead zone and noise only the residual delay of the spool (0.2 ms) and
    // the amplitude remain.
    let smooth = AxisParameters {
        friction: Friction {
            coulomb: 0.0,
            breakaway: 0.0,
            ..Friction::SEALS
        },
        dead_zone: 0.0,
        sensor_noise_mm: 0.0,
        resolution_mm: 1e-6,
        ..SERVO
    };
    for start_mm in [60.0, 130.0, 200.0, 300.0] {
        let p = AxisParameters { start_mm, ..smooth };
        let [gain, omega0, xi] = against_linear(&p, 0.01, 3);
        println!("{start_mm} mm: C {gain:+.4}, omega0 {omega0:+.4}, xi {xi:+.4}");
        assert!(gain.abs() < 0.01 && omega0.abs() < 0.01 && xi.abs() < 0.01);
    }
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn linear_model_describes_the_full_axis() {
    // Large motions with sticking, dead zone and noise: the plant changes along the way and the
    // sliding model leaves out the Stribeck curve. Stated tolerance of the mean over the seeds: C
    // 10 %, omega0 5 %, xi 0.06.
    let cases = [
        ("middle", SERVO),
        (
            "100 mm",
            AxisParameters {
                start_mm: 100.0,
                ..SERVO
            },
        ),
        (
            "15 kg",
            AxisParameters {
                mass: 15.0,
                ..SERVO
            },
        ),
        (
            "4 bar",
            AxisParameters {
                supply_bar: 4.0,
                ..SERVO
            },
        ),
        (
            "valve gain 0.7",
            AxisParameters {
                valve_gain: 0.7,
                ..SERVO
            },
        ),
    ];
    let seeds = 1..=100_u64;
    println!(
        "| case | C | omega0 | xi | rms C | rms omega0 | rms xi |\n|---|---|---|---|---|---|---|"
    );
    for (name, p) in cases {
        let (mut mean, mut square) = ([0.0; 3], [0.0; 3]);
        for seed in seeds.clone() {
            let error = against_linear(&p, 0.3, seed);
            for i in 0..3 {
                mean[i] += error[i] / 100.0;
                square[i] += error[i] * error[i] / 100.0;
            }
        }
        let rms = square.map(f64::sqrt);
        println!(
            "| {name} | {:+.1} % | {:+.1} % | {:+.3} | {:.1} % | {:.1} % | {:.3} |",
            100.0 * mean[0],
            100.0 * mean[1],
            mean[2],
            100.0 * rms[0],
            100.0 * rms[1],
            rms[2]
        );
        assert!(
            mean[0].abs() < 0.10 && mean[1].abs() < 0.05 && mean[2].abs() < 0.06,
            "{name}: mean errors {mean:?} of C, omega0, xi"
        );
    }
}

#[test]
fn linear_model_is_a_realistic_servo() {
    let axis = PneumaticAxis::new(&SERVO, 1);
    println!(
        "| position [mm] | C [mm/s] | omega0 [rad/s] | xi | with mean opening 0.3: C | omega0 | xi |"
    );
    println!("|---|---|---|---|---|---|---|");
    for k in 0..=8 {
        let x = 50.0 * f64::from(k);
        let (closed, open) = (axis.linearised(x, 0.0), axis.linearised(x, 0.3));
        println!(
            "| {x} | {:.0} | {:.1} | {:.3} | {:.0} | {:.1} | {:.3} |",
            closed.gain, closed.omega0, closed.xi, open.gain, open.omega0, open.xi
        );
        assert!((1500.0..2500.0).contains(&closed.gain));
        if (20.0..=380.0).contains(&x) {
            assert!((20.0..60.0).contains(&closed.omega0));
        }
    }
    // Sonic exhaust makes the gain independent of the supply; the stiffness follows the pressure.
    let mut low = axis.clone();
    low.set_supply(4.0);
    let (a, b) = (axis.linearised(200.0, 0.0), low.linearised(200.0, 0.0));
    assert!(
        (b.gain / a.gain - 1.0).abs() < 0.03,
        "{} {}",
        a.gain,
        b.gain
    );
    assert!(b.omega0 < 0.9 * a.omega0);
    let mut heavy = axis.clone();
    heavy.set_mass(15.0);
    let ratio = heavy.linearised(200.0, 0.0).omega0 / a.omega0;
    assert!((ratio - (1.0_f64 / 3.0).sqrt()).abs() < 1e-12);
}
