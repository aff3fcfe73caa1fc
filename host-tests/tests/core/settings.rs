//! The settings of an identifier: none is dead, and at its edge each is refused by name or works.

use std::collections::BTreeSet;

use trendid::estimation::Terms;
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, ConfigError, Identifier, Structure, structure};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::settings::names;
use trendid_host_tests::signals::noise::{Stream, generator};

type Settings = Config<3, 5, 1>;

fn defaults() -> Settings {
    Config::new(Structure::SERVO, 20.0, [1.0], 50.0)
}

type Change = fn(&mut Settings);

/// Every setting with a value that the identifier must notice.
const CHANGES: &[(&str, Change)] = &[
    ("structure", |c| {
        c.structure = structure!(Terms::between(1, 3), [Terms::up_to(3)], false);
    }),
    ("bandwidth", |c| c.bandwidth = 24.0),
    ("input_range", |c| c.input_range = [3.0]),
    ("output_range", |c| c.output_range = 80.0),
    ("output_noise", |c| c.output_noise = 1.0),
    ("holds", |c| c.holds = [Hold::First]),
    ("delays", |c| c.delays = [2]),
    ("delay_parts", |c| c.delay_parts = [0.5]),
    ("initial_input", |c| c.initial_input = [0.2]),
    ("memory", |c| c.memory = Some(0.5)),
    // It acts with a memory only; what it does is in `changes`.
    ("follow_changes", |c| {
        c.memory = Some(0.5);
        c.follow_changes = true;
    }),
    ("friction_input", |c| c.friction_input = Some(0)),
    ("initial", |c| c.initial = [300.0, 15.0, 8e5, 0.0, 0.0]),
    ("prior_std", |c| {
        c.prior_std = Some([100.0, 5.0, 1e6, 1e4, 1.0])
    }),
    ("known", |c| c.known = [false, false, false, true, false]),
    ("settling", |c| c.settling = 0.1),
    ("offset_significance", |c| c.offset_significance = 0.0),
];

/// No setting of a user: the position loop, which tests its models, sets it for its identifier.
const SET_BY_THE_LOOP: &str = "supervised";

/// Estimates and their standard deviations on the way through a noisy second.
fn trace(config: &Settings) -> Result<Vec<u32>, ConfigError> {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0)?;
    let mut identifier: Identifier<_, 3, 5, 1, 3> = Identifier::try_new(config, trends)?;
    let mut plant = REFERENCE.plant(1e-3);
    let mut noise = generator(230_001, Stream::White);
    let mut trace = Vec::new();
    for k in 0..1000 {
        let u = match k {
            900.. => 0.0,
            _ if k % 300 < 150 => 0.4,
            _ => -0.4,
        };
        let y = plant.output() + 0.1 * (rand::RngExt::random::<f64>(&mut noise) - 0.5);
        let _ = identifier.update(u as f32, y as f32);
        plant.step(&[u]);
        if k % 50 == 0 {
            let estimate = identifier.estimate();
            trace.extend(estimate.theta().map(f32::to_bits));
            trace.extend(estimate.std().map(f32::to_bits));
        }
    }
    Ok(trace)
}

#[test]
fn every_setting_is_listed() {
    let listed: BTreeSet<String> = CHANGES.iter().map(|(name, _)| name.to_string()).collect();
    let groups = names(&defaults());
    let found: BTreeSet<String> = groups
        .iter()
        .map(|name| name.split('.').next().unwrap_or(name).to_string())
        .filter(|name| name != SET_BY_THE_LOOP)
        .collect();
    assert_eq!(found, listed);
}

#[test]
fn every_setting_changes_what_is_found() {
    let usual = trace(&defaults()).expect("settings");
    for (name, change) in CHANGES {
        let mut config = defaults();
        change(&mut config);
        let changed = trace(&config).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(usual != changed, "{name} has no effect");
    }
}

/// Puts a value into one setting.
type Put = fn(&mut Settings, f32);

