//! White noise in the RELATIVE reading, against the Cramer-Rao bound, and the coverage of the
//! reported sigma.

use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::oracles::cramer_rao::{InitialState, servo_bound_pct};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::{Condition, rms};

#[test]
#[ignore = "long: cargo xtask statistics"]
fn white_rows_stay_near_the_bound_and_sigma_covers() {
    for duration in [1.0, 3.0] {
        for ns in [1.04, 8.35, 16.72, 41.78] {
            let seeds = 7000..7200_u64;
            let mut ratios = [const { Vec::new() }; 3];
            let mut inside = [[0; 3]; 2];
            for seed in seeds.clone() {
                let record =
                    Experiment::reference(Condition::white_relative(ns), duration).record(seed);
                let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
                let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [1.0], 50.0);
                let mut identifier: Identifier<_, 3, 5> =
                    Identifier::try_new(&config, trends).unwrap();
                for s in record.samples() {
                    let _ = identifier.update(s.u as f32, s.y as f32);
                }
                let theta = identifier.theta().map(f64::from);
                let found =
                    Servo::from_coefficients(theta[0], theta[1], theta[2]).expect("a servo");
                let error = found.error_pct(&REFERENCE);
                let bound = servo_bound_pct(
                    &REFERENCE,
                    0.001,
                    &record.u,
                    rms(&record.noise()),
                    InitialState::PositionUnknown,
                )
                .unwrap();
                let sigma = identifier.estimate().physical_std().expect("sigma");
                let truth = [2500.0, 20.0, 0.5];
                for i in 0..3 {
                    ratios[i].push(error[i] / bound[i]);
                    let z = error[i].abs() / 100.0 * truth[i] / f64::from(sigma[i]);
                    inside[0][i] += i32::from(z <= 1.0);
                    inside[1][i] += i32::from(z <= 3.0);
                }
            }
            let spread: Vec<f64> = ratios.iter().map(|r| rms(r)).collect();
            let median: Vec<f64> = ratios
                .iter()
                .map(|r| {
                    let mut sizes: Vec<f64> = r.iter().map(|v| v.abs()).collect();
                    sizes.sort_by(f64::total_cmp);
                    sizes[sizes.len() / 2]
                })
                .collect();
            println!(
                "{duration} s, N/S {ns} %, seeds {seeds:?}: rms/bound {spread:.2?}, median/bound {median:.2?}, inside 1, 3 sigma of 200: {inside:?}"
            );
            assert!(
                spread.iter().all(|r| *r <= 1.5),
                "rms above 1.5 times the bound"
            );
            assert!(
                median.iter().all(|r| *r <= 1.5),
                "median above 1.5 times the bound"
            );
        }
    }
}
