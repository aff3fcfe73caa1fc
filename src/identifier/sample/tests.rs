//! What a sample does beside its row.

use super::*;
use crate::identifier::tests::bench::{Drive, Servo3, Trends, config, identifier, trained};
use crate::trends::Chain;

/// What decays in a state, as far as it is not zero.
fn decayed(state: &State<Trends, 3, 3, 1, 0>) -> [bool; 3] {
    let zero = |chain: &Chain<3>| chain.states == [0.0; 3];
    let signals = &state.signals;
    [
        zero(&signals.output),
        zero(&signals.inputs[0]),
        zero(&signals.constant),
    ]
}

#[test]
fn each_eighth_part_flushes_what_is_its_own() {
    let mut servo = identifier(&config());
    let state = &mut servo.state;
    let tiny = Chain {
        states: [1e-30; 3],
        last: 0.0,
        pending: [0.0; 2],
    };
    for round in [0, 8, 16] {
        for part in 0..8 {
            state.signals.output = tiny;
            state.signals.inputs = [tiny];
            state.signals.constant = tiny;
            let mut wanted = state.clone();
            state.flush(round + part);
            let found = decayed(state);
            assert_eq!(found, [part % 4 == 0, part == 1, part == 5], "{part}");
            // The sums of estimator and noise, and what the detector of changes remembers.
            match part {
                0 | 4 => wanted.signals.flush_output(),
                1 => wanted.signals.flush_inputs(),
                2 => wanted.estimator.flush_sums(),
                3 => wanted.noise.flush(),
                5 => wanted.signals.flush_constant(),
                6 => wanted.change.flush_lagged(),
                _ => wanted.change.flush_power(),
            }
            assert_eq!(*state, wanted);
        }
    }
}

/// An identifier whose command ended long ago, with its memory, that adapts or not, while y moves
/// or not.
fn long_after(memory: Option<f32>, adapts: bool, moves: bool) -> Servo3 {
    let mut config = config();
    config.memory = memory;
    let (mut servo, mut drive) = trained(&config, 1500);
    servo.adapt(adapts);
    let rest = drive.at[0];
    for k in 1500..300_000 {
        let y = if moves { drive.sample(k)[1] } else { rest };
        let _ = servo.update(0.0, y);
    }
    servo
}

#[test]
fn what_has_decayed_ends_at_zero_however_samples_are_taken() {
    for memory in [None, Some(2.0)] {
        for adapts in [true, false] {
            for moves in [true, false] {
                let servo = long_after(memory, adapts, moves);
                let [output, input, _] = decayed(&servo.state);
                assert_eq!(
                    (output, input),
                    (!moves, true),
                    "{memory:?} {adapts} {moves}"
                );
                if !moves {
                    // Nor is anything left that would be flushed.
                    let mut flushed = servo.state.clone();
                    (0..8).for_each(|part| flushed.flush(part));
                    assert_eq!(servo.state, flushed, "{memory:?} {adapts}");
                }
            }
        }
    }
}

#[test]
fn a_drive_that_does_not_move_teaches_nothing() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, mut drive) = trained(&config, 3000);
    for _ in 0..10_000 {
        let y = drive.under(0.0);
        let _ = servo.update(0.0, y);
    }
    servo.state.estimator.finish_observation();
    let before = servo.estimator().clone();
    for _ in 0..100 {
        let y = drive.under(0.0);
        assert!(matches!(servo.update(0.0, y), Outcome::Held { .. }));
    }
    assert_eq!(servo.estimator().theta(), before.theta());
    assert_eq!(servo.estimator().samples(), before.samples());
}

#[test]
fn a_motion_lasts_as_long_as_the_trends_show_it() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, _) = trained(&config, 3000);
    let row = |x| Row {
        phi: [x, 0.0, 0.0],
        psi: 0.0,
        error: 0.0,
        innovation: 0.0,
    };
    let noise = Noise {
        known: 1.0,
        allowed: 1.0,
    };
    let (plan, state) = (&servo.plan, &mut servo.state);
    let still = |state: &mut State<_, 3, 3, 1, 0>| {
        let moving = (0..1000).take_while(|_| state.is_moving(plan, &row(0.0), noise));
        moving.count() as u32
    };
    let _ = still(state);
    for samples in [1, 3, 100] {
        for _ in 0..samples {
            assert!(state.is_moving(plan, &row(1e6), noise));
        }
        assert_eq!(still(state), plan.times.after_step - 1);
    }
}

