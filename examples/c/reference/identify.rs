//! The identifiers of every kind on the record.

use trendid::estimation::Terms;
use trendid::identifier::{DelayBank, Identifier};
use trendid::inputs::{DeadZone, coulomb};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Outcome, Servo, Structure};
use trendid_example_support::hash::Hash;
use trendid_example_support::record::{SAMPLE_TIME, samples};

use crate::outcome::{take_all, take_outcome};

const EVERY: usize = 10;
const MEMORY: f32 = 0.7;

/// The record through an identifier; `update` gives the outcome, `inputs` of the caller and the
/// dead zone after it.
fn run<const M: usize, const N: usize, const I: usize, const D: usize>(
    name: &str,
    mut identifier: Identifier<FilteredTrends<M>, M, N, I, D>,
    mut update: impl FnMut(
        &mut Identifier<FilteredTrends<M>, M, N, I, D>,
        [f32; 2],
        f32,
    ) -> (Outcome, f32),
) {
    let mut hash = Hash::new();
    let (mut last, mut width) = (0.0, 0.0);
    for (k, (u, y)) in samples().enumerate() {
        let sign = coulomb((y - last) / SAMPLE_TIME, 50.0);
        last = y;
        let (outcome, now) = update(&mut identifier, [u, sign], y);
        width = now;
        take_outcome(&mut hash, outcome);
        take_all(&mut hash, identifier.theta());
        if k % EVERY == EVERY - 1 {
            let found = identifier.estimate();
            let physical = found.physical();
            take_all(&mut hash, found.std());
            hash.take(physical.gain.unwrap_or(0.0));
            hash.take(physical.omega0.unwrap_or(0.0));
            hash.take(physical.damping.unwrap_or(0.0));
            hash.take(found.physical_std().map_or(0.0, |std| std[1]));
        }
    }
    let errors = identifier.prediction_error();
    hash.take(identifier.prediction());
    hash.take(identifier.noise_std().unwrap_or(0.0));
    hash.take(errors.ise());
    hash.take(errors.iae());
    hash.take_bits(errors.samples());
    hash.take_bits(identifier.replaced());
    hash.take(width);
    println!("{name} {hash}");
}

/// An identifier for the record.
fn of<const M: usize, const N: usize, const I: usize, const D: usize>(
    structure: Structure<M, N, I>,
    memory: Option<f32>,
    delay: usize,
) -> Result<Identifier<FilteredTrends<M>, M, N, I, D>, ConfigError> {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?;
    let mut config = Config::new(structure, 20.0, [1.0; I], 50.0);
    config.memory = memory;
    if let Some(first) = config.delays.first_mut() {
        *first = delay;
    }
    Identifier::try_new(&config, trends)
}

/// The record through a valve: the command becomes two inputs.
fn run_valve<const M: usize, const N: usize, const I: usize>(
    name: &str,
    structure: Structure<M, N, I>,
) -> Result<(), ConfigError> {
    let mut zone = DeadZone::new(0.0, 0.1, 300);
    run::<M, N, I, 7>(
        name,
        of(structure, Some(MEMORY), 0)?,
        |identifier, [u, sign], y| {
            let [command, direction] = zone.inputs(u);
            let all = [command, direction, sign];
            let outcome = identifier.update_inputs(std::array::from_fn(|input| all[input]), y);
            let _ = zone.update(identifier);
            (outcome, zone.delta())
        },
    );
    Ok(())
}

fn friction<const N: usize, const I: usize>() -> Result<Structure<3, N, I>, ConfigError> {
    let mut inputs = [Terms::of(&[0]); I];
    inputs[I - 1] = Terms::of(&[1]);
    Structure::try_with_initial_state(Terms::of(&[1, 2]), inputs, true)
}

pub(crate) fn identify() -> Result<(), ConfigError> {
    let forget = Some(MEMORY);
    run::<2, 4, 1, 7>(
        "servo2",
        of(Structure::SERVO, forget, 0)?,
        |id, [u, _], y| (id.update(u, y), 0.0),
    );
    run_valve::<2, 5, 2>("valve2", Structure::SERVO)?;
    run_valve::<3, 6, 2>("valve3", Structure::SERVO)?;
    run::<2, 5, 2, 7>("coulomb2", of(Structure::SERVO, forget, 0)?, |id, u, y| {
        (id.update_inputs(u, y), 0.0)
    });
    run::<3, 6, 2, 7>("coulomb3", of(friction()?, forget, 0)?, |id, u, y| {
        (id.update_inputs(u, y), 0.0)
    });
    run_valve::<2, 6, 3>("valve-coulomb2", Structure::SERVO)?;
    run_valve::<3, 7, 3>("valve-coulomb3", friction()?)?;
    run::<3, 5, 1, 0>("servo3", of(Structure::SERVO, None, 0)?, |id, [u, _], y| {
        (id.update(u, y), 0.0)
    });
    run::<3, 5, 1, 7>("late", of(Structure::SERVO, None, 2)?, |id, [u, _], y| {
        (id.update(u, y), 0.0)
    });
    bank()?;
    run::<3, 6, 1, 0>(
        "any-full3",
        of(Structure::FULL, None, 0)?,
        |id, [u, _], y| (id.update(u, y), 0.0),
    );
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
