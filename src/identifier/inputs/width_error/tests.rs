//! The sums, and how they follow a width that becomes smaller.

use super::*;
use crate::trends::{Chain, FilteredTrends, Scheme};

type Error = WidthError<Chain<3>, 2>;

impl<const N: usize> WidthError<Chain<3>, N> {
    /// Whether every number is 0 or one that f32 holds with all its digits.
    pub(crate) fn is_normal(&self) -> bool {
        let states = self.memory.iter().flat_map(|memory| &memory.states);
        let mut numbers = self.scores.iter().chain(states);
        numbers.all(|value| *value == 0.0 || value.is_normal())
    }
}

fn trends() -> FilteredTrends<3> {
    FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap()
}

/// So many samples of a command, each a row (1, 2).
fn take(error: &mut Error, u: f32, samples: usize, trends: &FilteredTrends<3>) {
    let mut seen = Seen {
        error,
        trends,
        hold: Hold::Zero,
        forgetting: 0.999,
    };
    let estimator = Estimator::<2>::new([0.0; 2], [1.0; 2], 0.999);
    for _ in 0..samples {
        seen.inputs(&[[0.0; 3]; 2], &[u, u]);
        Witness::<3, 2, 2>::row(&mut seen, &[1.0, 2.0], 0.0, &estimator, true);
    }
}

/// A second of a command into a width.
fn taken(width: f32, u: f32) -> Error {
    let mut error = Error::new(width, 1.0);
    take(&mut error, u, 1000, &trends());
    error
}

#[test]
fn a_command_beyond_a_width_misses_nothing_and_one_inside_what_is_left() {
    let column = |u| taken(0.1, u).column;
    for u in [0.1, 0.2, -0.15, 0.0] {
        assert_eq!(column(u), 0.0, "{u}");
    }
    assert!(column(0.04) > 0.0 && column(0.04) == -column(-0.04));
    assert!((column(0.04) / column(0.07) - 2.0).abs() < 1e-5);
    let [one, two] = *taken(0.1, 0.04).scores();
    assert!(one > 0.0 && (two / one - 2.0).abs() < 1e-5);
}

/// As if the smaller width had been there from the first sample on.
#[test]
fn a_width_that_becomes_smaller_takes_its_past_along() {
    let trends = trends();
    let mut error = taken(0.1, 0.04);
    let mut expected = taken(0.07, 0.04);
    error.set_width::<3>(0.07);
    for _ in 0..2 {
        assert!((error.column / expected.column - 1.0).abs() < 1e-4);
        assert!((error.scores()[0] / expected.scores[0] - 1.0).abs() < 1e-4);
        take(&mut error, 0.05, 200, &trends);
        take(&mut expected, 0.05, 200, &trends);
    }
    // Below every command so far nothing was missed.
    error.set_width::<3>(0.03);
    assert_eq!(*error.scores(), [0.0; 2]);
    take(&mut error, 0.2, 10, &trends);
    assert!(error.column.abs() < 1e-6 && error.scores()[0].abs() < 1e-6);
}

#[test]
fn a_width_that_becomes_larger_keeps_the_sums() {
    let mut error = taken(0.1, 0.04);
    let before = *error.scores();
    error.set_width::<3>(0.2);
    assert_eq!(*error.scores(), before);
    let column = error.column;
    take(&mut error, 0.04, 100, &trends());
    assert!(error.column > 1.1 * column);
}

#[test]
fn a_beginning_forgets_the_commands_and_a_change_the_rows() {
    let trends = trends();
    let mut error = taken(0.1, 0.04);
    let scores = *error.scores();
    let mut seen = Seen {
        error: &mut error,
        trends: &trends,
        hold: Hold::Zero,
        forgetting: 0.999,
    };
    Witness::<3, 2, 2>::begin(&mut seen);
    assert_eq!(seen.error.scores, scores);
    assert!(seen.error.memory.is_none());
    Witness::<3, 2, 2>::changed(&mut seen);
    assert_eq!(seen.error.scores, [0.0; 2]);
}

#[test]
fn what_has_decayed_becomes_zero() {
    let trends = trends();
    let mut error = taken(0.1, 0.04);
    for _ in 0..1000 {
        take(&mut error, 0.0, 200, &trends);
        assert!(error.is_normal(), "{error:?}");
    }
    assert_eq!((error.column, *error.scores()), (0.0, [0.0; 2]));
}