#[test]
fn a_value_that_cannot_work_is_refused_with_the_name_of_its_setting() {
    let cases: [(&str, Option<usize>, Put); 9] = [
        ("bandwidth", None, |c, x| c.bandwidth = x),
        ("input_range", Some(0), |c, x| c.input_range = [x]),
        ("output_range", None, |c, x| c.output_range = x),
        ("output_noise", None, |c, x| c.output_noise = x),
        ("memory", None, |c, x| c.memory = Some(x)),
        ("prior_std", Some(1), |c, x| {
            c.prior_std = Some([1.0, x, 1.0, 1.0, 1.0])
        }),
        ("settling", None, |c, x| c.settling = x),
        ("offset_significance", None, |c, x| {
            c.offset_significance = x
        }),
        ("initial", Some(2), |c, x| {
            c.initial = [0.0, 0.0, if x < 0.0 { f32::NAN } else { x }, 0.0, 0.0];
        }),
    ];
    for value in [f32::NAN, f32::INFINITY, -1.0] {
        for (name, index, put) in cases {
            let mut config = defaults();
            put(&mut config, value);
            let wanted = index.map_or(name.into(), |index| (name, index).into());
            match trace(&config) {
                Err(
                    ConfigError::NotFinite { setting, .. }
                    | ConfigError::NotPositive { setting, .. }
                    | ConfigError::OutOfRange { setting, .. },
                ) => assert_eq!(setting, wanted, "{name} = {value}"),
                other => panic!("{name} = {value}: {other:?}"),
            }
        }
    }
    let mut config = defaults();
    config.friction_input = Some(1);
    match trace(&config) {
        Err(ConfigError::OutOfRange {
            setting, limits, ..
        }) => {
            assert_eq!((setting, limits), ("friction_input".into(), [0.0; 2]));
        }
        other => panic!("friction_input: {other:?}"),
    }
    let far: [(&str, Change); 2] = [
        ("initial_input", |c| c.initial_input = [f32::NAN]),
        ("delays", |c| c.delays = [4]),
    ];
    for (name, change) in far {
        let mut config = defaults();
        change(&mut config);
        match trace(&config) {
            Err(ConfigError::OutOfRange { setting, .. }) => assert_eq!(setting, (name, 0).into()),
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// One changed setting, and a run through motion and rest.
fn edge(name: &str, change: impl FnOnce(&mut Config<3, 5, 1>), sample_time: f32) -> bool {
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    change(&mut config);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, sample_time, config.bandwidth);
    let identifier = trends.and_then(|trends| Identifier::<_, 3, 5>::try_new(&config, trends));
    let mut identifier = match identifier {
        Ok(identifier) => identifier,
        Err(error) => {
            println!("{name}: {error}");
            return false;
        }
    };
    // A drive of the bandwidth of the design, in its units.
    let (w, dt) = (f64::from(config.bandwidth), f64::from(sample_time));
    let scale = f64::from(config.output_range) / f64::from(config.input_range[0]);
    let servo = Servo {
        c: scale * w,
        omega0: w,
        xi: 0.5,
    };
    let mut plant = servo.plant(dt);
    let bit = (1.0 / (w * dt)).ceil() as usize;
    for k in 0..200_000.min(400 * bit) {
        let sign = if (k / bit) * 7919 % 13 < 6 { 1.0 } else { -1.0 };
        let u = if k < 300 * bit {
            sign * f64::from(config.input_range[0])
        } else {
            0.0
        };
        let _ = identifier.update(u as f32, plant.output() as f32);
        plant.step(&[u]);
    }
    let estimate = identifier.estimate();
    assert!(
        estimate.theta().iter().all(|v| v.is_finite()),
        "{name}: {:?}",
        estimate.theta()
    );
    assert!(
        estimate.std().iter().all(|v| *v >= 0.0),
        "{name}: {:?}",
        estimate.std()
    );
    true
}

/// Sizes from none at all to none that f32 holds.
const SIZES: [f32; 11] = [
    0.0,
    -1.0,
    1e-38,
    1e-10,
    1.1e-9,
    1e-3,
    0.9e9,
    1e10,
    1e30,
    f32::MAX,
    f32::NAN,
];

/// How many of the settings work with the value x.
fn accepted(x: f32) -> usize {
    let runs = [
        edge(&format!("bandwidth {x}"), |c| c.bandwidth = x, 1e-3),
        edge(
            &format!("bandwidth {x} rad per sample"),
            |c| c.bandwidth = 1e3 * x,
            1e-3,
        ),
        edge(&format!("input_range {x}"), |c| c.input_range = [x], 1e-3),
        edge(
            &format!("output_range {x}"),
            |c| {
                c.output_range = x;
                c.output_noise = 1e-3 * x;
            },
            1e-3,
        ),
        edge(&format!("output_noise {x}"), |c| c.output_noise = x, 1e-3),
        edge(&format!("memory {x}"), |c| c.memory = Some(x), 1e-3),
        edge(&format!("settling {x}"), |c| c.settling = x, 1e-3),
        edge(
            &format!("offset_significance {x}"),
            |c| c.offset_significance = x,
            1e-3,
        ),
        edge(&format!("initial {x}"), |c| c.initial = [x; 5], 1e-3),
        edge(
            &format!("prior_std {x}"),
            |c| c.prior_std = Some([x; 5]),
            1e-3,
        ),
        edge(&format!("sample time {x}"), |_| {}, x),
    ];
    runs.iter().filter(|accepted| **accepted).count()
}

#[test]
fn every_setting_at_its_edge_is_refused_or_works() {
    let mut accepted: usize = SIZES.into_iter().map(accepted).sum();
    for angle in [0.9e-4, 1.1e-4, 1e-3, 0.2, 0.49, 0.51] {
        accepted += usize::from(edge(
            &format!("{angle} rad per sample"),
            |c| c.bandwidth = 1e3 * angle,
            1e-3,
        ));
    }
    for samples in [19.0, 20.5, 100.0, 1e6, 1.1e6, 3.15e10] {
        accepted += usize::from(edge(
            &format!("{samples} samples"),
            |c| c.memory = Some(1e-3 * samples),
            1e-3,
        ));
    }
    println!("{accepted} accepted");
    assert!(accepted > 30);
}
