//! The stated natural frequency, damping and gain of a drive are those of its motion.

use trendid_host_tests::plants::pneumatic::{AxisParameters, Friction, PneumaticAxis};
use trendid_host_tests::plants::third_order::{ThirdOrder, ThirdOrderParameters};
use trendid_host_tests::plants::valve::StaticValve;
use trendid_host_tests::servo::population::draw::{AxisDraw, Mechanics};
use trendid_host_tests::servo::population::family::Family;

/// Natural frequency and damping of a free response, from the instants and heights of its extremes
/// about `rest`.
fn oscillation(samples: &[f64], h: f64, rest: f64) -> [f64; 2] {
    let away: Vec<f64> = samples.iter().map(|x| x - rest).collect();
    let crossings: Vec<f64> = away
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < 0.0 && w[1] >= 0.0)
        .map(|(k, w)| h * (k as f64 + w[0] / (w[0] - w[1])))
        .collect();
    let period = (crossings[3] - crossings[1]) / 2.0;
    let at = |t: f64| (t / h) as usize;
    let peak = |from: f64| {
        away[at(from)..at(from + period)]
            .iter()
            .copied()
            .fold(0.0, f64::max)
    };
    let decay = (peak(crossings[1]) / peak(crossings[2])).ln();
    let damped = std::f64::consts::TAU / period;
    let rate = decay / period;
    let omega0 = (damped * damped + rate * rate).sqrt();
    [omega0, rate / omega0]
}

#[test]
fn the_linearisation_is_that_of_the_free_response() {
    let mut tried = 0;
    for seed in 1..=60 {
        let draw = AxisDraw::new(Family::Pneumatic, false, seed);
        let Mechanics::Pneumatic(p) = draw.mechanics else {
            panic!("a pneumatic axis");
        };
        // A sealed axis that slides, in the middle of its travel; nearly no damping shows no
        // extremes, much shows one.
        let p = AxisParameters {
            friction: Friction {
                viscous: p.friction.viscous,
                ..Friction::NONE
            },
            valve_leakage: 0.0,
            piston_leakage: 0.0,
            dead_zone: 0.5,
            start_mm: 0.5 * draw.stroke_mm(),
            ..p
        };
        let [_, omega0, xi] = draw.truth(p.start_mm);
        if xi > 0.2 {
            continue;
        }
        tried += 1;
        let mut axis = PneumaticAxis::new(&p, 1);
        // A push by a constant force that moves it by a thousandth of the travel.
        let moved = 1e-3 * p.stroke;
        axis.set_load(p.load + p.mass * omega0 * omega0 * moved);
        let h = 0.002 / omega0;
        let samples: Vec<f64> = (0..20_000)
            .map(|_| {
                axis.advance(0.0, h);
                axis.position_mm()
            })
            .collect();
        let [found, damping] = oscillation(&samples, h, p.start_mm + 1e3 * moved);
        // The stiffness at a distance of 1e-3 of the travel differs by as much.
        assert!(
            (found / omega0 - 1.0).abs() < 3e-3,
            "{seed}: {found} {omega0}"
        );
        assert!((damping - xi).abs() < 5e-3, "{seed}: {damping} {xi}");
    }
    assert!(tried > 20, "{tried} axes");
}

#[test]
fn a_drive_of_third_order_has_its_gain_frequency_and_damping() {
    let p = ThirdOrderParameters {
        imbalance: 0.0,
        gain: 800.0,
        omega0: 40.0,
        xi: 0.1,
        leak: 0.0,
        force_max: 1e9,
        load: 0.0,
        friction: Friction::NONE,
        stroke: 1000.0,
        valve: StaticValve::IDEAL,
        spool_frequency: 600.0,
        spool_damping: 0.7,
        start: 100.0,
    };
    let mut drive = ThirdOrder::new(&p);
    for _ in 0..10_000 {
        drive.advance(0.5, 1e-4);
    }
    assert!(
        (drive.velocity_mm_s() - 400.0).abs() < 20.0,
        "a second is 4 of its time constants"
    );
    for (u, speed) in [(0.5, 360.0), (-0.5, -440.0)] {
        let uneven = ThirdOrderParameters {
            imbalance: 0.1,
            start: 500.0,
            ..p
        };
        let mut drive = ThirdOrder::new(&uneven);
        for _ in 0..10_000 {
            drive.advance(u, 1e-4);
        }
        let found = drive.velocity_mm_s();
        assert!((found - speed).abs() < 20.0, "{u}: {found}");
    }
    let mut drive = ThirdOrder::new(&p);
    drive.set_load(1600.0);
    let samples: Vec<f64> = (0..20_000)
        .map(|_| {
            drive.advance(0.0, 5e-5);
            drive.position_mm()
        })
        .collect();
    // A constant load moves a drive with a closed valve by load over stiffness.
    let [omega0, xi] = oscillation(&samples, 5e-5, 101.0);
    assert!((omega0 / 40.0 - 1.0).abs() < 1e-3, "{omega0}");
    assert!((xi - 0.1).abs() < 1e-3, "{xi}");
}
