//! Inputs made from the command: what a valve, a cylinder or friction does belongs in the regressor.

/// The two inputs that a valve with the dead zone `delta` needs beside a constant.
///
/// A valve that passes `u - delta sgn(u)` for `|u| > delta` and nothing inside is
/// linear in `[u, sgn(u)]`, both switched off inside the dead zone. The ratio of the
/// two numerators is `-delta`.
///
/// # Examples
/// ```
/// assert_eq!(trendid::dead_zone(0.5, 0.03), [0.5, 1.0]);
/// assert_eq!(trendid::dead_zone(-0.5, 0.03), [-0.5, -1.0]);
/// assert_eq!(trendid::dead_zone(0.02, 0.03), [0.0, 0.0]);
/// ```
#[inline]
pub fn dead_zone(u: f32, delta: f32) -> [f32; 2] {
    if u > delta {
        [u, 1.0]
    } else if u < -delta {
        [u, -1.0]
    } else {
        [0.0, 0.0]
    }
}

/// The two inputs of an actuator with another gain in each direction: `max(u, 0)` and `min(u, 0)`.
///
/// # Examples
/// ```
/// assert_eq!(trendid::asymmetric(-2.0), [0.0, -2.0]);
/// ```
#[inline]
pub fn asymmetric(u: f32) -> [f32; 2] {
    if u > 0.0 { [u, 0.0] } else { [0.0, u] }
}

/// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero.
///
/// # Examples
/// ```
/// assert_eq!(trendid::coulomb(-0.4, 0.01), -1.0);
/// assert_eq!(trendid::coulomb(0.001, 0.01), 0.0);
/// ```
#[inline]
pub fn coulomb(velocity: f32, rest: f32) -> f32 {
    if velocity > rest {
        1.0
    } else if velocity < -rest {
        -1.0
    } else {
        0.0
    }
}
