//! The turns of the closed loop against its eigenvalues, and their cost.

use super::*;
use crate::tune::stability::is_stable;
use nalgebra::DMatrix;

/// The largest pole of the closed loop, every delay a state.
fn largest_pole(plant: &SampledPlant, controller: &Controller) -> f64 {
    let (m, d, n) = (plant.order(), plant.delay + 1, controller.states());
    let size = m + d + n;
    let chain = |lag: usize| m + lag - 1;
    let mut closed = DMatrix::zeros(size, size);
    closed.view_mut((0, 0), (m, m)).copy_from(&plant.a);
    let u = DMatrix::from_fn(1, size, |_, j| match j {
        j if j < m => controller.d[1] * plant.c[j],
        j if j < m + d => 0.0,
        j => controller.c[j - m - d],
    });
    for (share, lag) in plant.b.iter().zip([plant.delay, plant.delay + 1]) {
        for i in 0..m {
            match lag {
                0 => (0..size).for_each(|j| closed[(i, j)] += share[i] * u[(0, j)]),
                lag => closed[(i, chain(lag))] += share[i],
            }
        }
    }
    closed.view_mut((m, 0), (1, size)).copy_from(&u);
    for lag in 2..=d {
        closed[(chain(lag), chain(lag - 1))] = 1.0;
    }
    for i in 0..n {
        for j in 0..m {
            closed[(m + d + i, j)] = controller.b[1][i] * plant.c[j];
        }
        for j in 0..n {
            closed[(m + d + i, m + d + j)] = controller.a[(i, j)];
        }
    }
    frequency_response::balance(&mut closed);
    let eigenvalues = closed.complex_eigenvalues();
    eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max)
}

/// All kinds of controllers for drawn plants, their gains up to eight times too large or too small.
#[test]
fn a_loop_is_stable_where_all_eigenvalues_are_inside() {
    let mut count = [0, 0];
    for seed in 300_001..300_061 {
        let late = Model {
            delay: 1e-3 * (seed % 13) as f64 + 0.3e-3 * (seed % 2) as f64,
            ..drawn(seed)
        };
        let plant = SampledPlant::new(&late, 1e-3);
        let (unit, model) = (plant.divided(plant.gain()), late.divided(plant.gain()));
        for bandwidth in [0.3, 5.0, 40.0, 300.0] {
            let pid = shaping::pid(&unit, bandwidth).map(|pid| pid.controller(1e-3));
            let cascade = shaping::cascade(&unit, bandwidth).map(|c| c.controller(1e-3));
            let feedback = state_feedback::design(&unit, &model, bandwidth);
            let feedback = feedback.ok().map(|(_, controller)| controller);
            for controller in [pid, cascade, feedback].into_iter().flatten() {
                for power in -3..=3 {
                    let controller = controller.clone().for_gain(2f64.powi(power));
                    let largest = largest_pole(&unit, &controller);
                    // Eigenvalues of a multiple pole are no better.
                    if (largest - 1.0).abs() < 1e-6 {
                        continue;
                    }
                    let stable = is_stable(&unit, &controller);
                    count[usize::from(stable)] += 1;
                    assert_eq!(
                        stable,
                        largest < 1.0,
                        "{seed} {bandwidth} {power}: {largest}"
                    );
                }
            }
        }
    }
    println!("{count:?}");
    assert!(count[0] > 500 && count[1] > 500, "{count:?}");
}

#[test]
fn a_delay_of_many_samples_takes_no_minutes() {
    let around: Vec<Model> = (0..8).map(|k| servo(1e-3 * (190 + k) as f64)).collect();
    let begun = std::time::Instant::now();
    let tuned = tune(&servo(0.1953), &around, AUTO).expect("gains");
    assert_eq!(tuned.loops.len(), 3, "{:?}", tuned.refused);
    let seconds = begun.elapsed().as_secs_f64();
    println!("{seconds:.2} s");
    assert!(seconds < 20.0, "{seconds}");
}
