//! Bytes that stand for calls, and what must hold whatever they are.
//!
//! | target | what the bytes are | what holds |
//! |---|---|---|
//! | [`identifier`] | settings, then any sequence of calls | nothing that is not finite leaves it; a call that is refused changes no bit; what a refused sample said does not matter |
//! | [`servo_loop`] | settings, then readings, requests, faults, missing slots | command finite, in its range and within its rate; setpoint finite and in the travel |
//! | [`link`] | bytes of a line, sent frames among them | no message that nobody sent; replies finite |
//! | [`store`] | what a flash holds, then saves that lose power | the model before or the model after; nothing outside the two sectors; what is loaded controls or is refused |
//! | [`record`] | a file | numbers that are finite, or one error |
//! | [`drivers`] | what buses and timers answer | position within its bits, command as it was set, no pulse of the wrong sign |
//!
//! `cargo xtask fuzz` lets libFuzzer look for bytes that break this; `tests/corpus.rs` runs what it
//! has found, and bytes by chance, with every other test. One input again:
//! `cargo run -p trendid-fuzz --bin identifier FILE`.

pub mod bytes;
pub mod drivers;
pub mod identifier;
pub mod link;
pub mod record;
mod servo_bench;
pub mod servo_loop;
mod servo_settings;
pub mod store;
mod targets;

// The reader of the command line, which is a program and no library.
#[path = "../../cli/src/format.rs"]
#[allow(dead_code, reason = "the reader needs a part of it")]
mod format;
#[path = "../../cli/src/record/mod.rs"]
#[allow(dead_code, reason = "as above")]
mod reader;

pub use targets::{TARGETS, Target};

/// Runs a target on the files that are named on the command line.
///
/// # Panics
/// When a file cannot be read, or something does not hold.
pub fn replay(target: Target) {
    for path in std::env::args_os().skip(1) {
        let shown = path.to_string_lossy().into_owned();
        let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{shown}: {error}"));
        println!("{shown}: {} bytes", bytes.len());
        target(&bytes);
    }
}

/// The program of a target: with the fuzzer, or for single files.
#[macro_export]
macro_rules! target {
    ($run:path) => {
        #[cfg(fuzzing)]
        libfuzzer_sys::fuzz_target!(|bytes: &[u8]| $run(bytes));
        #[cfg(not(fuzzing))]
        fn main() {
            $crate::replay($run);
        }
    };
}
