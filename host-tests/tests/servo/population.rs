//! The population of axes: ranges, statics, reproducibility, linearisation; one axis of each family from power-up to rest.

use trendid_host_tests::plants::pneumatic::{AxisParameters, Friction, PneumaticAxis};
use trendid_host_tests::plants::third_order::{ThirdOrder, ThirdOrderParameters};
use trendid_host_tests::plants::valve::StaticValve;
use trendid_host_tests::servo::population::adaptive::PATIENCE;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::{AxisDraw, Mechanics};
use trendid_host_tests::servo::population::family::{self, Family};
use trendid_host_tests::servo::population::range::{Purpose, Range, Spread};
use trendid_host_tests::servo::population::summary::Summary;
use trendid_host_tests::servo::population::trial::{Trial, with_loop};

/// Every drawn quantity of an axis with its range.
fn drawn(draw: &AxisDraw) -> Vec<(&'static str, Range, f64)> {
    let family = draw.family;
    let length = draw.stroke_mm();
    let [_, omega0, xi] = draw.truth(0.5 * length);
    let [dead_zone, offset] = draw.valve_null();
    let hz = |w: f64| w / std::f64::consts::TAU;
    let mut values = vec![
        ("stroke", family::STROKE, length),
        ("omega0", family.omega0(), omega0),
        ("xi", family.xi(), xi),
        ("dead zone", family.dead_zone(), dead_zone),
        ("offset", family.offset(), offset),
        ("dead time", family::DEAD_TIME, draw.dead_time),
        ("resolution", family::RESOLUTION, draw.resolution_mm),
        ("noise", family::NOISE, draw.noise_mm),
        ("jitter", family::JITTER, draw.jitter),
        ("missed", family::MISSED, draw.missed),
        ("told", family::TOLD_BANDWIDTH, draw.told_bandwidth / omega0),
    ];
    match &draw.mechanics {
        Mechanics::Pneumatic(p) => values.extend([
            ("bore", family::BORE, p.bore),
            ("mass", family::MASS, p.mass),
            ("supply", family::SUPPLY, p.supply_bar),
            ("leak", family::LEAK, p.valve_leakage),
            ("leak", family::LEAK, p.piston_leakage),
            ("dead volume", family::DEAD_VOLUME, p.dead_length / p.stroke),
            ("start", family::START, p.start_mm / length),
            ("valve", family.valve_hz(), hz(p.spool_frequency)),
            ("gravity", family::GRAVITY, p.load / (9.806_65 * p.mass)),
            (
                "friction",
                family.friction(),
                p.friction.coulomb * 0.032 / (Friction::SEALS.coulomb * p.bore),
            ),
            (
                "viscous",
                family::VISCOUS,
                p.friction.viscous * 0.032 / (Friction::SEALS.viscous * p.bore),
            ),
            (
                "breakaway",
                family::BREAKAWAY,
                p.friction.breakaway / p.friction.coulomb,
            ),
        ]),
        Mechanics::ThirdOrder(p) => values.extend([
            ("start", family::START, p.start / length),
            ("valve", family.valve_hz(), hz(p.spool_frequency)),
        ]),
    }
    values
}

/// A range widened by the rounding of the few operations that lead from a draw to a property and back.
fn rounded(range: Range) -> Range {
    let slack = 1e-12 * range.low.abs().max(range.high.abs());
    Range {
        low: range.low - slack,
        high: range.high + slack,
        ..range
    }
}

#[test]
fn every_axis_is_within_the_ranges_and_holds_its_load() {
    for family in Family::ALL {
        for seed in 1..=400 {
            for usual in [false, true] {
                let draw = AxisDraw::new(family, usual, seed);
                for (name, range, value) in drawn(&draw) {
                    let whole = rounded(range);
                    assert!(
                        whole.contains(value),
                        "{} {seed}: {name} {value}",
                        family.name()
                    );
                    if usual && name != "told" && name != "xi" {
                        let half = rounded(range.usual());
                        assert!(half.contains(value), "usual {seed}: {name} {value}");
                    }
                }
                if let Mechanics::Pneumatic(p) = &draw.mechanics {
                    let holds = p.load.abs() + p.friction.breakaway;
                    let area = 0.25 * std::f64::consts::PI * p.bore * p.bore;
                    assert!(holds <= 0.4 * 1e5 * p.supply_bar * area, "seed {seed}");
                }
                let limits = draw.limits();
                assert!(limits.velocity > 0.0 && limits.acceleration > 0.0 && limits.jerk > 0.0);
                assert!(family::SAMPLE_TIMES.contains(&draw.sample_time));
            }
        }
    }
}

