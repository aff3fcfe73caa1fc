//! Sampling every 5 ms instead of every millisecond: what the default loses of the damping, and the
//! exact hold does not.

use trendid::trends::Scheme;
use trendid::{Config, Structure};
use trendid_host_tests::paper::iterations::own_numerators;
use trendid_host_tests::paper::trial::{Filter, Method, Setting, trial};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::{Condition, Reading};

/// Seeds that chose nothing.
const SEEDS: std::ops::Range<u64> = 920_000..920_100;

/// Length of a record \[s\].
const DURATION: f64 = 0.5;

/// Errors of C, omega0, xi over the seeds \[%\].
struct Spread {
    mean: [f64; 3],
    rms: [f64; 3],
}

impl Spread {
    fn of(name: &str, error: impl Fn(u64) -> [f64; 3]) -> Self {
        let mut spread = Self {
            mean: [0.0; 3],
            rms: [0.0; 3],
        };
        let share = 1.0 / SEEDS.count() as f64;
        for seed in SEEDS {
            let e = error(seed);
            for i in 0..3 {
                spread.mean[i] += share * e[i];
                spread.rms[i] += share * e[i] * e[i];
            }
        }
        spread.rms = spread.rms.map(f64::sqrt);
        println!("{name}: mean {:.4?}, rms {:.4?}", spread.mean, spread.rms);
        spread
    }
}

/// Default, exact hold with the numerators of the filter, and with those of the record's own model.
fn each(condition: Condition) -> [Spread; 3] {
    println!("{condition:?}, {DURATION} s, seeds {SEEDS:?}: errors of C, omega0, xi [%]");
    // The printed figures that go with a setting are not looked at.
    let setting = Setting {
        condition,
        ..Setting::all(Reading::Absolute)[0]
    };
    let core = |filter| {
        move |seed| {
            let method = Method::Core {
                scheme: Scheme::Tustin,
                filter,
                compensated: true,
            };
            trial(&setting, DURATION, seed, &[method]).runs[0].error_pct
        }
    };
    let own = |seed| {
        let record = Experiment::reference(condition, DURATION).record(seed);
        let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
        let theta = own_numerators(&config, &record, 3).unwrap().theta();
        Servo::errors_of(&theta, &REFERENCE)
    };
    [
        Spread::of("  default", core(Filter::Default)),
        Spread::of(
            "  exact hold, numerators of the filter",
            core(Filter::Exact),
        ),
        Spread::of("  exact hold, numerators of the model", own),
    ]
}

/// The rows of Table 1 at 1 and 5 ms: with drift, noise and rounding as printed.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn the_row_at_5_ms_is_as_good_as_the_row_at_1_ms() {
    let row = |dt_ms: f64| {
        let rows = Setting::all(Reading::Absolute);
        let found = rows
            .into_iter()
            .find(|s| s.vary == "sampling" && s.condition.dt_ms == dt_ms);
        each(found.expect("a row").condition)
    };
    let [[fast, ..], [default, exact, own]] = [row(1.0), row(5.0)];
    // The same commands and drifts. White noise and rounding, which a fifth of the samples average,
    // weigh little in C and xi and are all of omega0.
    for (i, most) in [(0, 1.1), (1, 5.0_f64.sqrt()), (2, 1.1)] {
        assert!(
            own.rms[i] < most * fast.rms[i],
            "{:?} {:?}",
            own.rms,
            fast.rms
        );
    }
    assert!(exact.rms[2] < 0.7 * default.rms[2]);
    assert!(default.rms[2] > 1.5 * fast.rms[2]);
}

/// White noise alone: whatever error has a sign is the sampling's.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn damping_has_no_bias_from_5_ms() {
    let condition = Condition {
        dt_ms: 5.0,
        ..Condition::white(10.0)
    };
    let [default, exact, own] = each(condition);
    // The mean of 100 errors is known to a tenth of their scatter.
    for i in 0..3 {
        assert!(own.mean[i].abs() < 0.3 * own.rms[i], "{:?}", own.mean);
    }
    assert!(own.rms[2] < 0.05 * default.rms[2]);
    assert!(exact.mean[2].abs() < 0.5 * default.mean[2].abs());
}
