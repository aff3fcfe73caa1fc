use super::*;

fn noise(condition: Condition, seed: u64, n: usize) -> Vec<f64> {
    Additive::new(&condition, seed).take(n).collect()
}

#[test]
fn white_noise_is_uniform_of_full_width_and_white() {
    let x = noise(Condition::white(100.0), 3, 200_000);
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(largest <= 0.05 && largest > 0.0499);
    assert!((rms(&x) - 0.1 / 12f64.sqrt()).abs() < 2e-4);
    for lag in 1..5 {
        let product: f64 = x.windows(lag + 1).map(|w| w[0] * w[lag]).sum();
        let correlation = product / (x.len() as f64 * mean_square(&x));
        // Four standard deviations of 1/sqrt(n).
        assert!(correlation.abs() < 4.0 / 200_000f64.sqrt(), "{correlation}");
    }
}

#[test]
fn absolute_drift_is_a_half_hertz_sine() {
    let condition = Condition {
        w_um: 1000.0,
        ..Condition::CLEAN
    };
    let x = noise(condition, 4, 2000);
    assert!((rms(&x) - 0.5 / 2f64.sqrt()).abs() < 1e-9);
    assert!((x[0] + x[1000]).abs() < 1e-9);
    assert_ne!(x[0], noise(condition, 5, 1)[0]);
}

#[test]
fn relative_drift_is_a_lag_of_200_ms() {
    let condition = Condition {
        w_um: 1000.0,
        reading: Reading::Relative,
        ..Condition::CLEAN
    };
    let x = noise(condition, 6, 400_000);
    let power = mean_square(&x);
    let correlation =
        x.windows(201).map(|w| w[0] * w[200]).sum::<f64>() / (power * (x.len() - 200) as f64);
    assert!(
        (correlation - (-1.0_f64).exp()).abs() < 0.08,
        "{correlation}"
    );
    let pole = (-0.005_f64).exp();
    let expected = 1.0 / 12.0 * (1.0 - pole) / (1.0 + pole);
    assert!(
        (power / expected - 1.0).abs() < 0.08,
        "{}",
        power / expected
    );
}

#[test]
fn relative_noise_meets_the_printed_ratio() {
    let truth: Vec<f64> = (0..3000)
        .map(|k| 30.0 + 7.0 * (0.01 * f64::from(k)).sin())
        .collect();
    for (w_um, eta_um, eps_um, ns_pct) in [
        (100.0, 500.0, 2.0, 41.78),
        (10_000.0, 1.0, 2.0, 43.48),
        (100.0, 10.0, 100.0, 17.03),
        (0.0, 1.0, 0.0, 1.2),
    ] {
        let condition = Condition {
            w_um,
            eta_um,
            eps_um,
            dt_ms: 1.0,
            ns_pct,
            reading: Reading::Relative,
        };
        let (measured, _) = condition.measure(&truth, 9);
        let error: Vec<f64> = measured.iter().zip(&truth).map(|(m, y)| m - y).collect();
        let ratio = 100.0 * rms(&error) / rms_about_mean(&truth);
        assert!((ratio / ns_pct - 1.0).abs() < 1e-5, "{ratio} for {ns_pct}");
    }
}

#[test]
fn resolution_rounds_to_multiples() {
    assert_eq!(quantised(0.0124, 0.005), 0.01);
    assert_eq!(quantised(0.3, 0.0), 0.3);
    let condition = Condition {
        eps_um: 10.0,
        ..Condition::CLEAN
    };
    let truth: Vec<f64> = (0..5000).map(|k| 0.000_731 * f64::from(k)).collect();
    let (measured, scale) = condition.measure(&truth, 1);
    assert_eq!(scale, 1.0);
    let error: Vec<f64> = measured.iter().zip(&truth).map(|(m, y)| m - y).collect();
    assert!(error.iter().all(|e| e.abs() <= 0.005 + 1e-12));
    assert!((rms(&error) - 0.01 / 12f64.sqrt()).abs() < 1e-4);
}

#[test]
fn the_same_seed_gives_the_same_noise() {
    let condition = Condition::white(10.0);
    assert_eq!(noise(condition, 1, 50), noise(condition, 1, 50));
    assert_ne!(noise(condition, 1, 50), noise(condition, 2, 50));
}
