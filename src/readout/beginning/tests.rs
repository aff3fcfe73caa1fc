//! What is done with a beginning.

use super::*;

#[test]
fn a_column_moves_the_estimate_and_widens_its_covariance() {
    let column = Column {
        direction: [1.0, -2.0],
        gamma: 3.0,
        variance: 0.5,
    };
    let mut regression = Regression {
        theta: [1.0; 2],
        p: [[1.0; 2]; 2],
    };
    column.enter(&mut regression);
    assert_eq!(regression.theta, [-2.0, 7.0]);
    assert_eq!(regression.p, [[1.5, 0.0], [0.0, 3.0]]);
}

#[test]
fn what_is_considered_is_in_the_covariance_alone() {
    let considered = Considered {
        direction: [1.0, -2.0],
        variance: 0.5,
    };
    let mut covariance = [[1.0; 2]; 2];
    considered.add_to(&mut covariance, 4.0);
    assert_eq!(covariance, [[3.0, -3.0], [-3.0, 9.0]]);
    assert_eq!([0, 1, 2].map(|index| considered.of(index)), [0.5, 2.0, 0.0]);
}
