//! The units of a record do not matter, whatever happens in it.
//!
//! All numbers of a record are multiplied by powers of two, and with them what is told of it: every
//! outcome is then the same to the last bit. A number that enters from elsewhere is not.

use proptest::prelude::*;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Outcome, Structure};

const DT: f32 = 1e-3;

/// What happens for a while.
#[derive(Clone, Copy, Debug)]
enum Piece {
    /// The drive obeys.
    Free,
    /// It stands where it stood, whatever the command.
    Blocked,
    /// Now and then a reading is wrong.
    Spikes,
    /// Now and then there is none.
    Gaps,
    /// From here on the drive is twice as strong.
    Changed,
}

/// Pieces with a command and a length each.
fn pieces() -> impl Strategy<Value = Vec<(Piece, f32, usize)>> {
    let piece = prop::sample::select(vec![
        Piece::Free,
        Piece::Blocked,
        Piece::Spikes,
        Piece::Gaps,
        Piece::Changed,
    ]);
    prop::collection::vec((piece, -0.4_f32..0.4, 60_usize..700), 6..16)
}

/// Command and reading of each sample; `None` where there is no reading.
fn samples(pieces: &[(Piece, f32, usize)]) -> Vec<(f32, Option<f32>)> {
    let (mut x, mut v, mut a, mut gain) = (20.0_f64, 0.0_f64, 0.0_f64, 1e6);
    let mut noise = 1_u32;
    let mut samples = Vec::new();
    for (k, (piece, level, length)) in pieces.iter().enumerate() {
        if matches!(piece, Piece::Changed) {
            gain = 2e6;
        }
        for i in 0..*length {
            // Excited by reversals, so that there is a model to contradict.
            let level = if (i / 40) % 3 == 1 && k % 2 == 0 {
                -level
            } else {
                *level
            };
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let n = 1e-2 * (f64::from(noise >> 8) / 8_388_608.0 - 1.0);
            let spike = matches!(piece, Piece::Spikes) && i % 57 == 3;
            let y = (x + n + if spike { 5.0 } else { 0.0 }) as f32;
            let missing = matches!(piece, Piece::Gaps) && i % 23 == 7;
            samples.push((level, (!missing).then_some(y)));
            if matches!(piece, Piece::Blocked) {
                (v, a) = (0.0, 0.0);
                continue;
            }
            for _ in 0..5 {
                let (dt, jerk) = (2e-4, gain * f64::from(level) - 20.0 * a - 400.0 * v);
                x += dt * (v + 0.5 * dt * a);
                v += dt * (a + 0.5 * dt * jerk);
                a += dt * jerk;
            }
        }
    }
    samples
}

/// Outcomes with their innovations in the first unit, and theta at the end.
fn run(
    samples: &[(f32, Option<f32>)],
    [memory, changes]: [bool; 2],
    [of_u, of_y]: [f32; 2],
) -> (Vec<Outcome>, [f32; 5]) {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT, 20.0).expect("a filter");
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4 * of_u], 50.0 * of_y);
    config.memory = memory.then_some(0.5);
    config.follow_changes = memory && changes;
    let mut identifier = Identifier::<_, 3, 5>::try_new(&config, trends).expect("settings");
    let outcomes = samples.iter().filter_map(|(u, y)| match y {
        Some(y) => Some(scaled(identifier.update(u * of_u, y * of_y), 1.0 / of_y)),
        None => {
            identifier.skip(1);
            None
        }
    });
    let outcomes = outcomes.collect();
    let [a1, a2, b0, start, offset] = identifier.recursion().theta();
    let theta = [a1, a2, b0 * of_u / of_y, start / of_y, offset / of_y];
    (outcomes, theta)
}

fn scaled(outcome: Outcome, factor: f32) -> Outcome {
    match outcome {
        Outcome::Replaced { innovation } => Outcome::Replaced {
            innovation: innovation * factor,
        },
        Outcome::Held { innovation } => Outcome::Held {
            innovation: innovation * factor,
        },
        Outcome::Estimated { innovation } => Outcome::Estimated {
            innovation: innovation * factor,
        },
        other => other,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn every_outcome_is_that_of_the_same_record_in_other_units(
        pieces in pieces(),
        memory in any::<bool>(),
        changes in any::<bool>(),
    ) {
        let samples = samples(&pieces);
        let settings = [memory, changes];
        let (plain, theta) = run(&samples, settings, [1.0, 1.0]);
        for units in [[4.0, 0.125], [0.5, 64.0]] {
            let (other, other_theta) = run(&samples, settings, units);
            for (k, (a, b)) in plain.iter().zip(&other).enumerate() {
                prop_assert_eq!(a, b, "sample {} in {:?}", k, units);
            }
            prop_assert_eq!(theta, other_theta);
        }
    }
}
