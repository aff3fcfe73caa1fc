//! Axes that friction holds at the turns of a slow motion.

use trendid::inputs::Coulomb;
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::valve::FrictionDrive;

type WithDelay<const D: usize> = Identifier<FilteredTrends<2>, 2, 4, 2, D>;

/// A drive of 20 rad/s under Coulomb friction, whose command is `delay` and a `part` of a sample late.
fn identifier<const D: usize>(delay: usize, part: f32) -> WithDelay<D> {
    let structure = Structure::<2, 4, 2>::INTEGRATING_WITH_CONSTANT;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let mut config = Config::new(structure, 20.0, [1.0, 1.0], 1.0);
    config.friction_input = Some(1);
    config.holds[1] = Hold::Mean;
    (config.delays[0], config.delay_parts[0]) = (delay, part);
    Identifier::try_new(&config, trends).unwrap()
}

/// What a delay in front of the identifier makes of the commands so far.
fn late(commands: &[f32], delay: usize, part: f32) -> f32 {
    let past = |back: usize| match commands.len() {
        n if n > back => commands[n - 1 - back],
        _ => 0.0,
    };
    let (newer, older) = (past(delay), past(delay + 1));
    match part > 0.0 {
        true => newer + part * (older - newer),
        false => newer,
    }
}

/// A command enters its delay line once in a sample, whatever holds the axis.
#[test]
fn a_delay_inside_is_a_delay_in_front() {
    for (delay, part) in [(1, 0.0), (3, 0.0), (6, 0.0), (2, 0.25), (5, 0.75)] {
        let mut drive = FrictionDrive::new(20.0, 100.0, 30.0, 3.0);
        let mut friction = Coulomb::new(1e-4);
        let (mut inside, mut in_front) = (identifier::<6>(delay, part), identifier::<0>(0, 0.0));
        let (mut commands, mut stuck, mut longest) = (Vec::new(), 0, 0);
        for k in 0..8000 {
            let t = 1e-3 * f64::from(k);
            let u = (0.8 * (3.1 * t).sin() + 0.3 * (17.0 * t).sin()) as f32;
            commands.push(u);
            let (u_late, y) = (late(&commands, delay, part), drive.output() as f32);
            let sign = friction.update(drive.velocity() as f32);
            stuck = if sign == 0.0 { stuck + 1 } else { 0 };
            longest = longest.max(stuck);
            let a = inside.update_inputs([u, sign], y);
            let b = in_front.update_inputs([u_late, sign], y);
            assert_eq!(a, b, "delay {delay} + {part}, sample {k}");
            assert_eq!(inside.estimator(), in_front.estimator());
            drive.step(f64::from(u_late), 1e-3);
        }
        // Longer than the half of 1/omega behind which the trends begin at rest.
        assert!(longest > 40, "{longest}");
        let [a1, b, c, _] = inside.theta();
        for (found, truth) in [(a1, 20.0), (b, 100.0), (c, -30.0)] {
            assert!((found / truth - 1.0).abs() < 0.02, "{found} for {truth}");
        }
    }
}
