//! The pneumatic axis: convergence, rest, end stops, sensor, faults and its linear model.

use trendid_host_tests::excitation::Excitation;
use trendid_host_tests::oracle::{InputTerms, Regression, Structure, least_squares};
use trendid_host_tests::pneumatic::{Axis, AxisParameters, Fault, Friction};
use trendid_host_tests::polynomial::monic;
use trendid_host_tests::trends::{Hold, Scheme};

const SERVO: AxisParameters = AxisParameters::SERVO;

fn binary(amplitude: f64, n: usize, seed: u64) -> Vec<f64> {
    Excitation::Prbs {
        amplitude,
        hold_s: 0.04,
        bits: 11,
    }
    .sequence(n, 1e-3, seed)
}

/// True positions \[mm\] under binary noise.
fn course(p: &AxisParameters, amplitude: f64, n: usize) -> Vec<f64> {
    let mut axis = Axis::new(p, 1);
    binary(amplitude, n, 7)
        .into_iter()
        .map(|u| {
            axis.step(u);
            axis.position_mm()
        })
        .collect()
}

/// Largest differences \[mm\] of courses with 10, 20 and 40 steps per sample from one with 320.
fn step_errors(p: &AxisParameters, amplitude: f64) -> [f64; 3] {
    let with = |substeps| course(&AxisParameters { substeps, ..*p }, amplitude, 5000);
    let fine = with(320);
    [10, 20, 40].map(|n| {
        with(n)
            .iter()
            .zip(&fine)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    })
}

#[test]
fn halving_the_step_changes_nothing_that_matters() {
    // Stop, start and stick many times; the full command also strikes both end stops. The bound of 1 um is a tenth of the
    // sensor's resolution.
    for (name, p, amplitude) in [
        ("small motion", SERVO, 0.1),
        ("tracking", SERVO, 0.3),
        ("full command", SERVO, 1.0),
        (
            "full command, rod",
            AxisParameters {
                rod: 0.012,
                ..SERVO
            },
            1.0,
        ),
    ] {
        let [e10, e20, e40] = step_errors(&p, amplitude);
        println!("{name}: {e10:.1e} {e20:.1e} {e40:.1e} mm with 10, 20, 40 steps per sample");
        assert_eq!(p.substeps, 20);
        assert!(e20 < 1e-3, "{name}: {e20} mm");
        assert!(e40 < e20 && e20 < e10, "{name}: does not converge");
    }
    let full = course(&SERVO, 1.0, 5000);
    assert!(full.contains(&0.0) && full.contains(&400.0));
}

#[test]
fn rests_exactly_and_starts_only_beyond_the_dead_zone() {
    let mut axis = Axis::new(&SERVO, 1);
    for k in 0..2000 {
        axis.step(if k % 2 == 0 { 0.03 } else { -0.03 });
    }
    assert_eq!(axis.position_mm(), SERVO.start_mm);
    // Moved away and stopped, it holds its place although the pressures still differ.
    for _ in 0..200 {
        axis.step(0.4);
    }
    for _ in 0..1000 {
        axis.step(0.0);
    }
    let stopped = axis.position_mm();
    assert!(stopped > SERVO.start_mm + 50.0);
    assert!(axis.force() != 0.0);
    for _ in 0..10_000 {
        axis.step(0.0);
        assert_eq!(axis.position_mm(), stopped);
    }
    // Just outside the dead zone the pressure difference builds up until the axis breaks away.
    let mut samples = 0;
    while axis.position_mm() == stopped {
        axis.step(0.04);
        samples += 1;
        assert!(samples < 5000, "the axis does not start");
    }
    println!("breaks away after {samples} ms at 0.04");
    assert!(axis.velocity_mm_s() > 0.0);
}

#[test]
fn offset_shifts_the_dead_zone() {
    let mut axis = Axis::new(
        &AxisParameters {
            offset: 0.02,
            ..SERVO
        },
        1,
    );
    for (command, opening) in [(0.005, 0.0), (-0.045, 0.0), (0.11, 0.1), (-0.15, -0.1)] {
        for _ in 0..50 {
            axis.step(command);
        }
        assert!((axis.opening() - opening).abs() < 1e-9, "{command}");
    }
}

#[test]
fn stays_between_the_stops_whatever_the_command() {
    let mut axis = Axis::new(&SERVO, 1);
    let steps = Excitation::Steps {
        amplitude: 3.0,
        hold_s: 0.07,
    }
    .sequence(60_000, 1e-3, 5);
    for (k, u) in steps.into_iter().enumerate() {
        match k {
            10_000 => axis.set_mass(15.0),
            20_000 => axis.set_supply(4.0),
            30_000 => axis.set_valve_gain(0.7),
            40_000 => axis.set_friction_scale(2.0),
            50_000 => axis.set_valve_null(0.05, -0.02),
            _ => {}
        }
        axis.step(u);
        let x = axis.position_mm();
        assert!((0.0..=400.0).contains(&x), "{x} mm at sample {k}");
        for p in axis.pressures_bar() {
            assert!((0.9..30.0).contains(&p), "{p} bar at sample {k}");
        }
    }
}

