//! What a drive may have become by one number alone: another load, or another velocity gain.

use crate::servo::model::Model;

/// Factors on all that acts on the mass, as after a change of the load, and on the velocity gain,
/// as after a change of the valve or its supply.
const LOADS: [f32; 5] = [1.0 / 3.0, 0.577, 1.0, 1.732, 3.0];
const GAINS: [f32; 5] = [0.5, 0.707, 1.0, 1.414, 2.0];

/// Logarithm of a step of each.
const LOAD_STEP: f32 = 0.549;
const GAIN_STEP: f32 = 0.347;

/// Relative standard deviation of what lies within half of a step of the loads either way.
const STEP_STD: f32 = 0.18;

/// Models of a bank: five loads, the middle one that of the model in use, then four gains.
pub(crate) const SIZE: usize = 9;
/// Place of the model in use.
pub(crate) const USED: usize = 2;

/// A model under another load: stiffness, damping, valve and friction act on another mass.
fn loaded(model: &Model, factor: f32) -> Model {
    Model {
        a1: factor * model.a1,
        a2: factor * model.a2,
        b0: factor * model.b0,
        friction: factor * model.friction,
        ..*model
    }
}

/// A model with another velocity gain.
fn geared(model: &Model, factor: f32) -> Model {
    Model {
        b0: factor * model.b0,
        ..*model
    }
}

/// The bank about a model.
pub(crate) fn about(used: &Model) -> [Model; SIZE] {
    let [a, b, own, c, d] = LOADS.map(|load| loaded(used, load));
    let [e, f, _, g, h] = GAINS.map(|gain| geared(used, gain));
    [a, b, own, c, d, e, f, g, h]
}

/// The change of one number that explains windows best.
pub(crate) struct Best {
    pub(crate) model: Model,
    /// Sum of the shares of the nearest model of the bank.
    pub(crate) share: f32,
    /// By how much the best change of the other number leaves more.
    pub(crate) apart: f32,
}

/// The change of one number that should leave the least in so many windows, by the shares of a
/// bank.
///
/// Between the models by the parabola through the least and its neighbours, of squared errors: near
/// its least value a sum of squares is one of the logarithm of the factor, a share is not.
pub(crate) fn best(used: &Model, shares: &[f32; SIZE], windows: f32) -> Best {
    let errors = |share: f32| share / (windows - share);
    let [a, b, own, c, d, e, f, g, h] = shares.map(errors);
    let load = least(&LOADS, LOAD_STEP, [a, b, own, c, d]);
    let gain = least(&GAINS, GAIN_STEP, [e, f, own, g, h]);
    let of = |least: &Least| (least.expected, least.nearest);
    let (model, errors, other) = if of(&load) < of(&gain) {
        (loaded(used, load.factor), load.nearest, gain.nearest)
    } else {
        (geared(used, gain.factor), gain.nearest, load.nearest)
    };
    // One that is not finite is astray in all windows.
    let share = |errors: f32| {
        let share = errors / (1.0 + errors);
        windows * if share < 1.0 { share } else { 1.0 }
    };
    let nearest = share(errors);
    Best {
        model,
        share: nearest,
        apart: share(other) - nearest,
    }
}

/// Variances of a1, a2 and b0 of a model that a bank has found.
pub(crate) fn variances(model: &Model) -> [f32; 3] {
    [model.a1, model.a2, model.b0].map(|value| STEP_STD * STEP_STD * value * value)
}

/// Where errors are least: the factor, the errors expected there, and those of the nearest model.
struct Least {
    factor: f32,
    expected: f32,
    nearest: f32,
}

/// A factor of a list, and the errors below, at and above it; none beyond the ends.
#[derive(Clone, Copy)]
struct Bracket {
    factor: f32,
    errors: [f32; 3],
}

