//! Instructions per `update` on an emulated Cortex-M, cycles on a board; wall time per update on
//! the host.
//!
//! `cargo xtask icount` runs it in the emulator and prints the table with code size, memory and
//! stack. The image writes one line `row;function;n;mean;worst;systick;stack;ram` per row, behind
//! comment lines that begin with `#`.
//!
//! What is counted is the function of the row from its first instruction to its return, as a user
//! calls it.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod functions;
mod meter;
mod position_loop;
#[cfg(target_os = "none")]
mod target;
// The wire is built for this core alone.
#[cfg(all(target_os = "none", target_abi = "eabihf"))]
mod telemetry;

use functions::{
    bare, bounded, row_bank, row_bare_3, row_bare_4, row_bare_5, row_bare_6, row_batched,
    row_batches, row_bounded_3, row_bounded_4, row_bounded_5, row_bounded_6, row_constant,
    row_dead_zone, row_default, row_estimate, row_exact, row_exact_estimate, row_filtered,
    row_full, row_instruments, row_integral, row_nothing, row_raw, row_reading, row_readings,
    row_retune, row_servo, row_std, row_valved,
};
use meter::Meter;
use position_loop::{Still, motion, servo};
use trendid::instruments::Reading;
use trendid::trends::{FilteredTrends, Scheme};
use trendid_example_support::drive::SimulatedValve;
use trendid_example_support::random::Random;
use trendid_example_support::{record, rows};

/// How often the record is run: 10 000 samples.
const ROUNDS: usize = 2;

/// The record as often as it is run. Each round goes on where the round before ended.
fn samples() -> impl Iterator<Item = (f32, f32)> {
    let end = record::samples().last().map_or(0.0, |(_, y)| y);
    (0..ROUNDS)
        .flat_map(move |round| record::samples().map(move |(u, y)| (u, y + end * round as f32)))
}

/// Regressors of independent numbers in -1..1 and what the parameters 1, 2, .. make of them, with
/// noise.
fn rows_of_numbers<const N: usize>() -> impl Iterator<Item = ([f32; N], f32)> {
    let mut random = Random::new(1);
    (0..ROUNDS * record::SAMPLES).map(move |_| {
        let mut number = || 2.0 * random.unit() - 1.0;
        let phi: [f32; N] = core::array::from_fn(|_| number());
        let mut psi = 0.01 * number();
        for (j, x) in phi.iter().enumerate() {
            psi += (j + 1) as f32 * x;
        }
        (phi, psi)
    })
}

/// The rows of a table: name, n, function, state, samples. `*` for a function that takes its input
/// by value.
macro_rules! rows {
    ($meter:ident; $($name:literal, $n:literal, $by:tt $function:ident, $state:expr, $samples:expr;)*) => {$(
        $meter.row($name, stringify!($function), $n, $state, $samples, rows!($by $function));
    )*};
    (* $function:ident) => { |s, &u, y| $function(s, u, y) };
    (& $function:ident) => { $function };
}

fn all(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    structures(meter)?;
    // A Cortex-M0 (no atomic exchange) has no room for several copies of a long window, and its
    // emulation of two loops takes minutes.
    if cfg!(target_has_atomic = "32") {
        span(meter)?;
        position_loop(meter, "whole position loop", 30_000, true);
        position_loop(meter, "position loop, one load", 10_000, false);
    }
    options(meter)?;
    // As for the span: eight identifiers are too many for the smallest memory, and its emulation
    // takes minutes as it is.
    if cfg!(target_has_atomic = "32") {
        exact_and_bank(meter)?;
        debt(meter)?;
        now_and_then(meter)?;
        instruments(meter)?;
        batches(meter)?;
    }
    #[cfg(all(target_os = "none", target_abi = "eabihf"))]
    telemetry::rows(meter, samples(), samples().take(CALLS));
    // Their code is the largest: 256 KiB have no room for it beside the others.
    if cfg!(target_has_atomic = "32") {
        largest(meter)?;
    }
    estimators(meter);
    bounded_estimators(meter);
    Ok(())
}

// All states of a function lie on the stack: a few rows in each, for the smallest memory.

#[inline(never)]
fn structures(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "nothing", 0, *row_nothing, (), samples();
        "raw Goodwin", 3, *row_raw, rows::raw(Scheme::Goodwin)?, samples();
        "raw Tustin", 3, *row_raw, rows::raw(Scheme::Tustin)?, samples();
        "filtered Tustin", 3, *row_filtered, rows::filtered(Scheme::Tustin)?, samples();
        "default", 5, *row_default, rows::default()?, samples();
        "default with memory", 5, *row_default, rows::following()?, samples();
    }
    Ok(())
}

#[inline(never)]
fn options(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "with start", 4, *row_constant, rows::started()?, samples();
        "with constant", 4, *row_constant, rows::offset()?, samples();
        "with dead zone", 5, *row_dead_zone, rows::dead_zoned()?, samples();
    }
    Ok(())
}

#[inline(never)]
fn largest(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "dead zone measured", 5, *row_valved, rows::valved()?, samples();
        "order 3 full", 6, *row_full, rows::full()?, samples();
    }
    Ok(())
}

#[inline(never)]
fn estimators(meter: &mut impl Meter) {
    rows! { meter;
        "bare estimator", 3, &row_bare_3, bare(), rows_of_numbers();
        "bare estimator", 4, &row_bare_4, bare(), rows_of_numbers();
        "bare estimator", 5, &row_bare_5, bare(), rows_of_numbers();
        "bare estimator", 6, &row_bare_6, bare(), rows_of_numbers();
    }
}