#[test]
fn sensor_has_the_stated_noise_and_resolution() {
    let mut axis = Axis::new(&SERVO, 1);
    let n = 20_000;
    let (mut mean, mut square) = (0.0, 0.0);
    for _ in 0..n {
        let counts = axis.measure_counts();
        let error = f64::from(counts) * 0.01 - axis.position_mm();
        // Noise of 10 um and half a count.
        assert!(error.abs() <= 0.015 + 1e-9, "{error} mm");
        mean += error / f64::from(n);
        square += error * error / f64::from(n);
    }
    // On a count exactly, +-10 um of noise give -1, 0, 1 with 1/4, 1/2, 1/4: a variance of half a count squared.
    assert!(mean.abs() < 3e-4, "mean {mean} mm");
    assert!((square / 5e-5 - 1.0).abs() < 0.05, "variance {square} mm2");
    let (mut a, mut b, mut c) = (
        Axis::new(&SERVO, 9),
        Axis::new(&SERVO, 9),
        Axis::new(&SERVO, 10),
    );
    let course = |axis: &mut Axis| -> Vec<f64> { (0..50).map(|_| axis.measure()).collect() };
    let first = course(&mut a);
    assert_eq!(first, course(&mut b));
    assert_ne!(first, course(&mut c));
}

#[test]
fn faults_do_what_they_say() {
    let moved = |fault: Option<Fault>| {
        let mut axis = Axis::new(&SERVO, 1);
        for _ in 0..100 {
            axis.step(0.2);
        }
        let (x, shown) = (axis.position_mm(), axis.measure());
        axis.set_fault(fault);
        for _ in 0..300 {
            axis.step(0.2);
        }
        (axis.position_mm() - x, axis.measure() - shown, axis)
    };
    let (healthy, shown, _) = moved(None);
    assert!(healthy > 30.0 && (shown - healthy).abs() < 0.04);
    let (x, shown, mut axis) = moved(Some(Fault::StuckSensor));
    assert!(x == healthy && shown == 0.0);
    axis.set_fault(None);
    assert!((axis.measure() - axis.position_mm()).abs() < 0.02);
    let (x, _, mut axis) = moved(Some(Fault::BlockedAxis));
    assert!(x == 0.0 && axis.velocity_mm_s() == 0.0);
    // A blocked axis builds up the full pressure difference and shoots off when it is freed.
    assert!(axis.force() > 100.0);
    axis.set_fault(None);
    axis.step(0.0);
    assert!(axis.velocity_mm_s() > 0.0);
    let (x, _, _) = moved(Some(Fault::WrongSign));
    assert!(x < -20.0, "{x}");
    let (_, _, mut axis) = moved(Some(Fault::StuckValve));
    let spool = axis.spool();
    axis.step(-1.0);
    assert_eq!(axis.spool(), spool);
}

/// Identified C \[mm/s\], omega0 \[rad/s\], xi, and the mean opening of the valve, from 2 s in closed loop with binary noise.
///
/// Least squares of the f64 oracle on filtered trends. The inputs are the command beyond the dead zone, delayed by the
/// spool, the direction of motion (friction) and a constant.
fn identified(p: &AxisParameters, amplitude: f64, seed: u64) -> ([f64; 3], f64) {
    let mut axis = Axis::new(p, seed);
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
    let linear = Axis::new(p, seed).linearised(p.start_mm, opening);
    [
        gain / linear.gain - 1.0,
        omega0 / linear.omega0 - 1.0,
        xi - linear.xi,
    ]
}

#[test]
fn linear_model_is_exact_for_small_motions() {
    // Without dry friction, dead zone and noise only the residual delay of the spool (0.2 ms) and the amplitude remain.
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
fn linear_model_describes_the_full_axis() {
    // Large motions with sticking, dead zone and noise: the plant changes along the way and the sliding model leaves out the
    // Stribeck curve. Stated tolerance of the mean over the seeds: C 10 %, omega0 5 %, xi 0.06.
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
    println!("seeds {seeds:?}");
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
        println!("{name}: mean errors {mean:.3?}, rms {rms:.3?}");
        assert!(
            mean[0].abs() < 0.10 && mean[1].abs() < 0.05 && mean[2].abs() < 0.06,
            "{name}: mean errors {mean:?} of C, omega0, xi"
        );
    }
}

#[test]
fn linear_model_is_a_realistic_servo() {
    let axis = Axis::new(&SERVO, 1);
    println!("position, C, omega0, xi with the valve closed; with a mean opening of 0.3");
    for k in 0..=8 {
        let x = 50.0 * f64::from(k);
        let (closed, open) = (axis.linearised(x, 0.0), axis.linearised(x, 0.3));
        println!(
            "{x:5} mm: {:.0} mm/s {:.1} rad/s {:.3}; {:.0} {:.1} {:.3}",
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

#[test]
#[should_panic(expected = "bore")]
fn refuses_nonsense() {
    let _ = Axis::new(&AxisParameters { bore: 0.0, ..SERVO }, 1);
}
