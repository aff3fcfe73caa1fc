//! What is done with it.

use super::*;

#[test]
fn what_is_left_of_it_is_in_the_covariance() {
    let begun = Begun {
        direction: [1.0, -2.0],
        gamma: 3.0,
        variance: 0.5,
        considered: false,
    };
    let (mut theta, mut row, mut covariance) = ([1.0; 2], [1.0; 2], [[1.0; 2]; 2]);
    begun.take_out(&mut theta);
    begun.add_row(1, &mut row);
    begun.add_to(&mut covariance, 4.0);
    assert_eq!((theta, row), ([-2.0, 7.0], [0.0, 3.0]));
    assert_eq!(covariance, [[3.0, -3.0], [-3.0, 9.0]]);
}