#[inline(never)]
fn bounded_estimators(meter: &mut impl Meter) {
    rows! { meter;
        "bare, bounded at rest", 3, &row_bounded_3, bounded(), rows_of_numbers();
        "bare, bounded at rest", 4, &row_bounded_4, bounded(), rows_of_numbers();
        "bare, bounded at rest", 5, &row_bounded_5, bounded(), rows_of_numbers();
        "bare, bounded at rest", 6, &row_bounded_6, bounded(), rows_of_numbers();
    }
}

#[inline(never)]
fn span(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "over a span of 70", 3, *row_integral, rows::integral()?, samples();
    }
    Ok(())
}

#[inline(never)]
fn position_loop(meter: &mut impl Meter, name: &str, samples: usize, loads: bool) {
    if let (Ok(mut leader), Ok(follower)) = (servo(SimulatedValve), servo(Still)) {
        let moves = motion(&mut leader, samples, loads);
        meter.row(name, "row_servo", 6, follower, moves, rows!(*row_servo));
    }
}

#[inline(never)]
fn exact_and_bank(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "default, exact hold", 5, *row_exact, rows::exact()?, samples();
        "delay bank of 8", 5, *row_bank, rows::bank()?, samples();
    }
    Ok(())
}

#[inline(never)]
fn instruments(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "default with instruments", 5, *row_instruments, rows::instrumented()?, samples();
    }
    let mut instrumented = rows::instrumented()?;
    for (u, y) in record::samples() {
        let _ = row_instruments(&mut instrumented, u, y);
    }
    let calls = record::samples().take(CALLS);
    rows! { meter;
        "instruments, per step of 36", 5, *row_reading, (instrumented, Reading::new()), calls;
    }
    Ok(())
}

#[inline(never)]
fn batches(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "default with blocks", 5, *row_batched, rows::batched()?, samples();
    }
    let mut batched = rows::batched()?;
    for (u, y) in record::samples() {
        let _ = row_batched(&mut batched, u, y);
    }
    let calls = record::samples().take(CALLS);
    rows! { meter;
        "deviations by blocks", 5, *row_batches, batched, calls;
    }
    Ok(())
}

/// The samples in which a debt of forgetting is called in: a motion behind a long rest, of a drive
/// that has changed meanwhile.
#[inline(never)]
fn debt(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    /// Ends of a motion, of the rest behind it, and of the next motion, in samples.
    const ENDS: [u32; 3] = [5000, 20_000, 21_000];
    /// The one that contradicts, one for each parameter, and the next.
    const CALLED: usize = 7;
    let mut identifier = rows::following()?;
    // The reference drive in steps of Euler, with a noise of 0.1 um; behind the rest with ten times
    // the gain.
    let ([mut x, mut velocity, mut acceleration], mut random) = ([0.0_f32; 3], Random::new(1));
    // Before the last two samples, these, and then those that follow.
    let (mut before, mut calls, mut seen) = ([None, None], [(0.0, 0.0); CALLED], 0);
    for k in 0..ENDS[2] {
        let y = x + 1e-4 * (random.unit() - 0.5);
        let (u, gain) = match k {
            _ if k < ENDS[0] => ([-0.4, 0.4][(k / 50 * k / 50 % 7 % 2) as usize], 1e6),
            _ if k < ENDS[1] => (0.0, 1e6),
            _ => (0.4, 1e7),
        };
        let jerk = gain * u - 20.0 * acceleration - 400.0 * velocity;
        acceleration += jerk * record::SAMPLE_TIME;
        velocity += acceleration * record::SAMPLE_TIME;
        x += velocity * record::SAMPLE_TIME;
        let learnt = identifier.estimator().samples();
        if k > ENDS[1] && seen == 0 {
            before = [before[1].take(), Some(identifier.clone())];
            calls[0] = calls[1];
        }
        let _ = row_default(&mut identifier, u, y);
        calls[seen.max(1)] = (u, y);
        let begins = seen == 0 && identifier.estimator().samples() < 0.5 * learnt;
        seen = match seen {
            0 => 2 * usize::from(begins),
            seen => seen + 1,
        };
        if seen == CALLED {
            break;
        }
    }
    if let ([Some(before), _], CALLED) = (before, seen) {
        rows! { meter;
            "default, debt called in", 5, *row_default, before, calls.into_iter();
        }
    }
    Ok(())
}

/// What is asked for now and then, not in every sample: each call counted, after the record has
/// been seen once.
#[inline(never)]
fn now_and_then(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    let calls = || record::samples().take(CALLS);
    let (mut default, mut exact) = (rows::default()?, rows::exact()?);
    for (u, y) in record::samples() {
        // The counted functions themselves: a second copy of an update would change how both are
        // compiled.
        let _ = row_default(&mut default, u, y);
        let _ = row_exact(&mut exact, u, y);
    }
    rows! { meter;
        "estimate, per call", 5, *row_estimate, default.clone(), calls();
        "deviations, per call", 5, *row_std, default.clone(), calls();
        "all readings, per call", 5, *row_readings, default.clone(), calls();
        "exact estimate, per call", 5, *row_exact_estimate, exact, calls();
    }
    let behind =
        |bandwidth| FilteredTrends::for_bandwidth(Scheme::Tustin, record::SAMPLE_TIME, bandwidth);
    let filters = [behind(22.0)?, behind(18.0)?];
    rows! { meter;
        "retune, per call", 5, *row_retune, (default, filters), calls();
    }
    Ok(())
}

/// How often a call that is not made in every sample is counted.
const CALLS: usize = 200;

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), trendid::ConfigError> {
    println!(
        "this machine, wall time; `cargo xtask icount` counts instructions on the emulated target"
    );
    all(&mut meter::Stopwatch)
}
