//! Faults of sensor, valve and axis under a loop in control, and work without any.

use trendid::servo::{Model, State};
use trendid_host_tests::servo::faults::fault::Fault;
use trendid_host_tests::servo::faults::machine::Machine;
use trendid_host_tests::servo::faults::normal::{controlled, work};
use trendid_host_tests::servo::faults::trial::{Situation, prepare, run};
use trendid_host_tests::servo::population::family::Family;

/// Situations in which a model controls without a commissioning before.
const CONTROL: [Situation; 4] = [
    Situation::Rest,
    Situation::Motion,
    Situation::FixedGains,
    Situation::Frozen,
];

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn every_fault_is_noticed_for_its_reason() {
    let (mut runs, mut wrong) = (0, Vec::new());
    for axis in controlled(Family::Pneumatic, true, 1, 4) {
        for situation in CONTROL {
            for fault in Fault::ALL {
                let Some(run) = run(&axis, situation, fault) else {
                    continue;
                };
                runs += 1;
                assert!(
                    run.stopped.is_some() || fault.is_borne(),
                    "not noticed: {run:?}"
                );
                if !run.right {
                    wrong.push(run);
                }
            }
        }
    }
    assert!(runs > 200, "{runs} runs");
    assert!(20 * wrong.len() <= runs, "{wrong:#?}");
}

/// Share of the axes that are driven against an end all the same, and of the reasons that are
/// right. What an axis drifts with its valve in the middle does not count.
const STRUCK: f64 = 0.15;
const RIGHT: f64 = 0.95;

#[test]
fn a_sign_that_changes_while_levels_are_drawn_is_noticed_before_an_end() {
    for fault in [Fault::ReversedValve, Fault::SensorSign] {
        let (mut runs, mut struck, mut right) = (0, 0, 0);
        for axis in controlled(Family::Pneumatic, false, 1, 60) {
            let Some(run) = run(&axis, Situation::Commissioning, fault) else {
                continue;
            };
            runs += 1;
            struck += u32::from(run.noticed_mm_s > 50.0 && run.physics_mm_s < 50.0);
            right += u32::from(run.right);
        }
        println!(
            "{}: {struck} of {runs} are driven against it, {right} right",
            fault.name()
        );
        let share = |count: u32| f64::from(count) / f64::from(runs);
        assert!(runs >= 50 && share(struck) < STRUCK && share(right) >= RIGHT);
    }
}

/// Why both may be called a wrong sign: by the position a supply that is lost is a reversed valve,
/// at first.
#[test]
fn a_lost_supply_moves_the_axis_as_a_reversed_valve_does() {
    let (mut alike, mut runs) = (0, 0);
    for axis in controlled(Family::Pneumatic, true, 1, 20) {
        let Some(sound) = prepare(&axis, Situation::Motion) else {
            continue;
        };
        let mut machines = [sound.clone(), sound.clone(), sound];
        machines[1].break_down(Fault::LostSupply);
        machines[2].break_down(Fault::ReversedValve);
        let (mut product, mut squares) = (0.0, [0.0, 0.0]);
        for _ in 0..(0.15 / axis.sample_time) as usize {
            let [x, lost, reversed] = machines.each_mut().map(|machine| {
                let _ = machine.step();
                machine.bench.position_mm()
            });
            let (lost, reversed) = (lost - x, reversed - x);
            product += lost * reversed;
            squares = [squares[0] + lost * lost, squares[1] + reversed * reversed];
        }
        let correlation = product / (squares[0] * squares[1]).sqrt();
        println!("seed {}: correlation {correlation:.3}", axis.seed);
        runs += 1;
        alike += usize::from(correlation > 0.9);
    }
    assert!(runs >= 15 && 4 * alike >= 3 * runs, "{alike} of {runs}");
}

#[test]
fn normal_work_raises_no_alarm() {
    let mut worked = 0.0;
    for axis in controlled(Family::Linear, true, 1, 10)
        .into_iter()
        .chain(controlled(Family::BallScrew, true, 1, 10))
    {
        let Some(run) = work(&axis, 15.0) else {
            panic!("seed {} has no loop", axis.seed);
        };
        assert_eq!(run.stopped, None, "{run:?}");
        assert_eq!(run.implausible, 0, "{run:?}");
        worked += run.worked_s;
    }
    assert!(worked >= 300.0);
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn a_slow_motion_of_a_quick_drive_takes_no_other_model() {
    // Faster than their observers: what these get wrong of a flow that nobody knows once passed for
    // a gain of two thirds, which led one of these axes to an end of its travel.
    for axis in controlled(Family::Hydraulic, false, 1030, 12) {
        let Some(run) = work(&axis, 120.0) else {
            panic!("seed {} has no loop", axis.seed);
        };
        assert_eq!((run.stopped, run.far_s), (None, [0.0; 2]), "{run:?}");
    }
}

#[test]
fn a_spike_moves_nothing() {
    for axis in controlled(Family::Pneumatic, true, 1, 3) {
        let Some(mut machine) = Machine::new(&axis, true, true) else {
            panic!("seed {} has no loop", axis.seed);
        };
        machine.pass(1.0);
        let mut replaced = machine.step().faults.implausible_readings;
        let before = machine.bench.position_mm();
        // Beside a machine that has none: friction lets both creep.
        let mut quiet = machine.clone();
        machine.break_down(Fault::Spikes);
        let (mut moved, mut crept) = (0.0_f64, 0.0_f64);
        for _ in 0..2000 {
            let report = machine.step();
            assert!(report.state.is_controlling(), "{}", report.state);
            replaced = report.faults.implausible_readings;
            let _ = quiet.step();
            moved = moved.max((machine.bench.position_mm() - before).abs());
            crept = crept.max((quiet.bench.position_mm() - before).abs());
        }
        assert_eq!(replaced, 20, "one of a hundred readings");
        assert!(
            moved <= crept + axis.cycle_mm(),
            "seed {}: {moved} mm, without {crept} mm",
            axis.seed
        );
    }
}

/// A fifth of the true gain: the loop is five times as strong as it thinks.
#[test]
fn an_oscillation_is_noticed_and_slowed() {
    let mut noticed = 0;
    for axis in controlled(Family::Pneumatic, true, 1, 4) {
        let Some(mut machine) = Machine::new(&axis, false, true) else {
            panic!("seed {} has no loop", axis.seed);
        };
        machine.pass(0.5);
        let Some(good) = machine.servo.supervisor().verified_model() else {
            panic!("no model");
        };
        let model = Model {
            b0: 0.2 * good.b0,
            ..good
        };
        if machine.servo.install(model).is_err() {
            continue;
        }
        let _ = machine.servo.move_to((0.5 * axis.stroke_mm()) as f32);
        machine.pass(8.0);
        let report = machine.step();
        let stopped = matches!(report.state, State::Failed(_));
        if report.faults.oscillations > 0 {
            noticed += 1;
            assert!(report.faults.derating < 1.0);
        } else {
            assert!(stopped || machine.bench.blow_mm_s < 50.0);
        }
    }
    assert!(noticed > 0, "no loop of five times its gain oscillates");
}
