//! From an estimate to the next trends: numerators from the round before.

use trendid::trends::ExactTrends;
use trendid::{Config, ConfigError, Identifier};

use crate::signals::experiment::Record;

/// The servo identified with [`ExactTrends`] in several rounds over a record.
///
/// The first round has the filter for a model, each further one what the round before found. The
/// bandwidth of `config` chooses the filter, the same in every round.
///
/// # Errors
/// Those of the core for the configuration, and [`ConfigError::TooFast`] for a model beyond the
/// sampling.
pub fn own_numerators(
    config: &Config<3, 5, 1>,
    record: &Record,
    rounds: usize,
) -> Result<Identifier<ExactTrends<3>, 3, 5>, ConfigError> {
    let filter = ExactTrends::for_bandwidth(record.dt as f32, config.bandwidth)?;
    let mut identifier = Identifier::try_new(config, filter.clone())?;
    for round in 0..rounds {
        if round > 0 {
            let own = filter.with_model(identifier.estimate().transfer_function().a)?;
            identifier = Identifier::try_new(config, own)?;
        }
        for s in record.samples() {
            let _ = identifier.update(s.u as f32, s.y as f32);
        }
    }
    Ok(identifier)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::servo::{REFERENCE, Servo};
    use crate::signals::experiment::Experiment;
    use crate::signals::noise::Condition;
    use trendid::Structure;

    #[test]
    fn every_round_is_nearer_without_noise() {
        let slow = Condition {
            dt_ms: 5.0,
            ..Condition::CLEAN
        };
        let record = Experiment::reference(slow, 1.0).record(4);
        let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
        let worst = [1, 2, 3].map(|rounds| {
            let theta = own_numerators(&config, &record, rounds).unwrap().theta();
            let [a1, a2, b0] = [0, 1, 2].map(|i| f64::from(theta[i]));
            let found = Servo::from_coefficients(a1, a2, b0).expect("a servo");
            let errors = found.error_pct(&REFERENCE);
            errors.iter().fold(0.0_f64, |worst, e| worst.max(e.abs()))
        });
        assert!(worst[1] < 0.2 * worst[0] && worst[2] < 5e-4, "{worst:?}");
    }
}
