//! The bias that an error of an input makes, from sums whose effect is known.

use crate::estimation::structure::Structure;
use crate::identifier::{Config, Identifier, Servo};
use crate::trends::{FilteredTrends, Scheme};

/// A drive `b / (s (s + a))` under steps, without noise.
fn identified() -> Identifier<FilteredTrends<2>, 2, 2> {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
    let config = Config::new(Structure::<2, 2, 1>::INTEGRATING, 20.0, [0.5], 3.0);
    let mut identifier = Identifier::try_new(&config, trends).unwrap();
    let (mut y, mut v) = (0.0_f32, 0.0_f32);
    for k in 0..3000 {
        let u = if k % 400 < 200 { 0.5 } else { -0.5 };
        let _ = identifier.update(u, y);
        for _ in 0..10 {
            (y, v) = (y + 1e-4 * v, v + 1e-4 * (300.0 * u - 15.0 * v));
        }
    }
    identifier
}

/// The part rho of b_0 grows as the sums do, a_1 moves in proportion to it, and b_0 may be larger
/// by 1/(1 - rho): all of it may be none from rho = 1 on.
#[test]
fn a_bias_is_a_part_of_b_and_what_b_may_be_at_most() {
    let identifier = identified();
    let read_out = identifier.read_out();
    let [_, b] = identifier.theta();
    let of = |times: f32| read_out.bias_by_input(&[0.3 * times, times]);
    let part = |bias: f32| bias.abs() / (b + bias.abs());
    let one = part(of(1.0)[1]);
    let moved = of(1.0)[0] * (1.0 - one);
    assert!(one > 0.0 && moved != 0.0, "{one} {moved}");
    for rho in [0.1, 0.5, 0.9] {
        let [a, own] = of(rho / one);
        assert!((part(own) - rho).abs() < 1e-3, "{own} {rho}");
        assert!(
            (a * (1.0 - rho) / (rho / one * moved) - 1.0).abs() < 1e-2,
            "{a}"
        );
    }
    assert!(of(1.01 / one)[1].is_infinite());
    assert_eq!(read_out.bias_by_input(&[0.0; 2]), [0.0; 2]);
}

#[test]
fn the_scale_of_a_column_is_that_of_its_input() {
    let scale = |range| {
        let servo = Servo::<0>::new(1e-3, 20.0, range, 3.0).unwrap();
        servo.read_out().scale_of_b0()
    };
    assert!(scale(0.5) > 0.0 && (scale(0.5) / scale(1.0) - 2.0).abs() < 1e-6);
}
