//! The search for poles: what it ends with holds, and nothing faster does.

use super::*;
use crate::servo::control::compensator::{Responses, ScaledDrive};
use crate::servo::control::sweep::{FrequencySweep, Swept, ratio};
use crate::servo::control::tuning::Tuning;
use crate::servo::design::TuningDesign;

const DESIGN: TuningDesign = TuningDesign {
    sample_time: STEP,
    delay: 4e-3,
    dead_volume: 0.06,
    noise: 0.01,
    bandwidth_max: f32::INFINITY,
};

fn searched(design: &TuningDesign, model: &Model) -> Tuning {
    let mut tuning = Tuning::new(design, model);
    let mut pieces = 0;
    while !tuning.step() {
        pieces += 1;
        assert!(pieces < 20_000);
    }
    tuning
}

/// The sweep of poles that hold on a model that is so many times as stiff, and its integral gain.
fn swept(
    design: &TuningDesign,
    model: &Model,
    poles: &Poles,
    stiffness: f32,
) -> Option<(FrequencySweep, f32)> {
    let w = libm::sqrtf(model.a1);
    let drive = ScaledDrive {
        a1: stiffness,
        a2: model.a2 / w,
        b0: stiffness,
        delay: w * design.delay,
    };
    let own = Poles {
        bandwidth: poles.bandwidth / w,
        observer: poles.observer / w,
        disturbance: poles.disturbance / w,
        ..*poles
    };
    let step = w * design.sample_time;
    let mut sweep = FrequencySweep::new(drive, &Responses::new(&drive), own, [step, ratio(step)]);
    let mut begun = 0.0;
    loop {
        match sweep.update() {
            Swept::Begun(integral) => begun = integral,
            Swept::On => {}
            Swept::Holds => return Some((sweep, begun)),
            Swept::Fails => return None,
        }
    }
}

/// The variance of the flow, where they hold.
fn holds(design: &TuningDesign, model: &Model, poles: &Poles, stiffness: f32) -> Option<f32> {
    swept(design, model, poles, stiffness).map(|(sweep, _)| sweep.variance())
}

/// k(x) at a tenth of the travel.
fn near_end(dead_volume: f32) -> f32 {
    let [one, other] = [dead_volume + 0.1, dead_volume + 0.9];
    0.5 * (dead_volume + 0.5) * (1.0 / one + 1.0 / other)
}

#[test]
fn poles_hold_in_the_middle_and_near_an_end_and_are_quiet() {
    for w in [10.0_f32, 25.0, 60.0] {
        for damping in [0.2, 0.7] {
            let model = Model::linear(w * w, 2.0 * damping * w, 1200.0 * w * w);
            let tuning = searched(&DESIGN, &model);
            let (poles, margins) = tuning.poles();
            let margins = margins.expect("poles that hold");
            assert!(tuning.has_some());
            let middle = holds(&DESIGN, &model, &poles, 1.0).expect("in the middle");
            let end = holds(&DESIGN, &model, &poles, near_end(0.06)).expect("near an end");
            // Noise over the gain, in the drive's own time.
            let noise = DESIGN.noise * w / 1200.0;
            assert!(
                noise * noise * (middle + end) < 0.03 * 0.03 * 1.001,
                "{w} {damping}"
            );
            assert!(
                margins.sensitivity < 2.2 && margins.gain > 1.5,
                "{margins:?}"
            );
            assert!(
                margins.delay > 0.5 * STEP && margins.delay < 1.0,
                "{margins:?}"
            );
            // The time that the loop bears in the middle.
            let (sweep, _) = swept(&DESIGN, &model, &poles, 1.0).expect("in the middle");
            let delay = sweep.margins().delay / w;
            assert!((margins.delay / delay - 1.0).abs() < 1e-4, "{margins:?}");
            assert!((poles.disturbance / poles.bandwidth - 0.3).abs() < 1e-5);
            assert!(poles.observer <= 0.3 / STEP * 1.0001);
            assert!((0.15..=3.0).contains(&(poles.bandwidth / w)), "{poles:?}");
            // Neither damping, at any observer, holds at a bandwidth a fifth faster with as much
            // of everything else.
            let faster = Poles {
                bandwidth: 1.2 * poles.bandwidth,
                disturbance: 1.2 * poles.disturbance,
                ..poles
            };
            let sum = [1.0, near_end(0.06)].map(|k| holds(&DESIGN, &model, &faster, k));
            let quiet = match sum {
                [Some(a), Some(b)] => noise * noise * (a + b) < 0.03 * 0.03,
                _ => false,
            };
            assert!(!quiet, "{w} {damping}: {faster:?} holds too");
        }
    }
}

