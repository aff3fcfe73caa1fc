//! What else may be known of a drive, and the identifiers with instruments.

use trendid::identifier::Identifier;
use trendid::inputs::Coulomb;
use trendid::instruments::{Instrumented, Way, rows};
use trendid::trends::{FilteredTrends, Hold};
use trendid::{ConfigError, Estimate, Structure};
use trendid_example_support::record::SAMPLE_TIME;

use crate::identify::{Core, MEMORY, REST, alone, friction, run, settings};

/// A command between two samples with a damping that is known, changes that are followed, and an
/// axis that may stick.
pub(crate) fn known() -> Result<(), ConfigError> {
    let (mut config, trends) = settings(Structure::SERVO, None, 0)?;
    config.holds = [Hold::First];
    config.set_delay(0, 1.5);
    config.known[1] = true;
    config.initial[1] = 20.0;
    alone::<3, 5, 1, 7>("known", (config, trends), |id, [u, _], y| id.update(u, y))?;

    let (mut config, trends) = settings(Structure::SERVO, Some(MEMORY), 0)?;
    config.follow_changes = true;
    alone::<3, 5, 1, 7>("changes", (config, trends), |id, [u, _], y| id.update(u, y))?;

    let (mut config, trends) = settings(friction()?, Some(MEMORY), 0)?;
    config.friction_input = Some(1);
    config.holds[1] = Hold::Mean;
    let (mut sign, mut last) = (Coulomb::new(REST), 0.0);
    alone::<3, 6, 2, 7>("sticks", (config, trends), move |id, [u, _], y| {
        let mean = sign.update((y - last) / SAMPLE_TIME);
        last = y;
        id.update_inputs([u, mean], y)
    })
}

impl<const M: usize, const N: usize, const R: usize, const D: usize> Core<M, N, 1, D>
    for Instrumented<FilteredTrends<M>, M, N, 1, R, D>
{
    fn identifier(&self) -> &Identifier<FilteredTrends<M>, M, N, 1, D> {
        Self::identifier(self)
    }

    fn estimate(&self) -> Estimate<M, N, 1> {
        Self::estimate(self).estimate
    }

    fn theta(&self) -> [f32; N] {
        Core::estimate(self).theta()
    }

    fn way(&self) -> u32 {
        match Self::estimate(self).way {
            Way::Instruments => 1,
            Way::TooFewBlocks => 2,
            Way::WeakInstruments => 3,
            _ => 0,
        }
    }

    fn blocks(&self) -> f32 {
        Self::estimate(self).effective_blocks
    }
}

/// The record with instruments beside the recursion.
pub(crate) fn instruments() -> Result<(), ConfigError> {
    let (config, trends) = settings(Structure::<2, 4, 1>::SERVO, None, 0)?;
    const TWO: usize = rows(&Structure::<2, 4, 1>::SERVO);
    let core: Instrumented<_, 2, 4, 1, TWO, 7> = Instrumented::try_new(&config, trends)?;
    run("instrumented2", core, |core, [u, _], y| {
        (core.update(u, y), 0.0)
    });
    let (config, trends) = settings(Structure::<3, 5, 1>::SERVO, None, 0)?;
    const THREE: usize = rows(&Structure::<3, 5, 1>::SERVO);
    let core: Instrumented<_, 3, 5, 1, THREE, 7> = Instrumented::try_new(&config, trends)?;
    run("instrumented3", core, |core, [u, _], y| {
        (core.update(u, y), 0.0)
    });
    Ok(())
}
