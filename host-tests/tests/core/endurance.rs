//! What holds for hours: every limit, no subnormal number, a filter that follows the plant.

use std::hint::black_box;
use std::time::Instant;

use rand::RngExt;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::endurance::run::run;
use trendid_host_tests::endurance::scenario::{MEMORIES, SCENARIOS, Setup, cases};
use trendid_host_tests::plants::servo::Servo;
use trendid_host_tests::signals::noise::{Stream, generator};

const DT: f32 = 1e-3;

/// A servo whose bandwidth grows threefold within an hour, its filter following each ten seconds.
#[test]
fn a_bandwidth_that_drifts_is_followed_by_retuning() {
    let servo = |w: f64| Servo {
        c: 2500.0,
        omega0: w,
        xi: 0.5,
    };
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT, 20.0).unwrap();
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    config.memory = Some(2.0);
    let mut identifier: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
    let mut random = generator(230_000, Stream::White);
    let mut plant = servo(20.0).plant(f64::from(DT));
    let (mut retuned, mut worst_step, mut worst_error, mut bit) = (0, 0.0_f32, 0.0_f64, 0.4);
    let seconds = 3600;
    for second in 0..seconds {
        let w = 20.0 * 3.0_f64.powf(f64::from(second) / f64::from(seconds));
        let state = [plant.output(), plant.derivative(1), plant.derivative(2)];
        plant = servo(w).plant(f64::from(DT));
        plant.place(&state);
        for k in 0..1000 {
            if k % 40 == 0 {
                bit = if random.random::<bool>() { 0.4 } else { -0.4 };
            }
            let noise = 0.01 * (random.random::<f64>() - 0.5);
            let _ = identifier.update(bit as f32, (plant.output() + noise) as f32);
            plant.step(&[bit]);
        }
        let diagonal = identifier.estimator().diagonal();
        assert!(diagonal.iter().all(|d| *d > 0.0 && d.is_finite()));
        if second > 5 {
            let found = identifier.estimate().physical().omega0.unwrap();
            worst_error = worst_error.max((f64::from(found) / w - 1.0).abs());
        }
        if second % 10 == 9 {
            let before = identifier.theta();
            let found = identifier.estimate().physical().omega0.unwrap();
            identifier.retune_to(found).unwrap();
            retuned += 1;
            for (a, b) in identifier.theta().iter().zip(before).take(3) {
                worst_step = worst_step.max((a / b - 1.0).abs());
            }
        }
    }
    println!(
        "{retuned} retunings within an hour from 20 to 60 rad/s: largest error of omega0 {:.2} %, largest step {worst_step:.1e}",
        100.0 * worst_error
    );
    assert!(worst_step < 1e-4 && worst_error < 0.03);
}

/// A million samples of each scenario with each memory, on the drive of the table.
/// `cargo xtask soak` runs all structures, bandwidths and noises that long.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn a_million_samples_of_each_scenario_keep_every_limit() {
    const FIRST_SEED: u64 = 260_000;
    let broken: Vec<String> = std::thread::scope(|scope| {
        let threads = MEMORIES.map(|memory| {
            scope.spawn(move || {
                let all = cases().into_iter().enumerate();
                let mine: Vec<_> = all
                    .filter(|(_, case)| {
                        case.setup == Setup::DEFAULT && !case.trusted && case.memory == memory
                    })
                    .collect();
                assert_eq!(mine.len(), SCENARIOS.len());
                let broken = mine.into_iter().filter_map(|(index, case)| {
                    let found = run(&case, FIRST_SEED + index as u64, 1_000_000, 0);
                    let what = found.violation(&case)?;
                    Some(format!("{}, {memory:?} s: {what}, {found:?}", case.name()))
                });
                broken.collect::<Vec<_>>()
            })
        });
        let ended = threads.into_iter().map(|thread| thread.join().unwrap());
        ended.flatten().collect()
    });
    assert!(broken.is_empty(), "{broken:#?}");
}

/// Numbers in the text of a value that are subnormal.
fn subnormal(text: &str) -> Vec<&str> {
    text.split(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | 'e')))
        .filter(|word| word.parse::<f32>().is_ok_and(f32::is_subnormal))
        .collect()
}

/// At rest every signal of a filter decays; a subnormal number makes each operation with it many
/// times as long.
#[test]
fn a_long_rest_leaves_no_subnormal_number() {
    assert_eq!(subnormal("x: [1.0, -1e-40]"), ["-1e-40"]);
    for (memory, noise) in [
        (Some(0.2), 0.0),
        (Some(0.2), 0.01),
        (Some(2.0), 0.0),
        (Some(2.0), 0.01),
        (None, 0.0),
        (None, 0.01),
    ] {
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT, 20.0).unwrap();
        let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
        config.memory = memory;
        let mut identifier: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
        let mut plant = Servo {
            c: 2500.0,
            omega0: 20.0,
            xi: 0.5,
        }
        .plant(f64::from(DT));
        let mut random = generator(231_000, Stream::White);
        for k in 0..510_000 {
            let u = match k {
                ..10_000 if (k / 50) * 7919 % 13 < 6 => 0.4,
                ..10_000 => -0.4,
                _ => 0.0,
            };
            let noise = noise * (random.random::<f64>() - 0.5);
            let _ = identifier.update(u as f32, (plant.output() + noise) as f32);
            // The plant's own state decays too; it is left where it stands.
            if k < 20_000 {
                plant.step(&[u]);
            }
        }
        let text = format!("{identifier:?}");
        let found = subnormal(&text);
        assert!(
            found.is_empty(),
            "memory {memory:?}, noise {noise}: {found:?}"
        );
        // So an update costs there what it costs in motion.
        let rest = vec![(0.0, plant.output() as f32); 5000];
        let bits = (0..5000).map(|k| if (k / 50) * 7919 % 13 < 6 { 0.4 } else { -0.4 });
        let motion: Vec<_> = bits
            .map(|u| {
                plant.step(&[u]);
                (u as f32, plant.output() as f32)
            })
            .collect();
        // In turns: what slows the machine down slows both down.
        let shortest = |[still, moving]: [f64; 2], _| {
            let of = |samples: &[(f32, f32)]| time_of(&identifier, samples);
            [still.min(of(&rest)), moving.min(of(&motion))]
        };
        let [still, moving] = (0..40).fold([f64::INFINITY; 2], shortest);
        println!(
            "memory {memory:?}, noise {noise}: rest costs {:.2} of motion",
            still / moving
        );
        assert!(
            still < 1.2 * moving,
            "{memory:?}, {noise}: {still} {moving}"
        );
    }
}

/// Time in s in which the samples are taken.
fn time_of(identifier: &Identifier<FilteredTrends<3>, 3, 5>, samples: &[(f32, f32)]) -> f64 {
    let mut identifier = identifier.clone();
    let begin = Instant::now();
    for (u, y) in samples {
        let _ = black_box(identifier.update(*u, *y));
    }
    begin.elapsed().as_secs_f64()
}
