//! Discretisation, margins and designs against other programs, and the loops in simulation.
//!
//! The numbers of `REFERENCE` come from python-control 0.10.2 and scipy 1.17.1:
//!
//! ```python
//! import control as ct, numpy as np, scipy.signal as ss
//! T = 1e-3; P = ct.c2d(ct.tf([1e6], [1, 20, 400, 0]), T, 'zoh'); P(np.exp(1j * 30 * T))
//! kp, ti, td, tf = 2.0e-3, 0.8, 0.06, 0.006; q = 1 / ct.tf([1, 0], [1], T); beta = tf / (tf + T)
//! C = kp + kp * T / ti * q / (1 - q) + kp * td / (tf + T) * (1 - q) / (1 - beta * q)
//! L = ct.minreal(C, verbose=False) * P; ct.stability_margins(ct.ss(L))   # gain, phase, .., their frequencies
//! w = np.logspace(-1, np.log10(np.pi / T * 0.9999), 400000)
//! np.max(1 / np.abs(1 + np.squeeze(L(np.exp(1j * w * T)))))               # largest sensitivity
//! A = np.array([[0, 1, 0], [0, 0, 1], [0, -400, -20]]); B = np.array([[0], [0], [1e6]])
//! Ad, Bd, *_ = ss.cont2discrete((A, B, np.array([[1, 0, 0]]), 0), T); i = 30 * np.sqrt(1 - .49)
//! ss.place_poles(Ad, Bd, np.exp(T * np.array([-21 + 1j * i, -21 - 1j * i, -30]))).gain_matrix
//! ```

mod limits;
mod search;
mod stability;

use super::*;
use nalgebra::Complex;

const AUTO: Goal = Goal {
    sample_time: 1e-3,
    bandwidth: None,
};

fn servo(delay: f64) -> Model {
    Model {
        a: vec![0.0, 400.0, 20.0],
        b: vec![1e6],
        delay,
    }
}

const PID: Pid = Pid {
    kp: 2.0e-3,
    ti: 0.8,
    td: 0.06,
    tf: 0.006,
};

fn near(found: f64, wanted: f64, share: f64) {
    assert!((found / wanted - 1.0).abs() < share, "{found} {wanted}");
}

#[test]
fn the_sampled_plant_is_that_of_python_control() {
    let found = SampledPlant::new(&servo(0.0), 1e-3).response(30.0);
    let wanted = Complex::new(-32.372_162_105_071_325, 27.810_072_632_014_304);
    assert!((found - wanted).norm() < 1e-6 * wanted.norm(), "{found}");
    // 5/(s + 2), 0.35 samples of 0.1 s late, by the modified z transform.
    let lag = Model {
        a: vec![2.0],
        b: vec![5.0],
        delay: 0.035,
    };
    let found = SampledPlant::new(&lag, 0.1).response(3.0);
    let wanted = Complex::new(0.453_230_690_918_917_05, -1.301_537_455_533_511_3);
    assert!((found - wanted).norm() < 1e-12, "{found}");
}

#[test]
fn the_margins_are_those_of_python_control() {
    let plant = SampledPlant::new(&servo(0.0), 1e-3);
    let [found, _] = margins::with_others(&plant, &[], &PID.controller(1e-3), (5.0, f64::INFINITY))
        .expect("no limit");
    assert!(found.stable);
    near(found.gain, 8.942_676_995_649_878, 1e-5);
    near(found.phase_deg, 78.395_685_562_068_31, 1e-5);
    near(found.delay, 0.261_431_090, 1e-5);
    near(found.crossover, 5.233_729_462_098_957, 1e-5);
    near(found.max_sensitivity, 1.349_068_173, 1e-4);
}

#[test]
fn the_feedback_is_that_of_scipy() {
    let plant = SampledPlant::new(&servo(0.0), 1e-3);
    let (gains, _) = state_feedback::design(&plant, &servo(0.0), 30.0).expect("a design");
    let wanted = [2.630_843_30e-2, 1.717_942_86e-3, 5.102_122_91e-5];
    for (found, wanted) in gains.k.iter().zip(wanted) {
        near(*found, wanted, 1e-6);
    }
}

/// The largest output in the last tenth of a long step, over the first tenth's.
fn grows(model: &Model, found: &TunedLoop) -> bool {
    let plant = SampledPlant::new(model, 1e-3);
    let course = found.step(&plant, 60.0);
    let largest = |part: &[Sample]| {
        part.iter()
            .map(|s| (s.output - 1.0).abs())
            .fold(0.0, f64::max)
    };
    let n = course.len();
    !(largest(&course[n - n / 10..]) < 0.5)
}

#[test]
fn in_simulation_the_margins_are_where_a_loop_begins_to_grow() {
    let model = servo(0.5e-3);
    let tuned = tune(&model, &[], AUTO).expect("gains");
    assert_eq!(tuned.loops.len(), 3, "{:?}", tuned.refused);
    for found in &tuned.loops {
        let with = |gain: f64, delay: f64| Model {
            b: vec![1e6 * gain],
            delay: model.delay + delay,
            ..model.clone()
        };
        let Margins { gain, delay, .. } = found.margins;
        assert!(!grows(&with(0.97 * gain, 0.0), found), "{:?}", found.gains);
        assert!(grows(&with(1.03 * gain, 0.0), found), "{:?}", found.gains);
        assert!(!grows(&with(1.0, 0.97 * delay), found), "{:?}", found.gains);
        assert!(grows(&with(1.0, 1.03 * delay), found), "{:?}", found.gains);
    }
}

