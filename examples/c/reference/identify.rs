//! The identifiers of every kind on the record.

use trendid::estimation::Terms;
use trendid::identifier::{DelayBank, Identifier};
use trendid::inputs::{DeadZone, Valved, coulomb};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Estimate, Outcome, Servo, Structure};
use trendid_example_support::hash::Hash;
use trendid_example_support::record::{SAMPLE_TIME, samples};

use crate::outcome::{take_all, take_outcome};

const EVERY: usize = 10;
pub(crate) const MEMORY: f32 = 0.7;
/// Velocity within which the axis is at rest, in mm/s.
pub(crate) const REST: f32 = 50.0;

/// An identifier, alone, behind a valve or with instruments.
pub(crate) trait Core<const M: usize, const N: usize, const I: usize, const D: usize> {
    fn identifier(&self) -> &Identifier<FilteredTrends<M>, M, N, I, D>;
    fn estimate(&self) -> Estimate<M, N, I>;

    fn theta(&self) -> [f32; N] {
        self.identifier().theta()
    }

    /// What the estimate rests on, as the C interface has it.
    fn way(&self) -> u32 {
        0
    }

    fn blocks(&self) -> f32 {
        0.0
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Core<M, N, I, D>
    for Identifier<FilteredTrends<M>, M, N, I, D>
{
    fn identifier(&self) -> &Self {
        self
    }

    fn estimate(&self) -> Estimate<M, N, I> {
        Self::estimate(self)
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Core<M, N, I, D>
    for Valved<FilteredTrends<M>, M, N, I, D>
{
    fn identifier(&self) -> &Identifier<FilteredTrends<M>, M, N, I, D> {
        Self::identifier(self)
    }

    fn estimate(&self) -> Estimate<M, N, I> {
        Self::estimate(self)
    }
}

/// The record through an identifier; `update` gives the outcome, `inputs` of the caller and the
/// dead zone after it.
pub(crate) fn run<C, const M: usize, const N: usize, const I: usize, const D: usize>(
    name: &str,
    mut core: C,
    mut update: impl FnMut(&mut C, [f32; 2], f32) -> (Outcome, f32),
) where
    C: Core<M, N, I, D>,
{
    let mut hash = Hash::new();
    let (mut last, mut width) = (0.0, 0.0);
    for (k, (u, y)) in samples().enumerate() {
        let sign = coulomb((y - last) / SAMPLE_TIME, REST);
        last = y;
        let (outcome, now) = update(&mut core, [u, sign], y);
        width = now;
        take_outcome(&mut hash, outcome);
        take_all(&mut hash, core.theta());
        if k % EVERY == EVERY - 1 {
            let found = core.estimate();
            let physical = found.physical();
            take_all(&mut hash, found.std());
            hash.take(physical.gain.unwrap_or(0.0));
            hash.take(physical.omega0.unwrap_or(0.0));
            hash.take(physical.damping.unwrap_or(0.0));
            hash.take(found.physical_std().map_or(0.0, |std| std[1]));
        }
    }
    let identifier = core.identifier();
    let errors = identifier.prediction_error();
    hash.take(identifier.prediction());
    hash.take(identifier.noise_std().unwrap_or(0.0));
    hash.take(errors.ise());
    hash.take(errors.iae());
    hash.take_bits(errors.samples());
    hash.take_bits(identifier.replaced());
    hash.take_bits(identifier.changes());
    hash.take(width);
    hash.take_bits(core.way());
    hash.take(core.blocks());
    for pole in core.estimate().transfer_function().poles().iter().flatten() {
        take_all(&mut hash, [pole.re, pole.im]);
    }
    println!("{name} {hash}");
}

/// Settings and trends for the record.
pub(crate) fn settings<const M: usize, const N: usize, const I: usize>(
    structure: Structure<M, N, I>,
    memory: Option<f32>,
    delay: usize,
) -> Result<(Config<M, N, I>, FilteredTrends<M>), ConfigError> {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?;
    let mut config = Config::new(structure, 20.0, [1.0; I], 50.0);
    config.memory = memory;
    if let Some(first) = config.delays.first_mut() {
        *first = delay;
    }
    Ok((config, trends))
}

/// The record through an identifier alone.
pub(crate) fn alone<const M: usize, const N: usize, const I: usize, const D: usize>(
    name: &str,
    (config, trends): (Config<M, N, I>, FilteredTrends<M>),
    mut update: impl FnMut(&mut Identifier<FilteredTrends<M>, M, N, I, D>, [f32; 2], f32) -> Outcome,
) -> Result<(), ConfigError> {
    let core = Identifier::try_new(&config, trends)?;
    run(name, core, |core, u, y| (update(core, u, y), 0.0));
    Ok(())
}

/// The record through a valve: the command becomes two inputs.
fn run_valve<const M: usize, const N: usize, const I: usize>(
    name: &str,
    structure: Structure<M, N, I>,
) -> Result<(), ConfigError> {
    let zone = DeadZone::new(0.0, 0.1, 300);
    let (config, trends) = settings(structure, Some(MEMORY), 0)?;
    let core: Valved<_, M, N, I, 7> = Valved::try_new(&config, trends, zone)?;
    run(name, core, |core, [u, sign], y| {
        let outcome = core.update_inputs(u, [sign; I], y);
        (outcome, core.dead_zone().delta())
    });
    Ok(())
}

pub(crate) fn friction<const N: usize, const I: usize>() -> Result<Structure<3, N, I>, ConfigError>
{
    let mut inputs = [Terms::of(&[0]); I];
    inputs[I - 1] = Terms::of(&[1]);
    Structure::try_with_initial_state(Terms::of(&[1, 2]), inputs, true)
}

pub(crate) fn identify() -> Result<(), ConfigError> {
    let forget = Some(MEMORY);
    alone::<2, 4, 1, 7>(
        "servo2",
        settings(Structure::SERVO, forget, 0)?,
        |id, [u, _], y| id.update(u, y),
    )?;
    run_valve::<2, 5, 2>("valve2", Structure::SERVO)?;
    run_valve::<3, 6, 2>("valve3", Structure::SERVO)?;
    alone::<2, 5, 2, 7>(
        "coulomb2",
        settings(Structure::SERVO, forget, 0)?,
        |id, u, y| id.update_inputs(u, y),
    )?;
    alone::<3, 6, 2, 7>("coulomb3", settings(friction()?, forget, 0)?, |id, u, y| {
        id.update_inputs(u, y)
    })?;
    run_valve::<2, 6, 3>("valve-coulomb2", Structure::SERVO)?;
    run_valve::<3, 7, 3>("valve-coulomb3", friction()?)?;
    alone::<3, 5, 1, 0>(
        "servo3",
        settings(Structure::SERVO, None, 0)?,
        |id, [u, _], y| id.update(u, y),
    )?;
    alone::<3, 5, 1, 7>(
        "late",
        settings(Structure::SERVO, None, 2)?,
        |id, [u, _], y| id.update(u, y),
    )?;
    bank()?;
    alone::<3, 6, 1, 0>(
        "any-full3",
        settings(Structure::FULL, None, 0)?,
        |id, [u, _], y| id.update(u, y),
    )?;
    Ok(())
}

fn bank() -> Result<(), ConfigError> {
    let mut bank = DelayBank::<Servo<7>, 8>::new(SAMPLE_TIME, 20.0, 1.0, 50.0)?;
    let mut hash = Hash::new();
    for (u, y) in samples() {
        take_outcome(&mut hash, bank.update(u, y));
    }
    hash.take_bits(bank.best().map_or(u32::MAX, |delay| delay as u32));
    hash.take(bank.margin().unwrap_or(0.0));
    hash.take(bank.refined().unwrap_or(0.0));
    take_all(
        &mut hash,
        bank.errors().map(|error| error.unwrap_or(f32::INFINITY)),
    );
    if let Some(chosen) = bank.chosen() {
        take_all(&mut hash, chosen.theta());
    }
    println!("delay-bank {hash}");
    Ok(())
}
