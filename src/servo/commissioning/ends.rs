//! The ends of the travel, in travels.

/// Share of the travel next to an end where an open valve may hold the axis.
const END: f32 = 0.01;

/// Whether the axis is at an end of its travel, where it stands although the valve may be open.
pub(crate) fn at_end(y: f32) -> bool {
    !(END..1.0 - END).contains(&y)
}

/// Whether a reading is so far out that no axis can be there.
pub(crate) fn is_beyond(y: f32) -> bool {
    !(-END..1.0 + END).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_of_the_travel_is_a_hundredth_of_it() {
        for (y, end) in [
            (0.005, true),
            (0.02, false),
            (0.98, false),
            (0.995, true),
            (-1.0, true),
        ] {
            assert_eq!(at_end(y), end, "{y}");
        }
    }

    #[test]
    fn beyond_is_a_hundredth_past_either_end() {
        for (y, beyond) in [(-0.011, true), (-0.009, false), (0.5, false)] {
            for y in [y, 1.0 - y] {
                assert_eq!(is_beyond(y), beyond, "{y}");
            }
        }
        assert!(is_beyond(f32::NAN));
    }
}
