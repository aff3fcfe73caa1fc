//! Runs from consecutive seeds.

use crate::format::counted;
use crate::output::Refusal;

/// Most runs of a command.
const RUNS: u64 = 1_000_000;

/// The largest seed: others are reckoned from it.
const LARGEST: u64 = i64::MAX as u64;

/// So many seeds from `first` on; `option` is what asks for their number.
///
/// # Errors
///
/// Too many, or one that is too large.
pub(crate) fn seeds(option: &str, count: u64, first: u64) -> Result<Vec<u64>, Refusal> {
    if !(1..=RUNS).contains(&count) {
        return Err(Refusal::new(format!(
            "{option} {count} is not between 1 and {RUNS}"
        )));
    }
    let highest = LARGEST - (count - 1);
    if first > highest {
        return Err(Refusal::new(format!(
            "--first-seed {first} is too large: at most {highest} for {}",
            counted(count as usize, "seed")
        )));
    }
    Ok((first..first + count).collect())
}
