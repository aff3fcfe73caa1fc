use super::*;
use crate::dynamic::setup::{Filter, settings};
use trendid::ConfigError;
use trendid::trends::Scheme;

// Sixteen more shapes of the core.
#[cfg(feature = "thorough")]
mod exact;

/// Linear congruential generator of Numerical Recipes.
struct Draw(u32);

impl Draw {
    fn below(&mut self, end: u32) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((self.0 >> 8) % end) as usize
    }

    fn terms(&mut self, order: usize) -> Terms {
        let bits = self.below(1 << order);
        let powers: Vec<usize> = (0..order).filter(|p| bits >> p & 1 == 1).collect();
        Terms::of(&powers)
    }

    /// Any structure of an order, with any of the filters.
    fn setup(&mut self, order: usize) -> Setup {
        let inputs = 1 + self.below(4);
        // (s + 20)^m.
        let filter: Vec<f32> = match order {
            1 => vec![20.0],
            2 => vec![400.0, 40.0],
            3 => vec![8e3, 1200.0, 60.0],
            _ => vec![1.6e5, 3.2e4, 2400.0, 80.0],
        };
        Setup {
            order,
            output: self.terms(order),
            inputs: (0..inputs).map(|_| self.terms(order)).collect(),
            constant: self.below(2) == 0,
            initial_state: self.below(2) == 0,
            sample_time: 0.002,
            scheme: Scheme::Tustin,
            filter: match self.below(4) {
                0 => Filter::None,
                1 => Filter::Exact {
                    model: filter.clone(),
                    filter,
                },
                _ => Filter::Polynomial(filter),
            },
            settings: settings(20.0, &vec![1.0; inputs], 5.0),
        }
    }
}

#[test]
fn every_structure_has_a_core() {
    let mut draw = Draw(200_002);
    let mut largest = 0;
    for number in 0..20_000 {
        let setup = draw.setup(1 + number % 4);
        let numerators: usize = setup.inputs.iter().map(|terms| terms.count()).sum();
        match setup.build() {
            Ok(_) => largest = largest.max(setup.parameters()),
            Err(ConfigError::NoInput) => assert_eq!(numerators, 0),
            Err(error) => assert!(setup.parameters() > 10, "{error} of {setup:?}"),
        }
    }
    assert_eq!(largest, 10);
}

#[test]
fn an_error_names_the_parameter_of_the_structure() {
    let mut setup = Draw(1).setup(3);
    // a1, b0 and the constant: the core has more b_i in front of the constant.
    (setup.output, setup.inputs) = (Terms::of(&[1]), vec![Terms::of(&[0])]);
    (setup.constant, setup.initial_state) = (true, false);
    setup.order = 4;
    setup.filter = Filter::None;
    let mut core = setup.build().unwrap();
    let refused = core.warm_start(&[1.0, 2.0, f32::NAN], &[1.0; 3]);
    assert_eq!(
        refused.unwrap_err().to_string(),
        "initial[2] = NaN is not finite"
    );
    let refused = core.warm_start(&[1.0; 4], &[1.0; 4]);
    let (found, expected) = (4, 3);
    assert_eq!(
        refused,
        Err(ConfigError::ParameterCount { found, expected })
    );
}
