//! Axes that friction holds at the turns of a slow motion.

use rand::RngExt;
use trendid::inputs::Coulomb;
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Identifier, Outcome, Structure};
use trendid_host_tests::endurance::motion::{Commands, Motion};
use trendid_host_tests::plants::valve::FrictionDrive;
use trendid_host_tests::random::log_uniform;
use trendid_host_tests::signals::noise::{Stream, generator};

type WithDelay<const D: usize> = Identifier<FilteredTrends<2>, 2, 4, 2, D>;

/// A drive of 20 rad/s under Coulomb friction, whose command is `delay` and a `part` of a sample
/// late.
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

/// Innovations behind a block that is taken away at sample 300 under a steady push, with one
/// command of the push other than the rest.
fn innovations(other: usize, command: f32) -> Vec<f32> {
    let (a, b) = (20.0_f64, 100.0_f64);
    let structure = Structure::<2, 2, 1>::INTEGRATING;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let mut config = Config::new(structure, 20.0, [1.0], 1.0);
    (config.initial, config.known) = ([a as f32, b as f32], [true; 2]);
    let mut identifier: Identifier<_, 2, 2> = Identifier::try_new(&config, trends).unwrap();
    let (mut y, mut v) = (0.0_f64, 0.0_f64);
    let decay = (-1e-3 * a).exp();
    (0..400)
        .map(|k| {
            let u = match k {
                _ if k == other => command,
                ..50 => 0.0,
                _ => 1.0,
            };
            let outcome = identifier.update(u, y as f32);
            if k >= 300 {
                let settled = b * f64::from(u) / a;
                y += 1e-3 * settled + (v - settled) * (1.0 - decay) / a;
                v = settled + (v - settled) * decay;
            }
            outcome.innovation().unwrap_or(0.0)
        })
        .collect()
}

/// Trends that begin again with an axis that is free begin with the command of that sample.
///
/// The axis leaves its band in two samples; their commands are in the speed at which it is found,
/// every later one in the trends.
#[test]
fn no_command_is_missing_where_an_axis_is_set_free() {
    let missing: Vec<(usize, f32)> = (300..320)
        .map(|other| {
            let (steady, changed) = (innovations(other, 1.0), innovations(other, 0.8));
            let behind = steady.iter().zip(&changed).skip(other + 1);
            let most = behind.fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()));
            (other, most)
        })
        .collect();
    for (other, most) in &missing {
        println!("command of sample {other}: its effect is missed by {most:.1e}");
    }
    // A fifth of a command moves the axis by 2e-5 in its sample, and by 1e-3 in the end.
    let lost: Vec<usize> = (missing.iter().filter(|(_, most)| *most > 1e-6))
        .map(|(other, _)| *other)
        .collect();
    assert_eq!(lost, [300, 301]);
}

/// Largest errors of a, b, c in percent behind the first quarter of 20 s, of a drive that is drawn:
/// bandwidth, friction, friction of rest, offset, and a slow motion of two sines.
///
/// `rest` is the velocity that counts as 0, over the largest one.
fn drawn(seed: u64, memory: Option<f32>, rest: f64) -> [f64; 3] {
    let mut random = generator(seed, Stream::Excitation);
    let mut noise = generator(seed, Stream::White);
    let mut within = |low: f64, high: f64| log_uniform(&mut random, low, high);
    let bandwidth = within(10.0, 40.0);
    let b = 100.0 * bandwidth;
    let c = within(0.05, 0.4) * b;
    let breakaway = within(1.0, 2.0) * c;
    let offset = 0.05 * c * (within(1.0, 9.0) - 5.0);
    let hz = within(0.5, 3.0);
    let amplitude = within(1.5, 6.0) * c / b;
    let (other, phase) = (hz * within(2.1, 3.7), within(1.0, 6.0));
    let mut drive = FrictionDrive::new(bandwidth, b, c, offset);
    drive.breakaway = breakaway;
    let command = |k: u32| {
        let t = std::f64::consts::TAU * 1e-3 * f64::from(k);
        amplitude * ((hz * t).sin() + 0.3 * (other * t + phase).sin())
    };
    let mut probe = drive;
    let fastest = (0..3000).fold(0.0_f64, |fastest, k| {
        probe.step(command(k), 1e-3);
        fastest.max(probe.velocity().abs())
    });
    let structure = Structure::<2, 4, 2>::INTEGRATING_WITH_CONSTANT;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, bandwidth as f32).unwrap();
    let stroke = (fastest / bandwidth) as f32;
    let mut config = Config::new(structure, bandwidth as f32, [amplitude as f32, 1.0], stroke);
    config.friction_input = Some(1);
    config.holds[1] = Hold::Mean;
    config.memory = memory;
    let mut identifier: WithDelay<0> = Identifier::try_new(&config, trends).unwrap();
    let mut friction = Coulomb::new((rest * fastest) as f32);
    let mut worst = [0.0_f64; 3];
    for k in 0..20_000 {
        let sign = friction.update(drive.velocity() as f32);
        let y = drive.output() + 0.01 * (noise.random::<f64>() - 0.5);
        let _ = identifier.update_inputs([command(k) as f32, sign], y as f32);
        drive.step(command(k), 1e-3);
        if k > 5000 && k % 997 == 0 {
            let [a, gain, held, _] = identifier.theta().map(f64::from);
            for (i, (found, truth)) in [(a, bandwidth), (gain, b), (held, -c)]
                .into_iter()
                .enumerate()
            {
                worst[i] = worst[i].max(100.0 * (found / truth - 1.0).abs());
            }
        }
    }
    worst
}

