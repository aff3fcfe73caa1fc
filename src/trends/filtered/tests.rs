//! Settings, feedthrough and equilibria of filtered trends.

use super::*;
use crate::trends::operator::Memory;

#[test]
fn poles_and_polynomial_say_the_same() {
    let by_poles = FilteredTrends::<3>::try_new(Scheme::Tustin, 0.001, [2.0, 3.0, 4.0]).unwrap();
    // (s + 2)(s + 3)(s + 4)
    assert_eq!(by_poles.filter(), [24.0, 26.0, 9.0]);
    let again = FilteredTrends::from_polynomial(Scheme::Tustin, 0.001, [24.0, 26.0, 9.0]);
    assert_eq!(again, Ok(by_poles));
}

#[test]
fn the_default_filter_as_documented() {
    let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    // (s + 2.2)(s^2 + 30.8 s + 484)
    for (found, wanted) in trends.filter().into_iter().zip([1064.8, 551.76, 33.0]) {
        assert!((found / wanted - 1.0).abs() < 1e-6, "{found}");
    }
    assert!((trends.design().slow_mode - (1.0 - 0.0011) / (1.0 + 0.0011)).abs() < 1e-6);
}

#[test]
fn an_invalid_filter_is_named() {
    let pole = |poles| FilteredTrends::<2>::try_new(Scheme::Tustin, 0.001, poles);
    for (index, poles) in [(0, [0.0, 1.0]), (1, [1.0, -1.0]), (1, [1.0, f32::INFINITY])] {
        let (setting, value) = (("poles", index).into(), poles[index]);
        let expected = ConfigError::NotPositive { setting, value };
        assert_eq!(pole(poles), Err(expected));
    }
    assert!(pole([f32::NAN, 1.0]).is_err());
    // Forward rectangles are unstable above 1/Delta.
    assert!(FilteredTrends::<1>::try_new(Scheme::Goodwin, 0.001, [1001.0]).is_err());
    assert!(FilteredTrends::<1>::try_new(Scheme::Tustin, 0.001, [1001.0]).is_ok());
    // (s - 1)(s^2 + 4 s + 9) fails in its own signs, s^3 + s^2 + s + 2 in the Hurwitz
    // condition.
    let polynomial = |f| FilteredTrends::<3>::from_polynomial(Scheme::Tustin, 0.001, f);
    let not_positive = ConfigError::NotPositive {
        setting: ("filter", 0).into(),
        value: -9.0,
    };
    assert_eq!(polynomial([-9.0, 5.0, 3.0]), Err(not_positive));
    let unstable = ConfigError::Unstable {
        setting: "filter".into(),
    };
    assert_eq!(polynomial([2.0, 1.0, 1.0]), Err(unstable));
    assert!(polynomial([1.0, 2.0, 2.0]).is_ok());
    assert_eq!(
        FilteredTrends::<2>::for_bandwidth(Scheme::Tustin, 0.001, 0.0),
        Err(ConfigError::NotPositive {
            setting: "bandwidth".into(),
            value: 0.0
        })
    );
}

#[test]
fn the_feedthrough_is_the_answer_to_a_unit_sample() {
    for scheme in [Scheme::Goodwin, Scheme::Tustin] {
        let trends = FilteredTrends::<3>::for_bandwidth(scheme, 0.001, 20.0).unwrap();
        let design = trends.design();
        let mut memory = Chain::output_at_rest(design, Form::Position, 0.0);
        let response = trends.output(&mut memory, 1.0, Form::Position);
        assert_eq!(response, design.feedthrough);
    }
}

#[test]
fn a_mean_is_a_held_value_one_sample_earlier() {
    let trends = FilteredTrends::<2>::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let mut held = Chain::input_at_rest(trends.design(), Hold::Zero, 0.0);
    let mut mean = Chain::input_at_rest(trends.design(), Hold::Mean, 0.0);
    let _ = trends.input(&mut held, 3.0, Hold::Zero);
    for u in [-1.0, 0.5, 2.0, 0.0] {
        let one = trends.input(&mut mean, if u == -1.0 { 3.0 } else { u + 1.0 }, Hold::Mean);
        let next = [-1.0, 0.5, 2.0, 0.0].iter().skip_while(|x| **x != u).nth(1);
        let other = trends.input(&mut held, next.map_or(0.0, |u| u + 1.0), Hold::Zero);
        assert_eq!(one, other);
    }
}

#[test]
fn settled_signals_stay() {
    let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let design = trends.design();
    let mut y = Chain::output_at_rest(design, Form::Position, 5.0);
    let mut u = Chain::input_at_rest(design, Hold::Zero, 5.0);
    let mut mean = Chain::input_at_rest(design, Hold::Mean, 5.0);
    let rest = 5.0 / trends.filter()[0];
    for _ in 0..1000 {
        let output = trends.output(&mut y, 5.0, Form::Position);
        let input = trends.input(&mut u, 5.0, Hold::Zero);
        let averaged = trends.input(&mut mean, 5.0, Hold::Mean);
        for found in [output.lower[0], input[0], averaged[0]] {
            assert!((found / rest - 1.0).abs() < 1e-5);
        }
        assert!(output.top.abs() < 1e-4 && output.lower[1].abs() < 1e-4);
    }
}
