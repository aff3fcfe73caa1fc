//! Inputs made from the command: nonlinearities of valves, cylinders and friction as terms of the
//! regressor.

mod dead_zone;
mod friction;
mod valved;
mod width_error;

pub use dead_zone::{DeadZone, dead_zone};
pub use friction::{Coulomb, coulomb};
pub use valved::Valved;

/// The two inputs of an actuator with another gain in each direction: `max(u, 0)` and `min(u, 0)`.
///
/// # Examples
/// ```
/// assert_eq!(trendid::inputs::asymmetric(-2.0), [0.0, -2.0]);
/// ```
#[inline]
pub fn asymmetric(u: f32) -> [f32; 2] {
    if u > 0.0 { [u, 0.0] } else { [0.0, u] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_direction_has_its_input() {
        assert_eq!(asymmetric(0.5), [0.5, 0.0]);
        assert_eq!(asymmetric(0.0), [0.0, 0.0]);
    }
}
