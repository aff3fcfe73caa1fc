//! The model of the structure that `select` chooses is that of `identify` for this structure.

use trendid_host_tests::plants::drawn::DrawnRecord;
use trendid_identify::structure_choice::{Range, select};
use trendid_identify::{Choice, Freedom, Options, Problem, Signals, identify};

const SEARCHED: Freedom = Freedom {
    pole: Choice::Auto,
    delay: Choice::Auto,
};

/// Compares both for the plant of a seed: the same behind the same filter, and within a standard
/// deviation and a half behind the one that `identify` chooses.
fn compare(seed: u64, max_order: usize) {
    let drawn = DrawnRecord::of(seed);
    let signals = Signals::held(drawn.dt, &drawn.u, &drawn.y);
    let range = Range {
        max_order,
        integrating: false,
        constant: true,
    };
    let Ok(selection) = select(&signals, range, Options::default(), SEARCHED, &()) else {
        return;
    };
    let chosen = &selection.candidates[selection.recommended];
    let problem = Problem::new(&signals, chosen.structure, Options::default()).expect("a problem");
    let of_select = &chosen.found.estimate;
    for (pole, limit, wider) in [
        (Choice::Given(Some(chosen.pole)), 1e-6, 1.0 + 1e-6),
        (Choice::Auto, 1.5, f64::INFINITY),
    ] {
        let found = identify(&problem, Freedom { pole, ..SEARCHED }, 0, &()).expect("a model");
        let own = &found.estimate;
        for (j, name) in problem.parameter_names().iter().enumerate() {
            let sigmas = [of_select.sigma[j], own.sigma[j]];
            let [low, high] = [sigmas[0].min(sigmas[1]), sigmas[0].max(sigmas[1])];
            let z = (of_select.theta[j] - own.theta[j]).abs() / high;
            let [a, b] = [of_select.theta[j], own.theta[j]];
            assert!(
                z < limit && high / low < wider,
                "{seed}, {name}: {a} and {b}, sigma {sigmas:?}, {pole:?}"
            );
        }
    }
}

#[test]
fn a_structure_that_is_chosen_has_the_numbers_of_one_that_is_named() {
    (1001..=1003).for_each(|seed| compare(seed, 2));
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn many_structures_that_are_chosen_have_the_numbers_of_those_that_are_named() {
    (1004..=1013).for_each(|seed| compare(seed, 3));
}
