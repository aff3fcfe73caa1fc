//! What one sample did, in a hash.

use trendid::Outcome;
use trendid::identifier::Refusal;
use trendid_example_support::hash::Hash;

pub(crate) fn take_all<const N: usize>(hash: &mut Hash, numbers: [f32; N]) {
    for number in numbers {
        hash.take(number);
    }
}

/// Number, samples that remain and innovation of an outcome, as the C interface has them.
pub(crate) fn parts(outcome: Outcome) -> (u32, u32, f32) {
    match outcome {
        Outcome::WarmingUp { remaining } => (0, remaining, 0.0),
        Outcome::Refused(Refusal::Input(_)) => (1, 0, 0.0),
        Outcome::Refused(_) => (2, 0, 0.0),
        Outcome::Replaced { innovation } => (3, 0, innovation),
        Outcome::Held { innovation } => (4, 0, innovation),
        Outcome::Estimated { innovation } => (5, 0, innovation),
        _ => (6, 0, 0.0),
    }
}

pub(crate) fn take_outcome(hash: &mut Hash, outcome: Outcome) {
    let (kind, remaining, innovation) = parts(outcome);
    hash.take_bits(kind);
    hash.take_bits(remaining);
    hash.take(innovation);
}
