//! Levenberg's and Marquardt's steps: Quarterly of Applied Mathematics 2 (1944), SIAM J. 11 (1963).

use nalgebra::{DMatrix, DVector};

/// What the steps lead along: ln phi, ln a, c/phi, d, and the velocity at the start over what the
/// largest command makes of it in a sample.
pub(super) const AXES: usize = 5;

/// Differences that give derivatives.
const DIFFERENCES: [f64; AXES] = [1e-3, 1e-3, 1e-3, 0.02, 0.1];

/// A step at most, in the same units: the motion is linear over no more. It is so in the velocity
/// where that does not reverse.
const FARTHEST: [f64; AXES] = [0.5, 0.7, 0.3, 1.0, f64::INFINITY];

/// Steps at most.
const STEPS: usize = 40;

/// Weight of Marquardt's term to begin with, and its factor behind a step that was none.
const MARQUARDT: f64 = 1e-3;
const STIFFER: f64 = 10.0;

/// Where the steps lead along the free axes, and the squares that are left there of `rest`;
/// `within` brings a place back to what is possible, a step has to take away a share of `worth`.
pub(super) fn descended(
    mut at: [f64; AXES],
    free: [bool; AXES],
    worth: f64,
    within: impl Fn([f64; AXES]) -> [f64; AXES],
    rest: impl Fn([f64; AXES]) -> DVector<f64>,
) -> ([f64; AXES], f64) {
    let axes: Vec<usize> = (0..AXES).filter(|axis| free[*axis]).collect();
    let mut here = rest(at);
    let mut stiffness = MARQUARDT;
    for _ in 0..STEPS {
        let slope = axes.iter().map(|axis| {
            let mut there = at;
            there[*axis] += DIFFERENCES[*axis];
            (rest(there) - &here) / DIFFERENCES[*axis]
        });
        let slope = DMatrix::from_columns(&slope.collect::<Vec<_>>());
        let (normal, right) = (slope.tr_mul(&slope), slope.tr_mul(&here));
        let left = here.norm_squared();
        let mut done = true;
        while stiffness < 1.0 / MARQUARDT {
            let mut stiff = normal.clone();
            for i in 0..axes.len() {
                stiff[(i, i)] *= 1.0 + stiffness;
            }
            let Some(step) = stiff.cholesky().map(|factors| factors.solve(&right)) else {
                break;
            };
            let mut there = at;
            for (axis, step) in axes.iter().zip(step.iter()) {
                there[*axis] -= step.clamp(-FARTHEST[*axis], FARTHEST[*axis]);
            }
            let there = within(there);
            let found = rest(there);
            if found.norm_squared() < left {
                done = found.norm_squared() > (1.0 - worth) * left;
                (at, here) = (there, found);
                stiffness = (stiffness / STIFFER).max(f64::EPSILON);
                break;
            }
            stiffness *= STIFFER;
        }
        if done {
            break;
        }
    }
    let left = here.norm_squared();
    (at, left)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The valley of Rosenbrock along two of the axes.
    fn valley([x, _, y, ..]: [f64; AXES]) -> DVector<f64> {
        DVector::from_vec(vec![1.0 - x, 10.0 * (y - x * x)])
    }

    #[test]
    fn a_bent_valley_is_followed_to_its_end() {
        let free = [true, false, true, false, false];
        let (at, left) = descended([-1.2, 5.0, 1.0, 7.0, 3.0], free, 1e-4, |at| at, valley);
        assert!(left < 1e-6, "{left}");
        assert!((at[0] - 1.0).abs() < 1e-2 && (at[2] - 1.0).abs() < 1e-2);
        assert_eq!([at[1], at[3], at[4]], [5.0, 7.0, 3.0]);
    }

    #[test]
    fn no_step_leaves_what_is_possible() {
        let within = |mut at: [f64; AXES]| {
            at[0] = at[0].min(0.5);
            at
        };
        let (at, _) = descended(
            [0.0; AXES],
            [true, false, true, false, false],
            1e-4,
            within,
            valley,
        );
        assert!(
            at[0] <= 0.5 && (at[2] - at[0] * at[0]).abs() < 1e-2,
            "{at:?}"
        );
    }
}
