//! The largest robust bandwidth, the sign of the gains and their units.

use super::*;

#[test]
fn gains_do_not_depend_on_the_unit_of_the_gain() {
    let with = |gain: f64, b: &[f64]| Model {
        b: b.iter().map(|b| b * gain).collect(),
        ..servo(2.5e-3)
    };
    for b in [&[1.0][..], &[1.0, 0.02]] {
        let wanted = tune(&with(1e6, b), &[with(1.2e6, b)], AUTO).expect("gains");
        assert_eq!(wanted.loops.len(), 3, "{:?}", wanted.refused);
        for gain in [1e20, 1e90, 1e-90, -1e-30] {
            let found = tune(&with(gain, b), &[with(1.2 * gain, b)], AUTO).expect("gains");
            assert_eq!(found.loops.len(), 3, "{gain}: {:?}", found.refused);
            let share = 1e6 / gain;
            for (found, wanted) in found.loops.iter().zip(&wanted.loops) {
                near(found.bandwidth, wanted.bandwidth, 1e-6);
                near(found.margins.gain, wanted.margins.gain, 1e-4);
                near(
                    found.margins.max_sensitivity,
                    wanted.margins.max_sensitivity,
                    1e-6,
                );
                let pairs: Vec<[f64; 2]> = match (&found.gains, &wanted.gains) {
                    (Gains::Cascade(x), Gains::Cascade(y)) => vec![[x.kp, y.kp * share]],
                    (Gains::Pid(x), Gains::Pid(y)) => vec![[x.kp, y.kp * share]],
                    (Gains::StateFeedback(x), Gains::StateFeedback(y)) => {
                        let of_k = if x.derivatives { share } else { 1.0 };
                        let of_l = if x.derivatives { 1.0 } else { share };
                        let last = y.l.len() - 1;
                        let k = x.k.iter().zip(&y.k).map(|(x, y)| [*x, y * of_k]);
                        let l = x.l.iter().zip(&y.l).take(last);
                        k.chain(l.map(|(x, y)| [*x, y * of_l]))
                            .chain([[x.n, y.n * share], [x.l[last], y.l[last] * share]])
                            .collect()
                    }
                    _ => panic!("{found:?} {wanted:?}"),
                };
                for [found, wanted] in pairs {
                    near(found, wanted, 1e-4);
                }
            }
            for found in &found.loops {
                let course = found.step(&found_plant(&with(gain, b)), 4.0);
                near(course.last().expect("samples").output, 1.0, 0.02);
            }
        }
    }
}

fn found_plant(model: &Model) -> SampledPlant {
    SampledPlant::new(model, 1e-3)
}

/// A slow plant, whose bandwidth is far above its rate, and a fast one, whose bandwidth is as large
/// as the sampling allows.
#[test]
fn the_largest_bandwidth_is_one_that_may_be_asked_for_and_no_larger_one_is_robust() {
    for (a, b) in [
        (vec![0.0, 0.1], 1.0),
        (vec![0.0, 1e-3], 1.0),
        (vec![100.0], 100.0),
        (vec![0.0, 400.0, 20.0], 1e6),
    ] {
        let model = Model {
            a,
            b: vec![b],
            delay: 0.0,
        };
        let given = |bandwidth: f64| {
            let goal = Goal {
                bandwidth: Some(bandwidth),
                ..AUTO
            };
            tune(&model, &[], goal)
        };
        for found in tune(&model, &[], AUTO).expect("gains").loops {
            let kind = found.gains.name();
            let same = given(found.bandwidth).expect("a bandwidth that may be asked for");
            assert!(same.loops.contains(&found), "{kind} {model:?}");
            let Ok(faster) = given(1.1 * found.bandwidth) else {
                near(found.bandwidth, 500.0, 0.1);
                continue;
            };
            let faster = faster.loops.into_iter().find(|l| l.gains.name() == kind);
            let sensitivity = faster.map_or(f64::INFINITY, |l| l.margins.max_sensitivity);
            assert!(
                sensitivity > SENSITIVITY,
                "{kind} {model:?}: {} rad/s, and {sensitivity} above",
                found.bandwidth
            );
        }
    }
}

/// The gain at rest has no sign behind two integrators, and the other one before an unstable pole.
#[test]
fn two_integrators_and_an_unstable_pole_have_gains() {
    for a in [
        vec![0.0, 0.0],
        vec![-3.0],
        vec![0.0, -3.0],
        vec![25.0, -2.0],
    ] {
        for b in [1.0, -200.0] {
            let model = Model {
                a: a.clone(),
                b: vec![b],
                delay: 0.4e-3,
            };
            let tuned = tune(&model, &[], AUTO).expect("gains");
            for kind in &KINDS[usize::from(a[0] != 0.0)..2] {
                let found = tuned.loops.iter().any(|found| found.gains.name() == *kind);
                assert!(found, "{kind} {model:?} {:?}", tuned.refused);
            }
            for found in &tuned.loops {
                let course = found.step(&tuned.plant, 60.0 / found.bandwidth);
                let last = course.last().expect("samples").output;
                assert!(
                    (last - 1.0).abs() < 0.05,
                    "{model:?} {found:?} ends at {last}"
                );
            }
        }
    }
}