#[test]
fn a_search_keeps_the_limits_that_it_is_given() {
    let model = Model::linear(625.0, 25.0, 1e6);
    let free = searched(&DESIGN, &model).poles().0;
    // A bandwidth that the user limits.
    let limited = TuningDesign {
        bandwidth_max: 0.5 * free.bandwidth,
        ..DESIGN
    };
    let poles = searched(&limited, &model).poles().0;
    assert!(
        (poles.bandwidth / (0.5 * free.bandwidth) - 1.0).abs() < 1e-3,
        "{poles:?}"
    );
    // A hundred times the noise, ten times the delay: slower.
    for design in [
        TuningDesign {
            noise: 100.0 * DESIGN.noise,
            ..DESIGN
        },
        TuningDesign {
            delay: 10.0 * DESIGN.delay,
            ..DESIGN
        },
    ] {
        let poles = searched(&design, &model).poles().0;
        assert!(poles.bandwidth < free.bandwidth, "{poles:?}");
    }
    // Where nothing holds the loop does little.
    let hopeless = TuningDesign {
        noise: 1e6,
        ..DESIGN
    };
    let tuning = searched(&hopeless, &model);
    let (poles, margins) = tuning.poles();
    assert!(margins.is_none() && !tuning.has_some());
    assert_eq!(poles, Tuning::slowest(&hopeless, &model));
    let slow = |sample_time: f32| {
        let design = TuningDesign {
            sample_time,
            ..DESIGN
        };
        Tuning::slowest(&design, &model)
    };
    let poles = slow(STEP);
    assert!((poles.bandwidth - 0.15 * 25.0).abs() < 1e-4 && poles.damping == 1.6);
    assert!((poles.disturbance - 0.015 * 25.0).abs() < 1e-4);
    // Twice the frequency of the drive, where the sampling allows it.
    assert!((poles.observer - 50.0).abs() < 1e-3);
    assert!((slow(0.02).observer - 0.3 / 0.02).abs() < 1e-3);
}

/// Of every observer and damping the largest bandwidth that holds at both places and is quiet, and
/// of these poles those with the largest integral gain.
fn exhaustive(design: &TuningDesign, model: &Model) -> Option<Poles> {
    let w = libm::sqrtf(model.a1);
    let step = w * design.sample_time;
    let noise = design.noise * w * model.a1 / model.b0;
    let mut best: Option<(Poles, f32)> = None;
    for observer in [6.0, 4.0, 2.5, 1.6] {
        for damping in [0.8, 1.6] {
            let mut bandwidth = (0.15 / step).min(3.0).min(design.bandwidth_max / w);
            while bandwidth >= 0.15 {
                let poles = Poles {
                    bandwidth: w * bandwidth,
                    damping,
                    observer: w * (observer * bandwidth.max(1.0)).min(0.3 / step),
                    disturbance: 0.3 * w * bandwidth,
                };
                bandwidth *= 0.85;
                let middle = swept(design, model, &poles, 1.0);
                let end = swept(design, model, &poles, near_end(design.dead_volume));
                let (Some((middle, integral)), Some((end, _))) = (middle, end) else {
                    continue;
                };
                if noise * noise * (middle.variance() + end.variance()) < 0.03 * 0.03 {
                    if best.is_none_or(|(_, most)| integral > most) {
                        best = Some((poles, integral));
                    }
                    break;
                }
            }
        }
    }
    best.map(|(poles, _)| poles)
}

#[test]
fn a_search_ends_with_the_largest_integral_gain_of_what_holds() {
    // The later ones are limited by the noise of the command, some of them near an end only.
    for (w, damping, [delay, dead_volume, noise]) in [
        (25.0_f32, 0.2, [4e-3, 0.06, 0.01]),
        (25.0, 0.7, [12e-3, 0.02, 0.01]),
        (60.0, 0.1, [4e-3, 0.02, 0.01]),
        (60.0, 0.5, [8e-3, 0.2, 0.01]),
        (12.0, 0.4, [0.0, 0.01, 0.1]),
        (25.0, 0.5, [2e-3, 0.02, 0.3]),
        (25.0, 0.5, [2e-3, 0.02, 3.0]),
        (40.0, 0.344, [2e-3, 0.196, 0.38]),
        (34.0, 0.289, [0.0, 0.06, 0.6]),
        (34.9, 0.99, [3e-3, 0.05, 2.6]),
        (52.0, 0.86, [3e-3, 0.17, 1.6]),
    ] {
        let model = Model::linear(w * w, 2.0 * damping * w, 1200.0 * w * w);
        let design = TuningDesign {
            delay,
            dead_volume,
            noise,
            ..DESIGN
        };
        let (found, margins) = searched(&design, &model).poles();
        let exact = exhaustive(&design, &model).expect("poles that hold");
        assert!(margins.is_some());
        for (found, exact) in [
            (found.bandwidth, exact.bandwidth),
            (found.damping, exact.damping),
            (found.observer, exact.observer),
            (found.disturbance, exact.disturbance),
        ] {
            assert!(
                (found / exact - 1.0).abs() < 1e-3,
                "{w} {damping}: {found} {exact}"
            );
        }
    }
}

#[test]
fn what_begins_in_a_search_are_its_frequencies_a_drive_and_a_controller() {
    let mut tuning = Tuning::new(&DESIGN, &Model::linear(625.0, 25.0, 1e6));
    for begins in [true, true, true, false, false] {
        assert_eq!(tuning.begins(), begins);
        assert!(!tuning.step());
    }
}
