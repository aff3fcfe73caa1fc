//! The first ten lines: a drive that integrates, identified at 1 kHz.
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};

fn main() -> Result<(), trendid::ConfigError> {
    let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [30.0])?;
    let config = Config::new(Structure::<1, 1, 1>::INTEGRATING, 30.0, [1.0], 1.0);
    let mut identifier: Identifier<_, 1, 1> = Identifier::try_new(&config, trends)?;
    let mut y = 0.0;
    for k in 0..1000 {
        let u = if k % 200 < 100 { 0.5 } else { -0.5 }; // your command
        let _outcome = identifier.update(u, y); // your position
        y += 0.001 * 2.5 * u; // the drive itself: 2.5 m/s per unit of u
    }
    let gain = identifier.estimate().physical().gain.unwrap_or(0.0);
    assert!((gain - 2.5).abs() < 1e-3, "velocity gain {gain}");
    Ok(())
}
