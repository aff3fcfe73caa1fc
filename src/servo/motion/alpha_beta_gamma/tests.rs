//! The filter on motions that are known.

use super::*;

const TIME: f32 = 1e-4;

#[test]
fn a_wrong_position_fades_as_three_poles_do() {
    // s^2/(s + w)^3: e^-x (1 - 2x + x^2/2).
    let mut filter = AlphaBetaGamma::new(50.0, TIME);
    filter.place(1.0);
    assert_eq!(filter.motion(), Motion::at(1.0));
    for k in 1..=2000 {
        filter.update(0.0);
        let x = 50.0 * TIME * k as f32;
        let e = libm::expf(-x);
        let expected = e * (1.0 - 2.0 * x + 0.5 * x * x);
        let position = filter.motion().position;
        assert!(
            (position - expected).abs() < 0.02,
            "{k}: {position} {expected}"
        );
    }
    let rest = filter.motion();
    assert!(rest.position.abs() < 0.02 && rest.velocity.abs() < 0.5);
}

#[test]
fn a_constant_acceleration_is_followed_exactly() {
    let mut filter = AlphaBetaGamma::new(20.0, 1e-3);
    // Another rate does not forget the motion.
    filter.begin(Motion {
        position: 3.0,
        velocity: -40.0,
        acceleration: 200.0,
    });
    filter.retune(60.0);
    for k in 1..=500 {
        let t = 1e-3 * k as f32;
        let y = 3.0 - 40.0 * t + 100.0 * t * t;
        filter.update(y);
        let motion = filter.motion();
        assert!((motion.position - y).abs() < 1e-4, "{k}");
        assert!((motion.velocity - (-40.0 + 200.0 * t)).abs() < 1e-2, "{k}");
        assert!((motion.acceleration - 200.0).abs() < 0.5, "{k}");
    }
}

#[test]
fn gains_are_those_of_three_equal_poles() {
    // The motion behind one wrong position is the gains themselves.
    for (rate, time) in [(50.0_f32, 1e-3_f32), (8.0, 1e-2)] {
        let mut filter = AlphaBetaGamma::new(rate, time);
        filter.update(1.0);
        let Motion {
            position,
            velocity,
            acceleration,
        } = filter.motion();
        for (found, expected) in [
            (position, 3.0 * rate * time),
            (velocity, 3.0 * rate * rate * time),
            (acceleration, rate * rate * rate * time),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        }
    }
}

#[test]
fn white_noise_of_the_positions_becomes_as_much_of_velocity_and_acceleration() {
    let mut state = 1_u32;
    for (rate, time) in [(120.0_f32, 1e-3_f32), (120.0, 5e-4), (30.0, 2e-3)] {
        let mut filter = AlphaBetaGamma::new(rate, time);
        let (mut sums, count) = ([0.0_f32; 2], 20_000);
        for _ in 0..count {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Uniform, of deviation 1.
            let noise = ((state >> 8) as f32 / 8_388_608.0 - 1.0) * 1.732_050_8;
            filter.update(noise);
            let motion = filter.motion();
            for (sum, share) in sums.iter_mut().zip([
                motion.velocity / filter.velocity_noise(),
                motion.acceleration / filter.acceleration_noise(),
            ]) {
                *sum += share * share;
            }
        }
        // A filter of samples lets a part more through than one in continuous time.
        for sum in sums {
            let ratio = crate::math::sqrt(sum / count as f32);
            assert!((0.95..1.3).contains(&ratio), "{rate} {time}: {ratio}");
        }
    }
}