fn least(factors: &[f32; 5], step: f32, errors: [f32; 5]) -> Least {
    const NONE: f32 = f32::INFINITY;
    let ([p, q, r, s, t], [a, b, c, d, e]) = (*factors, errors);
    let place = |factor, errors| Bracket { factor, errors };
    let middle = place(r, [b, c, d]);
    let others = [
        place(p, [NONE, a, b]),
        place(q, [a, b, c]),
        place(s, [c, d, e]),
        place(t, [d, e, NONE]),
    ];
    let mut best = middle;
    for other in others {
        if other.errors[1] < best.errors[1] {
            best = other;
        }
    }
    let Bracket {
        factor,
        errors: [left, nearest, right],
    } = best;
    let (difference, curve) = (left - right, left - 2.0 * nearest + right);
    if !(curve > 0.0 && curve < f32::INFINITY) {
        return Least {
            factor,
            expected: nearest,
            nearest,
        };
    }
    // Within half of a step either way.
    let to = 0.5 * difference / curve;
    let x = to * step;
    let expected = nearest - 0.25 * difference * to;
    Least {
        // exp(x) to 0.4 %.
        factor: factor * (1.0 + x * (1.0 + 0.5 * x)),
        // No sum of squares is negative.
        expected: if expected > 0.0 { expected } else { 0.0 },
        nearest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: Model = Model {
        friction: 40.0,
        dead_zone: 0.05,
        offset: 0.01,
        ..Model::linear(900.0, 15.0, 9e5)
    };

    #[test]
    fn a_bank_has_the_model_in_use_and_changes_of_one_number() {
        let bank = about(&MODEL);
        assert_eq!(bank[USED], MODEL);
        for (model, load) in bank.iter().zip(LOADS) {
            for (is, was) in model.parameters().iter().zip(MODEL.parameters()).take(3) {
                assert!((is / was / load - 1.0).abs() < 1e-6);
            }
            assert!((model.friction / MODEL.friction / load - 1.0).abs() < 1e-6);
            assert_eq!((model.dead_zone, model.offset), (0.05, 0.01));
        }
        for (model, gain) in bank[5..].iter().zip([0.5, 0.707, 1.414, 2.0]) {
            let b0 = gain * MODEL.b0;
            assert_eq!(*model, Model { b0, ..MODEL });
        }
    }

    /// Shares of a drive whose load and gain are so many steps off: errors by the distance.
    fn shares(load: f32, gain: f32) -> [f32; SIZE] {
        let errors: [f32; SIZE] = core::array::from_fn(|k| {
            let k = k as f32;
            let (l, g) = if k < 5.0 {
                (k - 2.0, 0.0)
            } else if k < 7.0 {
                (0.0, k - 7.0)
            } else {
                (0.0, k - 6.0)
            };
            (load - l) * (load - l) + (gain - g) * (gain - g)
        });
        errors.map(|errors| 2.0 * errors / (1.0 + errors))
    }

    #[test]
    fn the_best_change_is_found_between_the_models() {
        for steps in [-2.0_f32, -1.3, -0.4, 0.3, 1.0, 1.4, 2.0] {
            let root = 1.732_f32;
            let Best {
                model,
                share: left,
                apart,
            } = best(&MODEL, &shares(steps, 0.0), 2.0);
            let load = libm::powf(root, steps);
            assert!((model.a1 / MODEL.a1 / load - 1.0).abs() < 0.05, "{steps}");
            assert!((model.b0 / model.a1 / (MODEL.b0 / MODEL.a1) - 1.0).abs() < 1e-6);
            let off = steps - libm::roundf(steps);
            // No change of the gain leaves less than the model in use.
            let other = 2.0 * steps * steps / (1.0 + steps * steps);
            assert!((apart - (other - left)).abs() < 1e-5, "{steps}");
            assert!((left - 2.0 * off * off / (1.0 + off * off)).abs() < 1e-6);
            let Best { model, .. } = best(&MODEL, &shares(0.0, steps), 2.0);
            let gain = libm::powf(1.414, steps);
            assert!((model.b0 / MODEL.b0 / gain - 1.0).abs() < 0.03, "{steps}");
            assert_eq!((model.a1, model.friction), (MODEL.a1, MODEL.friction));
        }
    }

    #[test]
    fn the_errors_between_the_models_are_those_of_their_parabola() {
        for (vertex, factor) in [(0.7_f32, 0.577), (1.0, 0.577), (2.3, 1.0), (3.4, 1.732)] {
            let errors = core::array::from_fn(|k| {
                let off = k as f32 - vertex;
                0.3 + 0.8 * off * off
            });
            let found = least(&LOADS, LOAD_STEP, errors);
            assert!((found.expected - 0.3).abs() < 1e-5, "{vertex}");
            assert_eq!(found.nearest, errors[libm::roundf(vertex) as usize]);
            let off = vertex - libm::roundf(vertex);
            let between = factor * libm::expf(LOAD_STEP * off);
            assert!((found.factor / between - 1.0).abs() < 0.01, "{vertex}");
        }
    }

    #[test]
    fn of_a_load_and_a_gain_that_promise_the_same_the_gain_is_changed() {
        // Both lead to no error at all between the model in use and the next one.
        let mut shares = [1.0; SIZE];
        shares[USED] = 0.02;
        (shares[3], shares[7]) = (0.4, 0.4);
        let Best { model, apart, .. } = best(&MODEL, &shares, 2.0);
        assert_eq!((model.a1, apart), (MODEL.a1, 0.0));
        assert!(model.b0 > MODEL.b0);
    }

    #[test]
    fn what_no_change_explains_better_stays() {
        let own = best(&MODEL, &shares(0.0, 0.0), 2.0);
        assert_eq!((own.model, own.share, own.apart), (MODEL, 0.0, 0.0));
        // Nothing is known where all fail alike, or none has a number.
        for share in [1.0, 2.0, f32::NAN] {
            let Best { model, .. } = best(&MODEL, &[share; SIZE], 2.0);
            assert_eq!(model, MODEL);
        }
    }
}
