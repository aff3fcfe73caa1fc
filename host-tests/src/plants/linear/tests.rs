use super::*;

fn close(got: f64, want: f64, relative: f64) {
    assert!(
        (got - want).abs() <= relative * want.abs().max(1e-12),
        "{got} is not {want}"
    );
}

#[test]
fn step_of_first_order_follows_the_closed_form() {
    let mut p = LinearPlant::new(&[5.0], &[10.0], 1e-3).unwrap();
    for k in 0..2000 {
        let t = k as f64 * 1e-3;
        close(p.output(), 2.0 * (1.0 - (-5.0 * t).exp()), 1e-11);
        p.step(&[1.0]);
    }
}

#[test]
fn step_of_the_servo_follows_the_closed_form() {
    // C (t - 2 xi/w0 + e^(-s t) (2 s/w0^2 cos wd t + (s^2 - wd^2)/(w0^2 wd) sin wd t)), s = xi w0.
    let (c, w0, xi) = (2500.0, 20.0_f64, 0.5);
    let (s, wd) = (xi * w0, w0 * (1.0 - xi * xi).sqrt());
    let mut p = LinearPlant::new(&[0.0, 400.0, 20.0], &[1e6], 1e-3).unwrap();
    for k in 0..1000 {
        let t = k as f64 * 1e-3;
        let decay = (-s * t).exp();
        let want = c
            * (t - 2.0 * xi / w0
                + decay
                    * (2.0 * s / (w0 * w0) * (wd * t).cos()
                        + (s * s - wd * wd) / (w0 * w0 * wd) * (wd * t).sin()));
        assert!(
            (p.output() - want).abs() < 1e-9,
            "t {t}: {} {want}",
            p.output()
        );
        p.step(&[1.0]);
    }
}

#[test]
fn zeros_act_and_derivatives_are_consistent() {
    // (s + 3) / ((s + 1)(s + 2)): step response 1.5 - 2 e^-t + 0.5 e^-2t.
    let mut p = LinearPlant::new(&[2.0, 3.0], &[3.0, 1.0], 0.01).unwrap();
    for k in 0..300 {
        let t = k as f64 * 0.01;
        let want = 1.5 - 2.0 * (-t).exp() + 0.5 * (-2.0 * t).exp();
        assert!((p.output() - want).abs() < 1e-13);
        if k > 0 {
            let slope = 2.0 * (-t).exp() - (-2.0 * t).exp();
            assert!((p.derivative(1) - slope).abs() < 1e-12);
        }
        p.step(&[1.0]);
    }
}

#[test]
fn free_motion_from_placed_derivatives() {
    // y = e^-t satisfies (s + 1)(s + 2)(s + 3)(s + 4) y = 0.
    let mut p = LinearPlant::new(&[24.0, 50.0, 35.0, 10.0], &[1.0], 0.05).unwrap();
    p.place(&[1.0, -1.0, 1.0, -1.0]);
    for k in 0..60 {
        let want = (-0.05 * f64::from(k)).exp();
        assert!((p.output() - want).abs() < 1e-12);
        assert!((p.derivative(3) + want).abs() < 1e-10);
        p.step(&[0.0]);
    }
}

#[test]
fn inputs_superpose_delay_shifts_and_constant_adds() {
    let (a, dt) = ([0.0, 30.0], 2e-3);
    let inputs = [Input::new(&[7.0, 1.0]), Input::delayed(&[-4.0], 3)];
    let mut both = LinearPlant::with_inputs(&a, &inputs, 2.0, dt).unwrap();
    let mut first = LinearPlant::new(&a, &[7.0, 1.0], dt).unwrap();
    let mut second = LinearPlant::new(&a, &[-4.0], dt).unwrap();
    let mut offset = LinearPlant::new(&a, &[2.0], dt).unwrap();
    let u = |k: i32| f64::from((k * 7919 % 13) - 6);
    for k in 0..100 {
        let sum = first.output() + second.output() + offset.output();
        assert!((both.output() - sum).abs() < 1e-10);
        both.step(&[u(k), u(k + 50)]);
        first.step(&[u(k)]);
        second.step(&[if k >= 3 { u(k + 47) } else { 0.0 }]);
        offset.step(&[1.0]);
    }
}

#[test]
fn ramp_is_integrated_exactly() {
    // 1/s^2 on u = t gives t^3/6.
    let mut p = LinearPlant::new(&[0.0, 0.0], &[1.0], 0.1).unwrap();
    for k in 0..50 {
        let t = 0.1 * f64::from(k);
        assert!((p.output() - t * t * t / 6.0).abs() < 1e-12);
        p.step_ramp(&[t], &[t + 0.1]);
    }
}

#[test]
fn refuses_what_it_cannot_simulate() {
    let error = |a: &[f64], b: &[f64], dt| LinearPlant::new(a, b, dt).unwrap_err();
    assert_eq!(error(&[], &[1.0], 1.0), PlantError::Order(0));
    assert_eq!(error(&[1.0; 5], &[1.0], 1.0), PlantError::Order(5));
    assert_eq!(error(&[1.0], &[1.0, 2.0], 1.0), PlantError::Numerator(0));
    assert_eq!(error(&[1.0], &[1.0], 0.0), PlantError::Interval(0.0));
    assert_eq!(
        error(&[f64::INFINITY], &[1.0], 1.0),
        PlantError::Coefficient(f64::INFINITY)
    );
}
