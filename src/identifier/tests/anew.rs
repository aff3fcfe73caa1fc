//! What begins again, and with what.

use super::bench::{Drive, Trends, config, identifier, trained, trends};
use crate::estimation::beginning::Beginning;
use crate::estimation::structure::Structure;
use crate::identifier::{Config, Identifier};

#[test]
fn a_recursion_that_begins_again_has_its_first_values_and_no_sums() {
    let fresh = identifier(&config());
    let (mut found, _) = trained(&config(), 2000);
    assert_ne!(found.state.beginning, Beginning::new(true));
    assert_ne!(found.estimator().theta(), fresh.estimator().theta());
    found.state.unlearn(&found.plan);
    assert_eq!(found.state.beginning, Beginning::new(true));
    assert_eq!(found.estimator().theta(), fresh.estimator().theta());
    for i in 0..3 {
        let [again, first] = [&found, &fresh].map(|of| of.estimator().covariance(i, i));
        assert!((again / first - 1.0).abs() < 1e-6, "{i}: {again} {first}");
    }
}

#[test]
fn a_warm_start_keeps_sums_where_no_initial_state_stands_for_them() {
    let (mut found, _) = trained(&config(), 2000);
    let theta = [400.0, 20.0, 1e6];
    found.warm_start(theta, [4.0, 0.2, 1e4]).unwrap();
    assert_eq!(found.state.beginning, Beginning::new(true));

    type Servo5 = Identifier<Trends, 3, 5, 1, 0>;
    let config = Config::new(Structure::SERVO, 20.0, [0.4], 50.0);
    let mut found = Servo5::try_new(&config, trends(20.0)).unwrap();
    let mut drive = Drive::new(1e-4);
    for k in 0..500 {
        let [u, y] = drive.sample(k);
        let _ = found.update(u, y);
    }
    let theta = [400.0, 20.0, 1e6, 0.0, 0.0];
    found.warm_start(theta, [4.0, 0.2, 1e4, 1e4, 0.1]).unwrap();
    assert_eq!(found.state.beginning, Beginning::new(false));
}

#[test]
fn what_is_known_remains_so_and_nothing_else() {
    let (mut found, _) = trained(&config(), 500);
    let seen = found.estimator().samples();
    assert!(seen > 100.0);
    for (rows, left) in [(0.5 * seen, 0.0), (2.0 * seen, 2.0 * seen)] {
        found.state.known_rows = rows;
        found.state.remain_known();
        assert_eq!(found.state.known_rows, left);
    }
}
