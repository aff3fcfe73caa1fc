//! Closed loops by a computation that shares nothing with the library.

mod law;
mod margins;
mod plant;

use law::Law;
pub(crate) use margins::margins;
pub(crate) use plant::Plant;
use trendid_identify::tune::TunedLoop;

type C = nalgebra::Complex<f64>;

/// The output of the closed loop after a step of the reference.
pub(crate) fn simulated(plant: &Plant, found: &TunedLoop, samples: usize) -> Vec<f64> {
    let modes = plant.modes();
    let mut x = vec![C::new(0.0, 0.0); modes.len()];
    let delay = (plant.model.delay / plant.dt).floor() as usize;
    let mut past = vec![0.0; delay + 2];
    let mut law = Law::of(plant, &found.gains);
    let mut course = Vec::new();
    for _ in 0..samples {
        let y: f64 = x.iter().map(|x| x.re).sum();
        course.push(y);
        past.rotate_right(1);
        past[0] = law.step(1.0, y);
        for (x, [a, newer, older]) in x.iter_mut().zip(&modes) {
            *x = a * *x + newer * past[delay] + older * past[delay + 1];
        }
    }
    course
}
