//! The core on the reference servo: without noise, and with white noise of known width.

use trendid::{Config, FilteredTrends, Identifier, RawTrends, Scheme, Structure, TrendOperator};
use trendid_host_tests::experiment::{Experiment, Record};
use trendid_host_tests::noise::Condition;
use trendid_host_tests::reference::{REFERENCE, Servo};

/// Relative errors of C, omega0 and xi in percent after the whole record.
fn errors<T: TrendOperator<3>>(trends: T, record: &Record) -> [f64; 3] {
    let config = Config::new(Structure::<3, 3, 1>::integrating(), 20.0, [0.4], 50.0);
    let mut identifier: Identifier<T, 3, 3> = Identifier::try_new(&config, trends).unwrap();
    for sample in record.samples() {
        let _ = identifier.update(sample.u as f32, sample.y as f32);
    }
    let model = identifier.transfer_function();
    Servo::from_coefficients(
        f64::from(model.a[1]),
        f64::from(model.a[2]),
        f64::from(model.b[0][0]),
    )
    .map_or([f64::INFINITY; 3], |found| found.error_pct(&REFERENCE))
}

fn within(errors: [f64; 3], limits: [f64; 3]) -> bool {
    errors.iter().zip(&limits).all(|(e, l)| e.abs() <= *l)
}

#[test]
fn noise_free_raw_tustin_beats_goodwin_and_the_filter_beats_both() {
    let record = Experiment::reference(Condition::CLEAN, 1.0).record(11);
    let tustin = errors(RawTrends::try_new(Scheme::Tustin, 0.001).unwrap(), &record);
    let goodwin = errors(RawTrends::try_new(Scheme::Goodwin, 0.001).unwrap(), &record);
    let filtered = errors(
        FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 3]).unwrap(),
        &record,
    );
    println!(
        "C/omega0/xi [%]: raw Tustin {tustin:?}, raw Goodwin {goodwin:?}, filtered Tustin {filtered:?}"
    );
    assert!(within(tustin, [0.4, 0.1, 0.5]));
    assert!(!within(goodwin, [0.4, 0.1, 0.5]));
    assert!(within(filtered, [0.02; 3]));
}

#[test]
fn white_noise_absolute_half_a_second() {
    for (eta, limit) in [(10.0, 0.05), (100.0, 0.2), (500.0, 0.6)] {
        let seeds = 5000..5100_u64;
        let mut squares = [0.0; 3];
        for seed in seeds.clone() {
            let mut condition = Condition::white(eta);
            condition.w_um = 0.0;
            condition.eps_um = 0.0;
            let record = Experiment::reference(condition, 0.5).record(seed);
            let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 3]).unwrap();
            for (sum, e) in squares.iter_mut().zip(errors(trends, &record)) {
                *sum += e * e / 100.0;
            }
        }
        let rms = squares.map(f64::sqrt);
        println!("eta {eta} um, seeds {seeds:?}: rms error of C/omega0/xi {rms:.3?} %");
        assert!(
            within(rms, [limit; 3]),
            "eta {eta}: {rms:?} above {limit} %"
        );
    }
}
