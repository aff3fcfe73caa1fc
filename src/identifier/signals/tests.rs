//! Where the trends begin, and what enters them.

use super::*;
use crate::estimation::structure::Structure;
use crate::estimation::terms::Terms;
use crate::identifier::Config;
use crate::identifier::tests::bench::{Trends as Filtered, config, trends};
use crate::trends::{Chain, Form};

type Plan3 = Plan<Filtered, 3, 3, 1>;

#[test]
fn behind_an_integrator_positions_are_counted_from_the_first() {
    for (powers, reference) in [([1, 2], 7.0), ([0, 1], 0.0), ([0, 2], 0.0)] {
        let inputs = [Terms::of(&[0])];
        let structure = Structure::<3, 3, 1>::try_new(Terms::of(&powers), inputs, false);
        let mut config = Config::new(structure.expect("a structure"), 20.0, [0.4], 50.0);
        config.initial_input = [0.2];
        let plan = Plan::new(&config, trends(20.0), 0).expect("settings");
        let mut signals = Signals::<_, 3, 1, 0>::new(&plan, 0);
        assert_eq!(signals.begin(&plan, 7.0), 7.0 - reference);
        assert_eq!(signals.reference, reference);
        let design = plan.trends.design();
        let output = Memory::output_at_rest(design, plan.output_form, 7.0 - reference);
        assert_eq!(signals.output, output);
        assert_eq!(
            signals.inputs[0],
            Memory::input_at_rest(design, Hold::Zero, 0.2)
        );
        // What does not integrate rests under a constant; what does moves from now on.
        let one = if reference == 0.0 { 1.0 } else { 0.0 };
        assert_eq!(
            signals.constant,
            Memory::input_at_rest(design, Hold::Zero, one)
        );
        assert_eq!(signals.initial, 1.0);
    }
}

#[test]
fn the_initial_state_decays_with_the_slow_pole_and_ends() {
    let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    let plan = Plan::new(&config, trends(20.0), 0).expect("settings");
    let mut signals = Signals::<_, 3, 1, 0>::new(&plan, 0);
    let _ = signals.begin(&plan, 7.0);
    for k in 0..8000 {
        let [constant, initial] = signals.other_trends(&plan, [0.0]).extra;
        signals.flush_constant();
        // 2.2 rad/s.
        let exact = libm::expf(-2.2e-3 * k as f32);
        match exact > 1.01e-6 {
            true => assert!(
                (initial / exact - 1.0).abs() < 2e-3,
                "{k}: {initial} {exact}"
            ),
            false => assert!(initial == 0.0 || exact > 0.99e-6, "{k}: {initial}"),
        }
        assert!(k == 0 || constant > 0.0);
    }
    // The trends of a constant 1 end where the filter has it.
    let [constant, _] = signals.other_trends(&plan, [0.0]).extra;
    assert!((constant * 1064.8 - 1.0).abs() < 1e-4, "{constant}");
    // Behind a rest nothing of it is left to be found.
    signals.rest(&plan, 3.0);
    assert_eq!((signals.initial, signals.reference), (0.0, 7.0));
    let [constant, initial] = signals.other_trends(&plan, [0.0]).extra;
    assert!(initial == 0.0 && constant < 1e-6);
}

#[test]
fn trends_begin_again_at_rest_without_another_zero() {
    for powers in [[1, 2], [0, 1]] {
        let inputs = [Terms::of(&[0])];
        let structure = Structure::<3, 3, 1>::try_new(Terms::of(&powers), inputs, false);
        let config = Config::new(structure.expect("a structure"), 20.0, [0.4], 50.0);
        let plan = Plan::new(&config, trends(20.0), 0).expect("settings");
        let mut signals = Signals::<_, 3, 1, 0>::new(&plan, 0);
        let y = signals.begin(&plan, 100.0);
        let reference = signals.reference;
        for k in 0..50 {
            let _ = signals.other_trends(&plan, [0.3]);
            let _ = signals.output_trends(&plan, y + k as f32);
        }
        signals.rest(&plan, y + 50.0);
        assert_eq!(signals.reference, reference);
        let design = plan.trends.design();
        assert_eq!(
            signals.output,
            Memory::output_at_rest(design, plan.output_form, y + 50.0)
        );
        assert_eq!(
            signals.inputs[0],
            Memory::input_at_rest(design, Hold::Zero, 0.0)
        );
        assert!(signals.begun);
    }
}

#[test]
fn an_input_acts_behind_its_delay_whole_or_between_samples() {
    let mut config = Config::new(Structure::<3, 4, 2>::INTEGRATING, 20.0, [0.4; 2], 50.0);
    config.set_delay(0, 2.0);
    config.set_delay(1, 1.25);
    let plan = Plan::new(&config, trends(20.0), 3).expect("settings");
    let mut signals = Signals::<_, 3, 2, 3>::new(&plan, 0);
    let mut straight = Signals::<_, 3, 2, 0>::new(&plan, 0);
    let past = |k: i32, back: i32| {
        if k >= back {
            (k - back + 1) as f32
        } else {
            0.0
        }
    };
    for k in 0..10 {
        let (u, v) = (past(k, 0), 10.0 * past(k, 0));
        let found = signals.other_trends(&plan, [u, v]);
        // A quarter of the older one.
        let late = [past(k, 2), 10.0 * (0.75 * past(k, 1) + 0.25 * past(k, 2))];
        assert_eq!(found.acting, late);
        assert_eq!(signals.acting, late);
        assert_eq!(signals.last_inputs, [u, v]);
        assert_eq!(straight.other_trends(&plan, late).inputs, found.inputs);
    }
    // One input alone needs no memory of what acts.
    let plan = Plan3::new(&self::config(), trends(20.0), 0).expect("settings");
    let mut signals = Signals::<_, 3, 1, 0>::new(&plan, 0);
    assert_eq!(signals.other_trends(&plan, [0.3]).acting, [0.3]);
    assert_eq!(signals.last_inputs, [0.3]);
}

#[test]
fn what_has_decayed_is_flushed_each_for_itself() {
    let plan = Plan3::new(&config(), trends(20.0), 0).expect("settings");
    let design = plan.trends.design();
    let mut signals = Signals::<_, 3, 1, 0>::new(&plan, 0);
    let tiny = Memory::output_at_rest(design, Form::Position, 1e-24);
    let none = Memory::output_at_rest(design, Form::Position, 0.0);
    signals.inputs[0] = tiny;
    signals.constant = tiny;
    signals.output = Chain { last: 0.0, ..tiny };
    let none = Chain {
        last: 1e-24,
        ..none
    };
    signals.flush_inputs();
    assert_eq!((signals.inputs[0], signals.constant), (none, tiny));
    signals.flush_constant();
    assert_eq!(signals.constant, none);
    assert_ne!(signals.output.states, [0.0; 3]);
    signals.flush_output();
    assert_eq!(signals.output.states, [0.0; 3]);
}