/// The noise is known a sample later with a memory.
#[test]
fn a_memory_waits_for_where_y_begins_as_long_as_none() {
    let began = |memory, noise: f32| {
        let mut config = config();
        config.memory = memory;
        let mut servo = identifier(&config);
        let mut drive = Drive::new(1e-4);
        (0..1000).find(|k| {
            let [u, y] = drive.sample(*k);
            let y = y + noise * drive.draw();
            !matches!(servo.update(u, y), Outcome::WarmingUp { .. })
        })
    };
    for noise in [1.0, 10.0, 100.0] {
        let without = began(None, noise);
        assert!(without > Some(11), "{noise}: {without:?}");
        assert_eq!(began(Some(0.5), noise), without, "{noise}");
        assert_eq!(began(Some(10.0), noise), without, "{noise}");
    }
}

#[test]
fn an_outcome_has_the_innovation_that_was_predicted() {
    let mut config = config();
    (config.memory, config.settling) = (Some(2.0), 0.01);
    let mut servo = identifier(&config);
    let mut drive = Drive::new(1e-3);
    let (mut replaced, mut estimated) = (0, 0);
    for k in 0..3000 {
        let [u, y] = drive.sample(k);
        // A spike now and then.
        let spike = if k % 97 == 96 { 20.0 } else { 0.0 };
        let y = 300.0 + y + spike;
        let outcome = servo.update(u, y);
        let innovation = match outcome {
            Outcome::Estimated { innovation } | Outcome::Held { innovation } => {
                estimated += 1;
                assert_eq!(outcome.innovation(), Some(innovation));
                innovation
            }
            Outcome::WarmingUp { remaining } => {
                // And at least one more while the beginning is looked for.
                let settles = (servo.plan.warm_up - 1).saturating_sub(k);
                let looks = u32::from(servo.state.signals.start.is_some());
                assert_eq!(remaining, settles.max(looks));
                assert!(k < servo.plan.times.start.longest);
                assert_eq!(outcome.innovation(), None);
                0.0
            }
            Outcome::Replaced { innovation } => {
                replaced += 1;
                assert_eq!(outcome.innovation(), None);
                assert!((innovation - spike).abs() < 2.0, "{k}: {innovation}");
                continue;
            }
            Outcome::Refused(_) => panic!("{k}: {outcome:?}"),
        };
        let error = servo.prediction() + innovation - y;
        assert!(error.abs() < 1e-3, "{k}: {error}");
    }
    // All spikes behind the time for which the gate is open.
    assert!(replaced >= 24 && replaced == servo.replaced(), "{replaced}");
    assert!(estimated > 2900);
}

#[test]
fn nominal_values_follow_where_the_position_is_resolved() {
    let mut config = config();
    config.memory = Some(2.0);
    let mut servo = identifier(&config);
    let (plan, state) = (&servo.plan, &mut servo.state);
    for (reference, position, resolved) in [
        (0.0, 0.99, true),
        (0.0, 1.01, false),
        (0.0, -0.99, true),
        (0.0, -1.01, false),
        // Half as well as where it began.
        (2.0, 3.98, true),
        (2.0, 4.02, false),
        (-2.0, 3.98, true),
        (0.1, 1.01, false),
    ] {
        state.signals.reference = reference * plan.noise.coarse;
        state.signals.last = (position - reference) * plan.noise.coarse;
        for part in [0, 8, 3] {
            let mut wanted = state.forgetting.clone();
            if part % 8 == 0 {
                wanted.heed(resolved);
            }
            state.tidy(plan, part);
            assert_eq!(state.forgetting, wanted, "{reference} {position}");
            state.forgetting.heed(!resolved);
        }
    }
}
