//! What follows from the settings, by hand.

use super::*;
use crate::estimation::terms::Terms;
use crate::identifier::tests::bench::{Trends, config, trends};
use crate::trends::{Memory, RawTrends, Scheme};

type Plan3 = Plan<Trends, 3, 3, 1>;

fn near(found: f32, exact: f32) {
    assert!((found / exact - 1.0).abs() < 1e-4, "{found} for {exact}");
}

#[test]
fn limits_and_noise_are_in_the_units_of_the_signals() {
    let mut config = config();
    (config.memory, config.output_noise, config.settling) = (Some(2.5), 0.07, 0.3);
    let plan = Plan3::new(&config, trends(20.0), 0).expect("settings");
    near(plan.inputs.limit[0], 0.4e6);
    near(plan.output_limit, 50e6);
    // A sample of 2500.
    near(1.0 - plan.forgetting, 4e-4);
    assert!((299..=300).contains(&plan.warm_up));
    near(plan.noise.least, (0.07 / 50.0) * (0.07 / 50.0));
    // Half a digit of this position is the noise: 2^-24 of it.
    near(plan.noise.coarse, 0.07 * 16_777_216.0);
    // Of a sample of y the left-hand side takes its share, over 50.
    let top = trends(20.0).design().feedthrough.top;
    near(plan.noise.prior, 0.07 * top / 50.0);
    let least = 0.02 * 0.07 * top / 50.0;
    near(plan.change_shares.least, least * least);
    near(plan.change_shares.lag, 0.04 / 1.04);
    // Without a memory nothing is forgotten, and without a time the filter's is waited for.
    (config.memory, config.settling) = (None, 0.0);
    let plan = Plan3::new(&config, trends(20.0), 0).expect("settings");
    assert_eq!(
        (plan.forgetting, plan.forgets, plan.warm_up),
        (1.0, false, 1)
    );
}

#[test]
fn changes_are_followed_with_a_memory_only() {
    for (memory, follow, follows) in [
        (None, true, false),
        (Some(2.0), false, false),
        (Some(2.0), true, true),
    ] {
        let mut config = config();
        (config.memory, config.follow_changes) = (memory, follow);
        let plan = Plan3::new(&config, trends(20.0), 0).expect("settings");
        assert_eq!(plan.follows_changes, follows);
    }
}

#[test]
fn spikes_are_replaced_where_filtered_sampled_finely_and_smooth() {
    // Without a memory a sample is implausible only beyond the noise that is stated.
    let stated = config().output_noise;
    let gate = |memory: Option<f32>, sample_time: f32| {
        let trends = Trends::for_bandwidth(Scheme::Tustin, sample_time, 20.0).expect("a filter");
        let mut config = config();
        config.memory = memory;
        let plan = Plan3::new(&config, trends, 0).expect("settings");
        let least = if memory.is_some() {
            0.0
        } else {
            stated * stated
        };
        assert_eq!(plan.noise.gate, least);
        plan.has_gate
    };
    assert!(gate(Some(2.0), 1e-3) && gate(Some(2.0), 4.99e-3));
    assert!(!gate(Some(2.0), 5.01e-3) && gate(None, 1e-3));
    let mut config = config();
    config.memory = Some(2.0);
    let raw = RawTrends::<3>::try_new(Scheme::Tustin, 1e-3).expect("trends");
    let plan = Plan::new(&config, raw, 0).expect("settings");
    assert!(!plan.has_gate);
    // An input one integration before y moves it in steps, unless its coefficient is known to be 0.
    for (powers, known, initial, gate) in [
        ([0, 1], false, 0.0, true),
        ([1, 2], false, 0.0, false),
        ([1, 2], true, 0.0, true),
        ([1, 2], true, 1.0, false),
    ] {
        let inputs = [Terms::of(&powers)];
        let structure = Structure::<3, 4, 1>::try_new(Terms::of(&[1, 2]), inputs, false);
        let mut config = Config::new(structure.expect("a structure"), 20.0, [0.4], 50.0);
        config.memory = Some(2.0);
        (config.known[3], config.initial[3]) = (known, initial);
        let plan = Plan::new(&config, trends(20.0), 0).expect("settings");
        assert_eq!(plan.has_gate, gate);
    }
}

