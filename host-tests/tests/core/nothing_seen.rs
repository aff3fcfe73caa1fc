//! Of what was never seen nothing is certain.

use trendid::trends::{FilteredTrends, RawTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};

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