/// Axes that stick for some samples at every turn, at up to twice the friction of motion.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn sticks_of_any_length_teach_little() {
    // Chosen on seeds 1..241.
    let seeds = 200_201..200_301;
    for (memory, rest) in [
        (None, 1e-6),
        (Some(2.0), 1e-6),
        (Some(2.0), 1e-3),
        (Some(2.0), 1e-2),
    ] {
        let runs: Vec<_> = seeds
            .clone()
            .map(|seed| drawn(seed, memory, rest))
            .collect();
        let at = |share: usize| -> [f64; 3] {
            std::array::from_fn(|i| {
                let mut errors: Vec<f64> = runs.iter().map(|run| run[i]).collect();
                errors.sort_unstable_by(f64::total_cmp);
                errors[errors.len() * share / 100]
            })
        };
        let (median, most) = (at(50), at(95));
        println!(
            "memory {memory:?}, rest {rest}, seeds {seeds:?}: a/b/c off by {median:.2?} % (median), {most:.2?} % (95 %)"
        );
        // Twice what the seeds of the choice gave; in the widest band the axis moves.
        if rest < 1e-2 {
            let limits = match memory {
                None => [10.0, 3.0, 14.0],
                Some(_) => [6.0, 3.0, 6.0],
            };
            let within =
                |found: [f64; 3], limits: [f64; 3]| found.iter().zip(limits).all(|(x, l)| *x <= l);
            assert!(within(median, [0.4, 0.3, 0.6]) && within(most, limits));
        }
    }
}

/// Errors of a, b, c in percent behind ten seconds of motion, a minute of a slow sine, at whose
/// turns or all the time friction holds the axis, and ten seconds of motion again; and the share of
/// the samples that it was held in which the estimate was.
fn held_for_a_minute(seed: u64, memory: Option<f32>) -> ([f64; 3], f64) {
    let mut random = generator(seed, Stream::Excitation);
    let mut noise = generator(seed, Stream::White);
    let mut within = |low: f64, high: f64| log_uniform(&mut random, low, high);
    let bandwidth = within(10.0, 40.0);
    let b = 2500.0 * bandwidth;
    let c = within(0.02, 0.1) * b;
    let mut drive = FrictionDrive::new(bandwidth, b, c, 0.0);
    drive.breakaway = within(1.0, 2.0) * c;
    let (hz, level) = (within(0.2, 2.0), within(0.7, 2.5) * drive.breakaway / b);
    let structure = Structure::<2, 4, 2>::INTEGRATING_WITH_CONSTANT;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, bandwidth as f32).unwrap();
    let mut config = Config::new(structure, bandwidth as f32, [0.4, 1.0], 50.0);
    config.friction_input = Some(1);
    config.holds[1] = Hold::Mean;
    config.memory = memory;
    let mut identifier: WithDelay<0> = Identifier::try_new(&config, trends).unwrap();
    let mut friction = Coulomb::new(1e-4);
    let mut commands = Commands::new(seed, bandwidth, 2500.0, true, 1e-3);
    let (mut stuck, mut held) = (0.0, 0.0);
    for k in 0..80_000_u64 {
        let y = drive.output() + 0.01 * (noise.random::<f64>() - 0.5);
        let (sticks, u) = match k {
            10_000..70_000 => {
                let t = std::f64::consts::TAU * 1e-3 * k as f64;
                (drive.velocity() == 0.0, level * (hz * t).sin())
            }
            _ => (false, commands.next(Motion::Binary, k, y)),
        };
        let sign = friction.update(drive.velocity() as f32);
        let outcome = identifier.update_inputs([u as f32, sign], y as f32);
        if sticks {
            stuck += 1.0;
            held += f64::from(u8::from(matches!(outcome, Outcome::Held { .. })));
        }
        drive.step(u, 1e-3);
    }
    let [a, gain, found, _] = identifier.theta().map(f64::from);
    let off = |found: f64, truth: f64| 100.0 * (found / truth - 1.0).abs();
    let errors = [off(a, bandwidth), off(gain, b), off(found, -c)];
    (errors, if stuck > 0.0 { held / stuck } else { 1.0 })
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn ten_seconds_of_motion_mend_what_a_minute_of_friction_taught() {
    let seeds = 200_301..200_361;
    for memory in [Some(0.2), Some(2.0), Some(10.0), None] {
        let runs: Vec<_> = seeds
            .clone()
            .map(|seed| held_for_a_minute(seed, memory))
            .collect();
        let mut errors: Vec<f64> = (runs.iter())
            .map(|(errors, _)| errors.iter().copied().fold(0.0, f64::max))
            .collect();
        errors.sort_unstable_by(f64::total_cmp);
        let [median, most] = [50, 95].map(|share| errors[errors.len() * share / 100]);
        let within = errors.iter().filter(|error| **error <= 0.1).count();
        let held = runs.iter().map(|run| run.1).fold(1.0, f64::min);
        println!(
            "memory {memory:?}, seeds {seeds:?}: worst of a, b, c off by {median:.4} % (median), {most:.4} % (95 %); {within} of {} within 0.1 %; held in {:.0} % at least of the samples that friction did",
            errors.len(),
            100.0 * held
        );
        assert!(most <= 0.1 && held >= 0.9, "{memory:?}: {most} % {held}");
    }
}
