//! What the ends of the travel leave.

use super::*;

#[test]
fn a_sine_has_room_on_both_sides_of_its_middle() {
    let travel = Travel {
        min: 100.0,
        max: 500.0,
    };
    for (place, room) in [(150.0, 50.0), (440.0, 60.0)] {
        let mut trajectory = Trajectory::new(LIMITS, travel, 1e-3);
        trajectory.hold(place);
        assert!(trajectory.oscillate(room + 1.0, 0.5).is_err());
        assert_eq!(trajectory.oscillate(room - 1.0, 0.5), Ok(()));
    }
}

#[test]
fn a_brake_is_as_much_harder_as_the_end_of_the_travel_needs() {
    let travel = Travel {
        min: -1000.0,
        max: 1000.0,
    };
    let trajectory = Trajectory::new(LIMITS, travel, 1e-3);
    for velocity in [600.0, -600.0_f32] {
        let way = velocity.signum();
        let from = |distance: f32| Motion {
            position: way * (1000.0 - distance),
            velocity,
            acceleration: 0.0,
        };
        // v^2 / 2a + v a / 2j at the limits, and with twice and four times of them.
        let distance = |harder: f32| 20.0 / harder + 10.8 / harder;
        for (room, harder) in [(31.0, 1.0), (30.0, 2.0), (15.5, 2.0), (15.3, 4.0)] {
            let start = from(room);
            let target = trajectory.brake(start).target();
            let gone = way * (target - start.position);
            assert!((gone - distance(harder)).abs() < 0.02, "{room}: {gone}");
        }
    }
}
