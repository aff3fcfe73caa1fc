//! The population of axes: ranges, statics, reproducibility; one axis of each family from power-up
//! to rest.

use trendid_host_tests::plants::pneumatic::Friction;
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
        (
            "stated",
            family::STATED_BANDWIDTH,
            draw.stated_bandwidth / omega0,
        ),
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

/// A range widened by the rounding of the few operations that lead from a draw to a property and
/// back.
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
                    if usual && name != "stated" && name != "xi" {
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