/// Plants of orders 1 to 4 by a seed: rates of 0.5 to 2, pairs, zeros, delays, signs.
fn drawn(seed: u64) -> Model {
    let mut state = seed;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    let order = 1 + (4.0 * random()) as usize;
    let mut roots = Vec::new();
    if random() < 0.5 {
        roots.push((0.0, 0.0));
    }
    while roots.len() < order {
        let rate = 20.0 * 4f64.powf(random() - 0.5);
        if order - roots.len() >= 2 && random() < 0.5 {
            let damping = 0.3 + 0.6 * random();
            let im = rate * (1.0 - damping * damping).sqrt();
            roots.extend([(-damping * rate, im), (-damping * rate, -im)]);
        } else {
            roots.push((-rate, 0.0));
        }
    }
    let a = crate::polynomials::from_roots(&roots);
    let gain = (if random() < 0.3 { -1.0 } else { 1.0 }) * 10f64.powf(4.0 * random());
    let mut b = vec![gain];
    if order >= 2 && random() < 0.3 {
        b.push(gain / (30.0 + 100.0 * random()));
    }
    Model {
        a,
        b,
        delay: 8e-3 * random(),
    }
}

#[test]
fn drawn_plants_get_robust_loops_that_follow() {
    let (mut loops, mut refused) = (0, 0);
    for seed in 200_001..200_041 {
        let model = drawn(seed);
        let tuned = tune(&model, &[], AUTO).expect("gains");
        assert!(
            !tuned.loops.is_empty(),
            "{seed} {model:?} {:?}",
            tuned.refused
        );
        let cascade = tuned.refused.iter().filter(|(kind, _)| *kind == KINDS[0]);
        refused += tuned.refused.len() - usize::from(model.a[0] != 0.0) * cascade.count();
        for found in &tuned.loops {
            loops += 1;
            assert!(found.margins.stable && found.margins.max_sensitivity <= SENSITIVITY);
            assert!(
                // 1/(1 - 1/1.7) upwards, 1 + 1/1.7 downwards, 2 asin(1/3.4).
                found.margins.gain >= 1.58 && found.margins.phase_deg >= 34.0,
                "{seed} {found:?}"
            );
            let course = found.step(&tuned.plant, 60.0 / found.bandwidth + 5.0);
            let last = course.last().expect("samples").output;
            assert!(
                (last - 1.0).abs() < 0.05,
                "{seed} {} ends at {last}",
                found.gains.name()
            );
        }
    }
    println!("{loops} loops, {refused} refused");
    assert!(loops >= 80 && refused <= 8, "{loops} {refused}");
}

#[test]
fn the_command_of_the_feedforward_makes_the_plant_follow() {
    // (1 + s/50) zeros: s^2 + 3 s + 2 = (2 + 3 s + s^2) / (4 (1 + s/50)) by powers.
    let model = Model {
        a: vec![2.0, 3.0],
        b: vec![4.0, 0.08],
        delay: 0.0,
    };
    let found = model.feedforward();
    for (found, wanted) in found.iter().zip([0.5, 0.74, 0.2352]) {
        near(*found, wanted, 1e-12);
    }
    assert_eq!(servo(0.0).feedforward(), [0.0, 4e-4, 2e-5, 1e-6]);
}

#[test]
fn what_cannot_be_tuned_is_refused() {
    let goal = AUTO;
    for (model, part) in [
        (
            Model {
                b: vec![0.0],
                ..servo(0.0)
            },
            "0 at rest",
        ),
        (
            Model {
                b: vec![1.0; 4],
                ..servo(0.0)
            },
            "4 numerator",
        ),
        (
            Model {
                a: vec![],
                ..servo(0.0)
            },
            "order is 0",
        ),
        (
            Model {
                a: vec![f64::NAN],
                ..servo(0.0)
            },
            "finite",
        ),
        (servo(-1.0), "delay is -1"),
        (servo(0.201), "longer than 200 samples"),
    ] {
        let error = tune(&model, &[], goal).expect_err(part).to_string();
        assert!(error.contains(part), "{error}");
    }
    let fast = Goal {
        bandwidth: Some(600.0),
        ..goal
    };
    assert!(matches!(
        tune(&servo(0.0), &[], fast),
        Err(Error::Bandwidth { .. })
    ));
    let never = Goal {
        sample_time: 0.0,
        ..goal
    };
    assert_eq!(tune(&servo(0.0), &[], never), Err(Error::SampleTime(0.0)));
}

#[test]
fn a_state_feedback_that_moves_no_pole_is_none() {
    // A resonance above half a radian per sample, and one whose bandwidth is given below it.
    let fast = Model {
        a: vec![190_512.0, 41.73],
        b: vec![190_485.0],
        delay: 0.0,
    };
    for (sample_time, bandwidth) in [(1.6384e-3, None), (1e-4, Some(100.0))] {
        let goal = Goal {
            sample_time,
            bandwidth,
        };
        let tuned = tune(&fast, &[], goal).expect("gains");
        let refused = tuned.refused.iter().find(|(kind, _)| *kind == KINDS[2]);
        assert_eq!(
            refused.map(|(_, why)| why.as_str()),
            Some(state_feedback::IDLE)
        );
    }
}
