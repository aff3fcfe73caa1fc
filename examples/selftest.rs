//! The same numbers everywhere: a record of 5 000 samples through several structures, and a hash of
//! every innovation and every parameter after every sample, and of every standard deviation after
//! every tenth.
//!
//! Each line is `structure hash`; the run succeeds when the lines are those of
//! `examples/data/selftest.txt`. Host and target, debug and release must agree to the last bit.
//! After the arithmetic of the core was changed on purpose, `cargo xtask docs --write selftest.txt`
//! writes the file.
//!
//! ```text
//! cargo run --example selftest                                                   host
//! cargo run -p trendid --target thumbv7em-none-eabihf --example selftest         Cortex-M4F in the emulator, debug
//! cargo fw-run --example selftest                                                the same in release
//! ```
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::Arguments;

use trendid::trends::{Scheme, TrendOperator};
use trendid::{ConfigError, Identifier, Outcome};
use trendid_example_support::hash::Hash;
use trendid_example_support::{record, rows};

/// The lines that must come out.
const EXPECTED: &str = include_str!("data/selftest.txt");

/// Here a NaN is put in: it must be refused and leave no trace.
const BAD: usize = 2500;

/// Standard deviations are read this often: they cost more than an update, above all without
/// floating-point unit.
const EVERY: usize = 10;

/// Runs the record through one identifier.
fn run<
    T: TrendOperator<M> + PartialEq,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
>(
    mut identifier: Identifier<T, M, N, I, D>,
    inputs: impl Fn(f32) -> [f32; I],
) -> Hash {
    let mut hash = Hash::new();
    for (k, (u, y)) in record::samples().enumerate() {
        if k == BAD {
            let refused = matches!(
                identifier.update_inputs(inputs(u), f32::NAN),
                Outcome::Refused(_)
            );
            hash.take(if refused { 1.0 } else { 0.0 });
        }
        // The kind of the outcome counts too.
        hash.take(match identifier.update_inputs(inputs(u), y) {
            Outcome::WarmingUp { remaining } => remaining as f32,
            Outcome::Refused(_) => -1.0,
            Outcome::Held { innovation } => innovation + 1.0,
            Outcome::Estimated { innovation } => innovation,
            _ => -2.0,
        });
        hash.take(identifier.prediction());
        for number in identifier.theta() {
            hash.take(number);
        }
        if k % EVERY == EVERY - 1 {
            for number in identifier.estimate().std() {
                hash.take(number);
            }
        }
    }
    hash
}

/// One structure, in a frame of its own: the smallest memory has no room for all of them on the
/// stack.
#[inline(never)]
fn part<
    T: TrendOperator<M> + PartialEq,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
>(
    line: &mut impl FnMut(Arguments<'_>),
    name: &str,
    identifier: impl FnOnce() -> Result<Identifier<T, M, N, I, D>, ConfigError>,
    inputs: impl Fn(f32) -> [f32; I],
) -> Result<(), ConfigError> {
    line(format_args!("{name} {}", run(identifier()?, inputs)));
    Ok(())
}

/// All structures; `line` gets each result.
fn all(line: &mut impl FnMut(Arguments<'_>)) -> Result<(), ConfigError> {
    let one = |u| [u];
    part(line, "raw-goodwin", || rows::raw(Scheme::Goodwin), one)?;
    part(line, "raw-tustin", || rows::raw(Scheme::Tustin), one)?;
    part(
        line,
        "filtered-goodwin",
        || rows::filtered(Scheme::Goodwin),
        one,
    )?;
    part(
        line,
        "filtered-tustin",
        || rows::filtered(Scheme::Tustin),
        one,
    )?;
    part(line, "forgetting", rows::forgetting, one)?;
    part(line, "constant", rows::offset, one)?;
    part(line, "late", rows::late, one)?;
    part(line, "dead-zone", rows::dead_zoned, rows::dead_zone_inputs)?;
    part(line, "full", rows::full, one)
}

/// Compares each line as it comes with the next of the expected ones.
struct Judge {
    expected: core::str::Lines<'static>,
    success: bool,
}

impl Judge {
    fn new() -> Self {
        Self {
            expected: EXPECTED.lines(),
            success: true,
        }
    }

    /// Whether `line` is the next of the expected lines.
    fn next(&mut self, line: &str) -> bool {
        let same = self.expected.next() == Some(line);
        self.success &= same;
        same
    }

    /// Whether all lines came, and nothing else.
    fn end(&mut self) -> bool {
        self.success && self.expected.next().is_none()
    }
}

#[cfg(target_os = "none")]
mod target {
    use core::fmt::Write;

    use cortex_m_rt::entry;
    use heapless::String;
    use trendid_example_support::board::{exit, line};

    use super::{Judge, all};

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        line(format_args!("{info}"));
        exit(false)
    }

    #[entry]
    fn main() -> ! {
        let mut judge = Judge::new();
        let done = all(&mut |arguments| {
            let mut text = String::<64>::new();
            let written = text.write_fmt(arguments).is_ok();
            let same = judge.next(&text) && written;
            line(format_args!("{text}{}", if same { "" } else { " DIFFERS" }));
        });
        exit(done.is_ok() && judge.end())
    }
}

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut judge = Judge::new();
    all(&mut |arguments| {
        let line = arguments.to_string();
        println!("{line}{}", if judge.next(&line) { "" } else { " DIFFERS" });
    })?;
    if judge.end() {
        Ok(())
    } else {
        Err("the numbers differ from examples/data/selftest.txt".into())
    }
}

/// The host part of the same check, in the debug and the release run of the tests.
#[cfg(all(test, not(target_os = "none")))]
#[test]
fn the_host_gives_the_expected_bits() {
    let mut judge = Judge::new();
    all(&mut |arguments| {
        let line = arguments.to_string();
        assert!(judge.next(&line), "{line}");
    })
    .expect("the structures are valid");
    assert!(judge.end());
}
