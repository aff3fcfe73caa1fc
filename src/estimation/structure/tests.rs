use super::*;

#[test]
fn theta_holds_a_then_b_of_each_input_then_constant_then_initial_state() {
    let structure = Structure::<3, 7, 2>::try_with_initial_state(
        Terms::of(&[2, 1]),
        [Terms::of(&[2, 0]), Terms::of(&[1])],
        true,
    )
    .unwrap();
    let input = |input, power| Parameter::Input { input, power };
    assert_eq!(
        structure.parameters(),
        [
            Parameter::Output { power: 1 },
            Parameter::Output { power: 2 },
            input(0, 0),
            input(0, 2),
            input(1, 1),
            Parameter::Constant,
            Parameter::InitialState,
        ]
    );
    assert_eq!(structure.integrators(), 1);
    assert!(structure.constant() && structure.initial_state());
    let plain = Structure::<3, 3, 1>::INTEGRATING;
    assert!(!plain.constant() && !plain.initial_state());
}

#[test]
fn integrators_are_the_absent_lowest_terms() {
    let count = |terms| {
        let b = [Terms::of(&[0])];
        match Structure::<3, 2, 1>::try_new(terms, b, false) {
            Ok(structure) => structure.integrators(),
            Err(error) => panic!("{error}"),
        }
    };
    assert_eq!(count(Terms::of(&[0])), 0);
    assert_eq!(count(Terms::of(&[1])), 1);
    assert_eq!(count(Terms::of(&[2])), 2);
    let none: Structure<2, 1, 1> = crate::structure!(Terms::NONE, [Terms::of(&[0])], false);
    assert_eq!(none.integrators(), 2);
}

#[test]
fn contradictions_are_named() {
    let one = [Terms::of(&[0])];
    assert_eq!(
        Structure::<2, 2, 1>::try_new(Terms::of(&[2]), one, false),
        Err(ConfigError::Term { power: 2, order: 2 })
    );
    assert_eq!(
        Structure::<2, 2, 1>::try_new(Terms::of(&[0]), [Terms::of(&[3])], false),
        Err(ConfigError::Term { power: 3, order: 2 })
    );
    assert_eq!(
        Structure::<2, 1, 1>::try_new(Terms::of(&[0]), [Terms::NONE], false),
        Err(ConfigError::NoInput)
    );
    assert_eq!(
        Structure::<2, 5, 1>::try_new(Terms::up_to(2), one, true),
        Err(ConfigError::ParameterCount {
            found: 4,
            expected: 5
        })
    );
}

#[test]
fn an_initial_state_without_a_constant_is_the_last_parameter() {
    let structure = Structure::<3, 4, 1>::INTEGRATING_WITH_INITIAL_STATE;
    let [.., b0, last] = structure.parameters();
    assert_eq!(b0, Parameter::Input { input: 0, power: 0 });
    assert_eq!(last, Parameter::InitialState);
    // A power that no set has is in none.
    assert!(!Terms::up_to(8).contains(8) && Terms::up_to(8).contains(7));
}

#[test]
fn a_derivative_of_the_command_that_is_known_to_be_none_makes_no_zeros() {
    let two = Structure::<3, 3, 1>::try_new(Terms::of(&[1]), [Terms::of(&[1, 0])], false).unwrap();
    let at = two.parameters();
    let b1 = Parameter::Input { input: 0, power: 1 };
    let place = at.iter().position(|parameter| *parameter == b1).unwrap();
    let mut theta = [1.0; 3];
    assert!(two.zeros(&theta));
    theta[place] = 0.0;
    assert!(!two.zeros(&theta));
    assert!(!Structure::<3, 3, 1>::INTEGRATING.zeros(&[1.0; 3]));
}