#[test]
fn behind_an_integrator_increments_count_and_an_axis_can_stand() {
    for (powers, stands) in [([1, 2], true), ([0, 1], false)] {
        let inputs = [Terms::of(&[0])];
        let structure = Structure::<3, 3, 1>::try_new(Terms::of(&powers), inputs, false);
        let config = Config::new(structure.expect("a structure"), 20.0, [0.4], 50.0);
        let plan = Plan::new(&config, trends(20.0), 0).expect("settings");
        assert_eq!(plan.can_stand, stands);
        assert_eq!(plan.output_form == Form::Increment, stands);
    }
}

/// The sum of squares of each entry of the regressor behind a single 1 among zeros on y.
fn squares(plan: &Plan3) -> [f32; 3] {
    let design = plan.trends.design();
    let mut memory = Memory::output_at_rest(design, Form::Position, 0.0);
    let mut squares = [0.0; 3];
    for k in 0..10_000 {
        let y = if k == 0 { 1.0 } else { 0.0 };
        let trends = plan.trends.output(&mut memory, y, Form::Position);
        let (phi, _) = (plan.regressor).assemble(&trends, &[[0.0; 3]], &[0.0; 2]);
        for (sum, x) in squares.iter_mut().zip(phi) {
            *sum += x * x;
        }
    }
    squares
}

#[test]
fn a_drive_moves_where_its_trends_are_five_deviations_of_their_noise() {
    let plan = Plan3::new(&config(), trends(20.0), 0).expect("settings");
    let [first, second, input] = squares(&plan);
    assert_eq!(input, 0.0);
    let variance = 0.3;
    // By the first entry, by the second and by both; the input says nothing.
    for share in [0.0_f32, 0.4, 1.0] {
        let whole = [share * first, (1.0 - share) * second];
        let sizes = whole.map(|m| libm::sqrtf(25.0 * m * variance));
        for (scale, moves) in [(0.99, false), (1.01, true)] {
            let phi = [scale * sizes[0], -scale * sizes[1], 1e6];
            assert_eq!(plan.moves(&phi, variance), moves, "{share} {scale}");
        }
    }
    // Before the noise is known it does, and where the noise has no known share.
    assert!(plan.moves(&[0.0; 3], -1.0) && !plan.moves(&[0.0; 3], 0.0));
    let raw = RawTrends::<3>::try_new(Scheme::Tustin, 1e-3).expect("trends");
    let raw = Plan::new(&config(), raw, 0).expect("settings");
    assert!(raw.moves(&[0.0; 3], 1e30));
}

#[test]
fn friction_may_hold_an_axis_that_integrates_while_its_input_is_zero() {
    let plan = |friction, powers: [usize; 2]| {
        let inputs = [Terms::of(&[0]); 2];
        let structure = Structure::<3, 4, 2>::try_new(Terms::of(&powers), inputs, false);
        let mut config = Config::new(structure.expect("a structure"), 20.0, [0.4, 1.0], 50.0);
        config.friction_input = friction;
        Plan::new(&config, trends(20.0), 0).expect("settings")
    };
    for friction in [0, 1] {
        let plan = plan(Some(friction), [1, 2]);
        assert_eq!(
            (plan.friction_input(), plan.turns()),
            (Some(friction), true)
        );
        let mut u = [0.3, 0.3];
        assert!(!plan.sticks(&u));
        u[friction] = 0.0;
        assert!(plan.sticks(&u));
        u = [0.0, 0.0];
        u[friction] = -1.0;
        assert!(!plan.sticks(&u));
    }
    let (none, held) = (plan(None, [1, 2]), plan(Some(1), [0, 1]));
    assert_eq!((none.friction_input(), none.turns()), (None, false));
    assert!(!none.sticks(&[0.0; 2]) && !held.sticks(&[0.0; 2]));
}