#[test]
fn ranges_are_used_from_end_to_end() {
    let draws: Vec<AxisDraw> = (1..=400)
        .map(|seed| AxisDraw::new(Family::Linear, false, seed))
        .collect();
    let names: Vec<&str> = drawn(&draws[0]).iter().map(|d| d.0).collect();
    for (i, name) in names.iter().enumerate() {
        let parts: Vec<f64> = draws
            .iter()
            .map(|draw| {
                let (_, range, value) = drawn(draw)[i];
                match range.spread {
                    Spread::Even => (value - range.low) / (range.high - range.low),
                    Spread::Ratio => (value / range.low).ln() / (range.high / range.low).ln(),
                }
            })
            .collect();
        let low = parts.iter().copied().fold(1.0, f64::min);
        let high = parts.iter().copied().fold(0.0, f64::max);
        assert!(low < 0.03 && high > 0.97, "{name}: {low} to {high}");
    }
    let reversed = draws.iter().filter(|d| d.reversed).count();
    assert!((150..=250).contains(&reversed), "{reversed} of 400");
}

#[test]
fn a_seed_gives_the_same_axis_and_another_seed_another() {
    for family in Family::ALL {
        let draw = AxisDraw::new(family, false, 7);
        assert_eq!(draw, AxisDraw::new(family, false, 7));
        assert_ne!(
            draw.stroke_mm(),
            AxisDraw::new(family, false, 8).stroke_mm()
        );
    }
    // The bits of one axis, on every machine.
    let draw = AxisDraw::new(Family::Linear, false, 200_001);
    let Mechanics::ThirdOrder(p) = draw.mechanics else {
        panic!("a drive of third order");
    };
    let bits = [p.stroke, p.omega0, p.xi, p.gain, draw.resolution_mm].map(f64::to_bits);
    assert_eq!(bits, BITS, "{bits:?}");
}

/// Travel, natural frequency, damping, gain and resolution of the linear axis of seed 200001.
const BITS: [u64; 5] = [
    4642055166884117616,
    4620881424951858607,
    4602816830201902498,
    4639587772714702059,
    4570295268129488093,
];

/// Natural frequency and damping of a free response, from the instants and heights of its extremes about `rest`.
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
        // A sealed axis that slides, in the middle of its travel; nearly no damping shows no extremes, much shows one.
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

#[test]
fn commands_arrive_after_the_dead_time_and_samples_come_late_or_not_at_all() {
    let mut draw = AxisDraw::new(Family::Linear, false, 1);
    (draw.dead_time, draw.jitter, draw.missed) = (0.02, 0.1, 0.2);
    (draw.noise_mm, draw.reversed, draw.sample_time) = (0.0, false, 1e-3);
    let Mechanics::ThirdOrder(p) = &mut draw.mechanics else {
        panic!("a drive of third order");
    };
    (p.valve, p.start) = (StaticValve::IDEAL, 0.5 * p.stroke);
    let start = p.start;
    let mut bench = Bench::new(&draw, Purpose::Disturbance);
    let (mut gaps, mut before) = (Vec::new(), 0.0);
    while bench.time() < 0.02 {
        assert_eq!(bench.position_mm(), start);
        bench.hold(1.0);
        gaps.push(bench.time() - before);
        before = bench.time();
    }
    for _ in 0..200 {
        bench.hold(0.2);
    }
    assert!(bench.position_mm() > start);
    assert!(gaps.iter().any(|gap| *gap > 1.9e-3), "a slot was missed");
    assert!(gaps.iter().all(|gap| *gap > 0.89e-3 && *gap < 2.11e-3));
}

#[test]
fn one_axis_of_each_family_runs_through() {
    for family in Family::ALL {
        let trial = Trial::run(family, true, 11);
        // The practitioner always arrives; the loop is accepted or says why not.
        assert!(trial.practitioner.alive && trial.practitioner.rest_range_mm.is_some());
        let summary = Summary::new(std::slice::from_ref(&trial));
        let refused: usize = summary.commissioning.refused.values().sum();
        let accepted = trial.adaptive.commissioned.verified_s;
        assert_eq!(refused, usize::from(accepted.is_none()));
        assert!(accepted.is_none_or(|t| t > 0.0 && t < PATIENCE + 0.01));
        assert_eq!(trial.adaptive.motion.is_some(), accepted.is_some());
        assert_eq!(
            with_loop(&trial.axis, true),
            trial.adaptive,
            "{}",
            family.name()
        );
    }
}
