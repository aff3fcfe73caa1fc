//! Records of real drives through the core, sample by sample as on the target.

use std::path::PathBuf;

use trendid::estimation::Terms;
use trendid::inputs::Coulomb;
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Identifier, Structure, structure};

/// Columns of a record: torque, position, velocity.
fn record(name: &str) -> Vec<[f64; 3]> {
    let folder = std::env::var("TRENDID_RECORDS").expect("TRENDID_RECORDS=DIRECTORY");
    let path = PathBuf::from(folder).join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line
                .split(',')
                .map(|x| x.parse().expect("a number"))
                .collect();
            [cells[1], cells[2], cells[4]]
        })
        .collect()
}

/// J, B, Fc of `J v' + B v + Fc sgn v = u + offset`.
fn physical(record: &[[f64; 3]], memory: Option<f32>, friction_input: Option<usize>) -> [f64; 3] {
    let structure: Structure<2, 4, 2> = structure!(Terms::of(&[1]), [Terms::of(&[0]); 2], true);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 10.0).unwrap();
    let mut config = Config::new(structure, 10.0, [0.1, 1.0], 10.0);
    config.memory = memory;
    config.friction_input = friction_input;
    config.holds[1] = Hold::Mean;
    let mut identifier: Identifier<_, 2, 4, 2> = Identifier::try_new(&config, trends).unwrap();
    let fastest = record.iter().fold(0.0_f64, |w, row| w.max(row[2].abs()));
    let mut friction = Coulomb::new(1e-3 * fastest as f32);
    for [u, y, v] in record {
        let sign = friction.update(*v as f32);
        let _ = identifier.update_inputs([*u as f32, sign], *y as f32);
    }
    let [a1, b, c, _] = identifier.theta().map(f64::from);
    [1.0 / b, a1 / b, -c / b]
}

/// Bands of J, B, Fc: 7, 10 and 4 % about the means of ten repeats by an output-error model.
const BANDS_PCT: [f64; 3] = [7.0, 10.0, 4.0];

#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn a_motor_that_comes_to_rest_keeps_its_parameters() {
    let usual = [1.66e-4, 8.57e-5, 0.01555];
    for (name, means) in [
        ("lorenz_S1_1.csv", usual),
        ("lorenz_S1_2.csv", usual),
        ("lorenz_S1_3.csv", usual),
        ("lorenz_S1_4.csv", usual),
        ("lorenz_S1_5.csv", usual),
        ("lorenz_Jm_2.csv", [1.84e-4, 3.26e-4, 0.0306]),
    ] {
        let record = record(name);
        for (memory, friction_input) in [(None, None), (None, Some(1)), (Some(10.0), Some(1))] {
            let found = physical(&record, memory, friction_input);
            let off: [f64; 3] = std::array::from_fn(|i| 100.0 * (found[i] / means[i] - 1.0));
            println!(
                "{name}, memory {memory:?}, gate {friction_input:?}: J, B, Fc off by {off:.1?} %"
            );
            for (off, band) in off.into_iter().zip(BANDS_PCT) {
                assert!(off.abs() <= band, "{name}: {off} % of {band} %");
            }
        }
    }
}
