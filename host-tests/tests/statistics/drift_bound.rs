//! What any unbiased estimate can reach in the drift rows of RELATIVE, the colour of the drift
//! known.

use trendid_host_tests::oracles::cramer_rao::{Coefficient, Sensitivity, servo_deviation_pct};
use trendid_host_tests::paper::trial::Setting;
use trendid_host_tests::plants::servo::REFERENCE;
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::{Reading, rms};

/// Bound of C, omega0, xi \[%\] over 3 s for Gaussian noise with the spectrum of the drift, rms
/// over 100 records.
///
/// The drift is a first-order lag of white noise: the difference `x(k) - p x(k-1)` is white, and so
/// are the sensitivities to be differenced. Rounding and white noise on top can only raise the
/// bound.
fn coloured_bound_pct(setting: &Setting) -> [f64; 3] {
    let experiment = Experiment::reference(setting.condition, 3.0);
    let free = [
        Coefficient::A(1),
        Coefficient::A(2),
        Coefficient::B { input: 0, power: 0 },
        Coefficient::Initial(0),
    ];
    let mut squares = [0.0; 3];
    for seed in 200_000..200_100 {
        let record = experiment.record(seed);
        let pole = (-record.dt / 0.2).exp();
        let plant = REFERENCE.plant(record.dt);
        let mut sensitivity = Sensitivity::simulate(&plant, &free, &[0.0; 3], &[&record.u]);
        let own = sensitivity.jacobian.clone();
        for k in 0..own.nrows() {
            for j in 0..own.ncols() {
                sensitivity.jacobian[(k, j)] = match k {
                    0 => own[(0, j)] * (1.0 - pole * pole).sqrt(),
                    _ => own[(k, j)] - pole * own[(k - 1, j)],
                };
            }
        }
        let innovation = rms(&record.noise()) * (1.0 - pole * pole).sqrt();
        let covariance = sensitivity.covariance(innovation).expect("excited");
        for (sum, e) in squares
            .iter_mut()
            .zip(servo_deviation_pct(&REFERENCE, &covariance))
        {
            *sum += e * e / 100.0;
        }
    }
    squares.map(f64::sqrt)
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn the_printed_damping_of_the_strong_drifts_is_below_the_bound() {
    let mut rows = Setting::all(Reading::Relative);
    rows.retain(|s| s.vary == "drift" && s.condition.w_um >= 5000.0);
    assert_eq!(rows.len(), 2);
    for setting in rows {
        let bound = coloured_bound_pct(&setting);
        println!(
            "N/S {} %: bound of C, omega0, xi {bound:.3?} %, paper {:?}",
            setting.condition.ns_pct, setting.tustin
        );
        // Also when the heads of C and xi are swapped in print.
        let printed = setting.tustin.xi_pct.max(setting.tustin.c_pct);
        assert!(bound[2] > 1.2 * printed, "{bound:?}");
    }
}
