//! The pneumatic axis: convergence, rest, end stops, sensor and faults.

use trendid_host_tests::plants::pneumatic::{AxisParameters, Fault, PneumaticAxis};
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

/// True positions \[mm\] under binary noise.
fn course(p: &AxisParameters, amplitude: f64, n: usize) -> Vec<f64> {
    let mut axis = PneumaticAxis::new(p, 1);
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
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn halving_the_step_changes_nothing_that_matters() {
    // Stop, start and stick many times; the full command also strikes both end stops. The bound of
    // 1 um is a tenth of the sensor's resolution.
    println!("| binary noise | 10 steps | 20 steps | 40 steps |\n|---|---|---|---|");
    for (name, p, amplitude) in [
        ("+-0.1", SERVO, 0.1),
        ("+-0.3", SERVO, 0.3),
        ("+-1, both end stops struck", SERVO, 1.0),
        (
            "+-1, with a rod",
            AxisParameters {
                rod: 0.012,
                ..SERVO
            },
            1.0,
        ),
    ] {
        let [e10, e20, e40] = step_errors(&p, amplitude);
        let [um10, um20, um40] = [e10, e20, e40].map(|error| 1e3 * error);
        println!("| {name} | {um10:.3} um | {um20:.3} um | {um40:.3} um |");
        assert_eq!(p.substeps, 20);
        assert!(e20 < 1e-3, "{name}: {e20} mm");
        assert!(e40 < e20 && e20 < e10, "{name}: does not converge");
    }
    let full = course(&SERVO, 1.0, 5000);
    assert!(full.contains(&0.0) && full.contains(&400.0));
}

#[test]
fn rests_exactly_and_starts_only_beyond_the_dead_zone() {
    let mut axis = PneumaticAxis::new(&SERVO, 1);
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
    let mut axis = PneumaticAxis::new(
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
    let mut axis = PneumaticAxis::new(&SERVO, 1);
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
    let mut axis = PneumaticAxis::new(&SERVO, 1);
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
    // On a count exactly, +-10 um of noise give -1, 0, 1 with 1/4, 1/2, 1/4: a variance of half a
    // count squared.
    assert!(mean.abs() < 3e-4, "mean {mean} mm");
    assert!((square / 5e-5 - 1.0).abs() < 0.05, "variance {square} mm2");
    let (mut a, mut b, mut c) = (
        PneumaticAxis::new(&SERVO, 9),
        PneumaticAxis::new(&SERVO, 9),
        PneumaticAxis::new(&SERVO, 10),
    );
    let course =
        |axis: &mut PneumaticAxis| -> Vec<f64> { (0..50).map(|_| axis.measure()).collect() };
    let first = course(&mut a);
    assert_eq!(first, course(&mut b));
    assert_ne!(first, course(&mut c));
}

#[test]
fn faults_do_what_they_say() {
    let moved = |fault: Option<Fault>| {
        let mut axis = PneumaticAxis::new(&SERVO, 1);
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

#[test]
#[should_panic(expected = "bore")]
fn refuses_nonsense() {
    let _ = PneumaticAxis::new(&AxisParameters { bore: 0.0, ..SERVO }, 1);
}
