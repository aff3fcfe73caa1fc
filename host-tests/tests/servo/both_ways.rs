//! What rod and load of a cylinder with air make of its velocities both ways.

use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::servo::population::draw::{AxisDraw, Mechanics};
use trendid_host_tests::servo::population::family::Family;

/// Share of the flow of the full command.
const OPENING: f64 = 0.5;
/// Imbalance over the share of supply times area that a constant load is.
const LOADED: f64 = 0.4;
/// Error of the imbalance by that formula, in the rms and the largest.
const ERROR: [f64; 2] = [0.03, 0.08];

/// Mean velocity between 0.3 and 0.7 of the stroke at this opening \[1/s\].
fn velocity(p: &AxisParameters, opening: f64) -> f64 {
    let stroke_mm = 1e3 * p.stroke;
    let parameters = AxisParameters {
        start_mm: stroke_mm * (0.5 - 0.4 * opening.signum()),
        ..*p
    };
    let mut axis = PneumaticAxis::new(&parameters, 1);
    let command = opening + opening.signum() * p.dead_zone - p.offset;
    let mut passed = |share: f64| {
        (0..60_000).find(|_| {
            axis.step(command);
            (axis.position_mm() / stroke_mm - 0.5) * opening.signum() > share
        })
    };
    let _ = passed(-0.2);
    passed(0.2).map_or(0.0, |samples| 400.0 / (samples + 1) as f64)
}

#[test]
fn a_rod_and_a_load_make_an_axis_quicker_one_way_by_as_much_as_is_said() {
    for family in [Family::Pneumatic, Family::SingleRod] {
        let mut squares = 0.0;
        let seeds = 1..=40;
        for seed in seeds.clone() {
            let draw = AxisDraw::new(family, false, seed);
            let Mechanics::Pneumatic(p) = draw.mechanics else {
                panic!("a pneumatic axis");
            };
            let [up, down] = [OPENING, -OPENING].map(|opening| velocity(&p, opening));
            assert!(up > 0.0 && down > 0.0, "{family:?} {seed}");
            let share = p.load / (0.5e5 * p.supply_bar * (p.area_a() + p.area_b()));
            let error = (down - up) / (down + up) - (draw.imbalance() - LOADED * share);
            assert!(error.abs() < ERROR[1], "{family:?} {seed}: {error}");
            squares += error * error;
        }
        let rms = (squares / seeds.count() as f64).sqrt();
        println!("{family:?}: {rms:.4}");
        assert!(rms < ERROR[0], "{family:?}: {rms}");
    }
}
