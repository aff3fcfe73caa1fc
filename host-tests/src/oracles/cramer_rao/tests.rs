use super::*;
use crate::plants::servo::REFERENCE;
use crate::signals::excitation::Excitation;

#[test]
fn sensitivities_agree_with_central_differences() {
    let (a, dt) = (vec![30.0, 200.0, 15.0], 2e-3);
    let inputs = vec![Input::delayed(&[500.0, 20.0], 2), Input::new(&[-300.0])];
    let initial = [0.3, -1.0, 20.0];
    let u1 = Excitation::ABSOLUTE.sequence(300, dt, 1);
    let u2 = Excitation::RELATIVE.sequence(300, dt, 2);
    let free = [
        Coefficient::A(0),
        Coefficient::A(1),
        Coefficient::A(2),
        Coefficient::B { input: 0, power: 0 },
        Coefficient::B { input: 0, power: 1 },
        Coefficient::B { input: 1, power: 0 },
        Coefficient::Constant,
        Coefficient::Initial(0),
        Coefficient::Initial(1),
        Coefficient::Initial(2),
    ];
    let plant = LinearPlant::with_inputs(&a, &inputs, 7.0, dt).unwrap();
    let exact = Sensitivity::simulate(&plant, &free, &initial, &[&u1, &u2]);
    for (p, coefficient) in free.iter().enumerate() {
        let moved = |relative: f64| {
            let (mut a, mut inputs, mut constant, mut x0) =
                (a.clone(), inputs.clone(), 7.0, initial);
            let value = match *coefficient {
                Coefficient::A(i) => &mut a[i],
                Coefficient::B { input, power } => &mut inputs[input].b[power],
                Coefficient::Constant => &mut constant,
                Coefficient::Initial(i) => &mut x0[i],
            };
            *value *= 1.0 + relative;
            let change = *value * relative / (1.0 + relative);
            let mut plant = LinearPlant::with_inputs(&a, &inputs, constant, dt).unwrap();
            plant.place(&x0);
            let y: Vec<f64> = (0..300)
                .map(|k| {
                    let y = plant.output();
                    plant.step(&[u1[k], u2[k]]);
                    y
                })
                .collect();
            (y, change)
        };
        let (high, up) = moved(1e-4);
        let (low, down) = moved(-1e-4);
        let scale = exact.jacobian.column(p).amax();
        for k in 0..300 {
            let difference = (high[k] - low[k]) / (up - down);
            assert!(
                (difference - exact.jacobian[(k, p)]).abs() < 1e-6 * scale,
                "{coefficient:?} at {k}: {difference} {}",
                exact.jacobian[(k, p)]
            );
        }
    }
}

#[test]
fn bound_of_a_gain_is_elementary() {
    // 1/s driven by 1: dy/db = t, so the standard deviation is sigma / sqrt(sum t^2).
    let plant = LinearPlant::new(&[0.0], &[3.0], 0.1).unwrap();
    let free = [Coefficient::B { input: 0, power: 0 }];
    let got = coefficient_bound(&plant, &free, &[&[1.0; 50]], 0.2).unwrap()[0];
    let sum: f64 = (0..50).map(|k| (0.1 * f64::from(k)).powi(2)).sum();
    assert!((got - 0.2 / sum.sqrt()).abs() < 1e-12);
}

#[test]
fn an_unexcited_record_bounds_nothing() {
    let u = [0.0; 100];
    let bound = servo_bound_pct(&REFERENCE, 1e-3, &u, 1e-3, InitialState::Known);
    assert_eq!(bound, None);
}
