//! One run: the drive of a case and the identifier of its structure.

use trendid::estimation::Terms;
use trendid::inputs::{Coulomb, dead_zone};
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Identifier, Structure, structure};

use crate::endurance::axis::{Integrating, WithFriction};
use crate::endurance::found::Found;
use crate::endurance::reading::{first_order, second_order};
use crate::endurance::runner::Runner;
use crate::endurance::scenario::{Case, DEAD_ZONE, DT, Drive, GAIN};
use crate::plants::servo::Servo;
use crate::plants::valve::FrictionDrive;

/// One run over `samples` samples of the scenario; the others beside it over at most `others`
/// samples.
pub fn run(case: &Case, seed: u64, samples: u64, others: u64) -> Found {
    let w = case.setup.bandwidth;
    let servo = Servo {
        c: GAIN,
        omega0: w,
        xi: 0.5,
    };
    let third = Integrating::new(servo.a(), servo.b0(), DT);
    let truth = [GAIN, w, 0.5];
    match case.setup.drive {
        Drive::Servo => {
            let identifier = identifier::<3, 5, 1>(case, Structure::SERVO, [0.4]);
            let read = |i: &Identifier<_, 3, 5>| second_order(i);
            Runner::new(case, seed, third, truth, others).go(samples, identifier, |u, _| [u], read)
        }
        Drive::Integrating3 => {
            let identifier = identifier::<3, 3, 1>(case, Structure::INTEGRATING, [0.4]);
            let read = |i: &Identifier<_, 3, 3>| second_order(i);
            Runner::new(case, seed, third, truth, 0).go(samples, identifier, |u, _| [u], read)
        }
        Drive::Integrating2 => {
            let axis = Integrating::new([0.0, w], GAIN * w, DT);
            let identifier = identifier::<2, 2, 1>(case, Structure::INTEGRATING, [0.4]);
            let truth = [GAIN, w, 0.0];
            Runner::new(case, seed, axis, truth, 0).go(samples, identifier, |u, _| [u], first_order)
        }
        Drive::DeadZone => {
            let b0 = [Terms::of(&[0]); 2];
            let structure = Structure::try_with_initial_state(Terms::of(&[1, 2]), b0, true)
                .expect("six parameters");
            let identifier = identifier::<3, 6, 2>(case, structure, [0.4, 1.0]);
            let inputs = |u: f32, _| dead_zone(u, DEAD_ZONE as f32);
            let read = |i: &Identifier<_, 3, 6, 2>| second_order(i);
            Runner::new(case, seed, third, truth, 0).go(samples, identifier, inputs, read)
        }
        Drive::Coulomb => {
            // Friction takes the acceleration of a command of 0.05.
            let friction = FrictionDrive::new(w, GAIN * w, 0.05 * GAIN * w, 0.0);
            let structure: Structure<2, 3, 2> =
                structure!(Terms::of(&[1]), [Terms::of(&[0]); 2], false);
            let identifier = identifier::<2, 3, 2>(case, structure, [0.4, 1.0]);
            let mut friction_input = Coulomb::new(1e-3);
            let inputs = move |u: f32, v: f64| [u, friction_input.update(v as f32)];
            let truth = [GAIN, w, 0.0];
            let axis = WithFriction::new(friction, DT);
            Runner::new(case, seed, axis, truth, 0).go(samples, identifier, inputs, first_order)
        }
    }
}

fn identifier<const M: usize, const N: usize, const I: usize>(
    case: &Case,
    structure: Structure<M, N, I>,
    ranges: [f32; I],
) -> Identifier<FilteredTrends<M>, M, N, I> {
    let bandwidth = case.setup.bandwidth as f32;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, bandwidth)
        .expect("the bandwidth is positive");
    let mut config = Config::new(structure, bandwidth, ranges, 1000.0 / bandwidth);
    config.memory = case.memory.map(|memory| memory as f32);
    if case.setup.drive == Drive::Coulomb {
        // Friction turns with the velocity, anywhere between two samples.
        config.holds[I - 1] = Hold::Mean;
        config.friction_input = Some(I - 1);
    }
    Identifier::try_new(&config, trends).expect("a configuration that works")
}
