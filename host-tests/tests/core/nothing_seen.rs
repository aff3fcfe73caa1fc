//! Of what was never seen nothing is certain.

use trendid::trends::{FilteredTrends, RawTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::users::figures::{Figures, Part};
use trendid_host_tests::users::kind::Kind;
use trendid_host_tests::users::trial::Trial;

/// A drive that stands on an exact sensor leaves no residual: no parameter is certain for it.
#[test]
fn nothing_seen_is_nothing_known() {
    fn std<T: TrendOperator<3>>(trends: T, memory: Option<f32>) -> [f32; 5] {
        let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
        config.memory = memory;
        let mut identifier: Identifier<T, 3, 5> = Identifier::try_new(&config, trends).unwrap();
        for _ in 0..2000 {
            let _ = identifier.update(0.0, 120.0);
        }
        identifier.estimate().std()
    }
    for memory in [None, Some(2.0)] {
        let filtered = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
        let raw = RawTrends::try_new(Scheme::Tustin, 0.001).unwrap();
        for (name, std) in [
            ("filtered", std(filtered, memory)),
            ("raw", std(raw, memory)),
        ] {
            println!("{name}, memory {memory:?}: {std:?}");
            assert!(std.iter().all(|std| *std > 0.0), "{name}: {std:?}");
        }
    }
}

/// Users of order 4 move the drive slowly, and noise is most of what their rows hold. While a
/// constant of 0 counted as seen there, and the drive as one of the told bandwidth, 5.9 % of their
/// readings were beyond three deviations and 1.5 % beyond ten, of users of order 3 2.2 and 0.3 %.
#[test]
fn a_drive_that_noise_hides_is_not_known() {
    for (kind, limits) in [(Kind::Fourth, [4.0, 0.8]), (Kind::Servo, [1.9, 0.25])] {
        let trials: Vec<_> = (701_001..701_501)
            .map(|seed| Trial::run(seed, Some(kind)))
            .collect();
        let found = Figures::new(&Part::All.readings(&trials));
        println!(
            "{kind:?}: {:.1?} % of {} readings are beyond one to ten deviations, {:.1} % near the truth",
            found.beyond, found.readings, found.good
        );
        let [_, three, _, ten] = found.beyond;
        assert!(three < limits[0] && ten < limits[1], "{found:?}");
    }
}