#[test]
fn trends_are_exchanged_and_those_of_the_construction_come_back() {
    let first = Plan3::new(&config(), trends(20.0), 0).expect("settings");
    let mut plan = first.clone();
    plan.restore();
    assert_eq!(plan, first);
    for bandwidth in [35.0, 50.0] {
        plan.retune(trends(bandwidth));
        let wanted = Plan3::new(&config(), trends(bandwidth), 0).expect("settings");
        assert_eq!(plan.trends, wanted.trends);
        assert_eq!(plan.regressor, wanted.regressor);
        assert_eq!(plan.noise.weights, wanted.noise.weights);
        assert_eq!(plan.prior, first.prior);
    }
    plan.restore();
    assert_eq!(plan, first);
}

#[test]
fn a_filter_is_the_same_with_its_poles_and_its_scheme() {
    let plan = Plan3::new(&config(), trends(20.0), 0).expect("settings");
    assert!(plan.same_filter(&trends(20.0)) && !plan.same_filter(&trends(21.0)));
    let goodwin = Trends::for_bandwidth(Scheme::Goodwin, 1e-3, 20.0).expect("a filter");
    assert!(!plan.same_filter(&goodwin));
    let raw = RawTrends::<3>::try_new(Scheme::Tustin, 1e-3).expect("trends");
    let plan = Plan::new(&config(), raw.clone(), 0).expect("settings");
    assert!(!plan.same_filter(&raw));
}

#[test]
fn times_are_in_proportion_to_one_over_the_bandwidth() {
    let about = |found: u32, exact: f32| {
        assert!((found as f32 - exact).abs() <= 1.0, "{found} for {exact}");
    };
    for bandwidth in [20.0, 50.0] {
        let trends = trends(bandwidth);
        let integrating = Structure::<3, 3, 1>::INTEGRATING;
        let mut config: Config<3, 3, 1> = Config::new(integrating, bandwidth, [0.4], 50.0);
        let times = Times::new(&config, trends.design(), true);
        let unit = 1000.0 / bandwidth;
        about(times.gate_open, 10.0 * unit);
        about(times.gate_pause, 0.5 * unit);
        about(times.certain, unit + 10.0);
        about(times.after_step, 2.0 * unit);
        about(times.longest_gap, 5.0 * unit);
        about(times.change_blind, 10.0 * unit);
        // Three time constants of a pair of 1.1 times the bandwidth and a damping of 0.7.
        about(times.change_settling, 3.0 / 0.77 * unit);
        // Three of the slow pole, a tenth of that; or with an initial state twelve of the drive.
        about(times.settled, 3.0 / 0.11 * unit + 1.5);
        // As many rows that tell something new as there are parameters, or half of a memory.
        assert!((times.known_rows - 3.0 * unit).abs() < 0.1);
        about(times.start.longest, unit);
        assert!((times.start.bend - 50.0 / (12.0 * unit * unit)).abs() < 1e-5);
        config.memory = Some(0.08);
        let times = Times::new(&config, trends.design(), true);
        assert!((times.known_rows - 40.0).abs() < 0.1);
        let config = Config::new(Structure::<3, 5, 1>::SERVO, bandwidth, [0.4], 50.0);
        let times = Times::new(&config, trends.design(), true);
        about(times.settled, 12.0 * unit);
    }
    // A filter that settles sooner than the drive.
    let quick = Trends::try_new(Scheme::Tustin, 1e-3, [100.0; 3]).expect("a filter");
    let config = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [0.4], 50.0);
    let times = Times::new(&config, quick.design(), true);
    about(times.settled, 600.0);
}

#[test]
fn no_line_is_laid_through_a_start_whose_velocity_has_steps() {
    let plan = |inputs: Terms| {
        let structure = Structure::<3, 4, 1>::try_new(Terms::of(&[1, 2]), [inputs], false);
        let config = Config::new(structure.expect("a structure"), 20.0, [0.4], 50.0);
        Plan::<Trends, 3, 4, 1>::new(&config, trends(20.0), 0).expect("settings")
    };
    assert!(plan(Terms::of(&[0, 1])).times.start.longest >= 49);
    assert_eq!(plan(Terms::of(&[0, 2])).times.start.longest, 0);
}
