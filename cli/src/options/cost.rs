//! Cost of an option in instructions.

use serde_json::Value;

use crate::output::Refusal;

/// Where the instructions of an option are counted.
pub(super) enum Cost {
    /// In every sample: one row of the counts with the option, one without.
    Sample {
        with: (&'static str, u64),
        without: (&'static str, u64),
    },
    /// In every sample while the option is in use, then never again.
    Commissioning {
        with: (&'static str, u64),
        without: (&'static str, u64),
    },
    /// In a call that is not made in every sample.
    Call(&'static str),
    /// In every sample one difference of rows, and in every call another row.
    Both {
        with: (&'static str, u64),
        without: (&'static str, u64),
        call: &'static str,
    },
}

/// The counts that `cargo xtask docs --write icount.json` has written.
pub(super) const COUNTS: &str = include_str!("../../../docs/icount.json");

/// Mean of a row at -O3 in instructions.
fn count(counts: &Value, row: &str, n: Option<u64>) -> Result<f64, Refusal> {
    counts
        .as_array()
        .into_iter()
        .flatten()
        .find(|r| r["row"] == row && r["opt"] == "3" && n.is_none_or(|n| r["n"] == n))
        .and_then(|r| r["mean"].as_f64())
        .ok_or_else(|| Refusal::new(format!("the counts of instructions have no row `{row}`")))
}

/// Instructions per sample, and per call.
pub(super) fn instructions(counts: &Value, cost: &Cost) -> Result<[Option<f64>; 2], Refusal> {
    let apart = |with: (&str, u64), without: (&str, u64)| -> Result<f64, Refusal> {
        Ok(count(counts, with.0, Some(with.1))? - count(counts, without.0, Some(without.1))?)
    };
    Ok(match *cost {
        Cost::Sample { with, without } | Cost::Commissioning { with, without } => {
            [Some(apart(with, without)?), None]
        }
        Cost::Call(row) => [None, Some(count(counts, row, None)?)],
        Cost::Both {
            with,
            without,
            call,
        } => [
            Some(apart(with, without)?),
            Some(count(counts, call, None)?),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_cost_is_the_difference_of_two_rows() {
        let counts = json!([
            {"row": "a", "n": 3, "opt": "s", "mean": 9.0},
            {"row": "a", "n": 3, "opt": "3", "mean": 100.0},
            {"row": "b", "n": 4, "opt": "3", "mean": 130.0},
        ]);
        let cost = Cost::Both {
            with: ("b", 4),
            without: ("a", 3),
            call: "b",
        };
        let found = instructions(&counts, &cost).ok();
        assert_eq!(found, Some([Some(30.0), Some(130.0)]));
        assert!(instructions(&counts, &Cost::Call("c")).is_err());
    }
}
