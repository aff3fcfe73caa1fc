//! After any history a reset is the construction.

use core::fmt::Debug;

use proptest::prelude::*;
use trendid::estimation::Terms;
use trendid::trends::{ExactTrends, FilteredTrends, RawTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};

use crate::properties::record;

/// What may happen to an identifier before it is reset.
#[derive(Debug, Clone)]
enum Event {
    Motion { first: usize, samples: usize },
    Rest { samples: usize },
    BadSample,
    Gap,
    Skipped { samples: u32 },
    Spike { size: f32 },
    Adapt(bool),
    Retune { bandwidth: f32, settling: f32 },
    WarmStart { relative: f32 },
    Trust,
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (0_usize..300, 1_usize..400).prop_map(|(first, samples)| Event::Motion { first, samples }),
        1 => (1_usize..600).prop_map(|samples| Event::Rest { samples }),
        1 => Just(Event::BadSample),
        1 => Just(Event::Gap),
        1 => (1_u32..400).prop_map(|samples| Event::Skipped { samples }),
        1 => (-1e4_f32..1e4).prop_map(|size| Event::Spike { size }),
        2 => any::<bool>().prop_map(Event::Adapt),
        2 => (5.0_f32..80.0, 0.0_f32..0.2)
            .prop_map(|(bandwidth, settling)| Event::Retune { bandwidth, settling }),
        1 => (0.5_f32..2.0).prop_map(|relative| Event::WarmStart { relative }),
        1 => Just(Event::Trust),
    ]
}

/// After any history a reset identifier is the fresh one, in every field, and stays so on the same
/// stream.
fn reset_is_construction<T, const N: usize, const I: usize, const D: usize>(
    fresh: Identifier<T, 3, N, I, D>,
    retuned: impl Fn(f32) -> T,
    history: &[Event],
    record: &[(f32, f32)],
) -> Result<(), TestCaseError>
where
    T: TrendOperator<3> + Debug + PartialEq,
{
    let mut used = fresh.clone();
    let inputs = |u: f32| core::array::from_fn(|input| if input == 0 { u } else { u * u });
    for event in history {
        match *event {
            Event::Motion { first, samples } => {
                for (u, y) in record.iter().cycle().skip(first).take(samples) {
                    let _ = used.update_inputs(inputs(*u), *y);
                }
            }
            Event::Rest { samples } => {
                for _ in 0..samples {
                    let _ = used.update_inputs(inputs(0.0), record[0].1);
                }
            }
            Event::BadSample => {
                let _ = used.update_inputs(inputs(0.3), f32::NAN);
            }
            Event::Gap => used.restart_trends(),
            Event::Skipped { samples } => used.skip(samples),
            Event::Spike { size } => {
                let _ = used.update_inputs(inputs(0.3), record[0].1 + size);
            }
            Event::Adapt(on) => used.adapt(on),
            Event::Retune {
                bandwidth,
                settling,
            } => used.retune(retuned(bandwidth), settling).unwrap(),
            Event::WarmStart { relative } => {
                let theta = [400.0, 20.0, 1e6, 1.0, 1.0, 1.0, 1.0];
                let theta: [f32; N] = core::array::from_fn(|j| relative * theta[j]);
                used.warm_start(theta, theta.map(|value| 0.1 * value))
                    .unwrap();
            }
            Event::Trust => used.set_nominal(),
        }
    }
    used.reset();
    prop_assert_eq!(&used, &fresh);
    let mut fresh = fresh;
    for (k, (u, y)) in record.iter().enumerate() {
        let expected = fresh.update_inputs(inputs(*u), *y);
        let found = used.update_inputs(inputs(*u), *y);
        prop_assert_eq!(expected, found, "sample {}", k);
        prop_assert!(used == fresh, "sample {k}: {used:?} {fresh:?}");
    }
    prop_assert_eq!(used.theta(), fresh.theta());
    Ok(())
}

fn config<const N: usize, const I: usize>(
    structure: Structure<3, N, I>,
    memory: Option<f32>,
) -> Config<3, N, I> {
    let mut config = Config::new(structure, 20.0, [1.0; I], 50.0);
    config.memory = memory;
    config.settling = 0.02;
    config
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_reset_forgets_any_history(
        record in record(),
        history in prop::collection::vec(event(), 1..12),
        memory in prop::sample::select(vec![None, Some(0.1), Some(0.5), Some(3.0)]),
    ) {
        let filtered = |bandwidth| FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, bandwidth).unwrap();
        let exact = |bandwidth| ExactTrends::for_bandwidth(0.001, bandwidth).unwrap();
        let raw = |_| RawTrends::try_new(Scheme::Tustin, 0.001).unwrap();
        let servo = config(Structure::<3, 5, 1>::SERVO, memory);
        let drive = config(Structure::<3, 3, 1>::INTEGRATING, memory);
        let b0 = [Terms::of(&[0]); 2];
        let all_a = Structure::<3, 7, 2>::try_with_initial_state(Terms::up_to(3), b0, true).unwrap();
        let mut all_a = config(all_a, memory);
        all_a.delays = [3, 1];
        all_a.initial_input = [0.2, -0.1];

        let fresh = Identifier::<_, 3, 5>::try_new(&servo, filtered(20.0)).unwrap();
        reset_is_construction(fresh, filtered, &history, &record)?;
        let fresh = Identifier::<_, 3, 7, 2, 4>::try_new(&all_a, filtered(20.0)).unwrap();
        reset_is_construction(fresh, filtered, &history, &record)?;
        let fresh = Identifier::<_, 3, 5>::try_new(&servo, exact(20.0)).unwrap();
        reset_is_construction(fresh, exact, &history, &record)?;
        let fresh = Identifier::<_, 3, 3>::try_new(&drive, raw(20.0)).unwrap();
        reset_is_construction(fresh, raw, &history, &record)?;
    }

    #[test]
    fn an_identifier_begins_anew_in_its_place(
        record in record(),
        samples in 0_usize..400,
        memory in prop::sample::select(vec![None, Some(0.1), Some(3.0)]),
        bandwidth in 5.0_f32..60.0,
    ) {
        let trends = |bandwidth| FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, bandwidth).unwrap();
        let first = config(Structure::<3, 5, 1>::SERVO, Some(0.5));
        let mut used = Identifier::<_, 3, 5>::try_new(&first, trends(20.0)).unwrap();
        for (u, y) in record.iter().take(samples) {
            let _ = used.update(*u, *y);
        }
        let before = used.clone();
        let mut second = config(Structure::<3, 5, 1>::SERVO, memory);
        second.bandwidth = bandwidth;
        let mut refused = second.clone();
        refused.delays = [1];
        prop_assert!(used.reconfigure(&refused, trends(bandwidth)).is_err());
        prop_assert_eq!(&used, &before, "a refusal changes nothing");
        used.reconfigure(&second, trends(bandwidth)).unwrap();
        let mut fresh = Identifier::<_, 3, 5>::try_new(&second, trends(bandwidth)).unwrap();
        prop_assert_eq!(&used, &fresh);
        for (u, y) in &record {
            prop_assert_eq!(used.update(*u, *y), fresh.update(*u, *y));
        }
        prop_assert_eq!(&used, &fresh);
    }
}
