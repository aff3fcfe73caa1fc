//! The core beside the batch of the f64 oracle: records, rows and the gap between both.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use trendid::estimation::{Parameter, StabilisedForgetting, Terms};
use trendid::trends::{AnyTrends, Design, TrendOperator};
use trendid::{Config, Identifier, Outcome, Structure};
use trendid_host_tests::oracles::forgetting::{Forgetting, Kind};
use trendid_host_tests::oracles::least_squares::{self, InputTerms, recursive_equivalent};
use trendid_host_tests::oracles::trends::{Hold, Scheme, filter_denominator, output_trend};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::noise::{Stream, generator};

use crate::common::{design_units, rounded, rows};

pub(crate) const DT: f32 = 0.001;

/// Largest relative gap between the recursion in f32 and the batch in f64, in theta.
pub(crate) const LIMIT: f64 = 3e-5;

/// A plant with commands of binary noise and steps, noise on the position; all numbers fit into
/// f32.
pub(crate) fn record(
    a: &[f64],
    inputs: &[Input],
    constant: f64,
    seed: u64,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    noisy_record(a, inputs, constant, 1e-3, seed)
}

/// As [`record`] with white noise of full width `eta`.
pub(crate) fn noisy_record(
    a: &[f64],
    inputs: &[Input],
    constant: f64,
    eta: f64,
    seed: u64,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let n = 1500;
    let dt = f64::from(DT);
    let mut plant = LinearPlant::with_inputs(a, inputs, constant, dt).unwrap();
    if a[0] != 0.0 {
        plant.reset(constant / a[0]);
    }
    let commands: Vec<Vec<f64>> = (0..inputs.len() as u64)
        .map(|j| {
            let steps = Excitation::Steps {
                amplitude: 1.0,
                hold_s: 0.03 + 0.02 * j as f64,
            };
            rounded(&steps.sequence(n, dt, seed + j))
        })
        .collect();
    let mut random = generator(seed, Stream::White);
    let y: Vec<f64> = (0..n)
        .map(|k| {
            let y = plant.output() + eta * (random.random::<f64>() - 0.5);
            let u: Vec<f64> = commands.iter().map(|c| c[k]).collect();
            plant.step(&u);
            y
        })
        .collect();
    (commands, rounded(&y))
}

/// Newest coefficient of the trend of order m: how the noise of one sample enters the target.
fn newest(scheme: Scheme, m: usize, f: Option<&[f64]>) -> f64 {
    let dt = f64::from(DT);
    let raw = output_trend(scheme, m, m, dt)[0];
    raw / f.map_or(1.0, |f| filter_denominator(scheme, f, dt)[0])
}

/// The terms of the core's structure as the oracle names them.
fn terms<const M: usize, const N: usize, const I: usize>(
    config: &Config<M, N, I>,
) -> least_squares::Structure {
    let model = &config.structure;
    let powers = |terms: Terms| (0..M).filter(|i| terms.contains(*i)).collect();
    least_squares::Structure {
        m: M,
        a: powers(model.output()),
        inputs: (0..I)
            .map(|j| InputTerms {
                b: powers(model.inputs()[j]),
                delay: config.delays[j],
                hold: match config.holds[j] {
                    trendid::trends::Hold::Zero => Hold::Zero,
                    trendid::trends::Hold::First => Hold::First,
                    trendid::trends::Hold::Mean => unimplemented!("no case has it"),
                },
            })
            .collect(),
        constant: model.constant(),
    }
}

/// Theta of the dense stabilised forgetting in f64, in turn as the core's; `scale` makes noise of
/// variance 1.
fn forgotten<const N: usize>(
    memory: f32,
    prior: [f64; N],
    units: [f64; N],
    scale: f64,
    (phi, target): (&DMatrix<f64>, &DVector<f64>),
) -> Vec<f64> {
    let lambda = 1.0 - DT / memory;
    let bound = StabilisedForgetting::new([0.0; N], lambda).bound();
    let kind = Kind::InTurn {
        variance: 16_384.0,
        follows: 0.1 * f64::from(bound),
    };
    let mut dense = Forgetting::<N>::new(kind, prior, 1.0 / f64::from(1.0 - lambda));
    for (k, psi) in target.iter().enumerate() {
        let phi = std::array::from_fn(|j| scale * units[j] * phi[(k, j)]);
        dense.update(&phi, scale * psi);
    }
    let theta = dense.theta();
    (0..N).map(|j| units[j] * theta[j]).collect()
}

/// Parameters of the trends in the s plane, as the core has them.
pub(crate) fn in_s_plane<const M: usize, const N: usize, const I: usize>(
    theta: &[f64],
    structure: &Structure<M, N, I>,
    design: &Design<M>,
) -> Vec<f64> {
    let (mut a, mut zeros) = ([0.0; M], false);
    for (parameter, value) in structure.parameters().into_iter().zip(theta) {
        match parameter {
            Parameter::Output { power } => a[power] = *value as f32,
            Parameter::Input { power, .. } => zeros |= power > 0,
            Parameter::Constant | Parameter::InitialState => {}
        }
    }
    let Some(image) = design.to_s_plane(&a, structure.integrators(), zeros) else {
        return theta.to_vec();
    };
    let mapped = structure.parameters().into_iter().zip(theta);
    let mapped = mapped.map(|(parameter, value)| match parameter {
        Parameter::Output { power } => f64::from(image.a[power]),
        Parameter::InitialState => *value,
        Parameter::Input { .. } | Parameter::Constant => value * f64::from(image.numerator),
    });
    mapped.collect()
}

/// Largest distance between core and batch, relative to the parameter (or to a thousandth of its
/// design size).
fn gap<const M: usize, const N: usize, const I: usize>(
    config: &Config<M, N, I>,
    trends: AnyTrends<M>,
    scheme: Scheme,
    u: &[Vec<f64>],
    y: &[f64],
) -> f64 {
    let design = trends.design().clone();
    let f: Option<Vec<f64>> = design
        .filter
        .map(|f| f.iter().map(|c| f64::from(*c)).chain([1.0]).collect());
    let structure = terms(config);
    let first = structure.first_full();
    let mut config = config.clone();
    // The same rows as the batch.
    config.settling = (first as f32 + 0.5) * DT;
    let mut identifier: Identifier<_, M, N, I, 8> = Identifier::try_new(&config, trends).unwrap();
    let prior = identifier.estimator();
    let prior: [f64; N] = core::array::from_fn(|j| f64::from(prior.covariance(j, j)));
    let mut warm = 0;
    for k in 0..y.len() {
        let u = core::array::from_fn(|j| u[j][k] as f32);
        let found = identifier.update_inputs(u, y[k] as f32);
        warm += usize::from(matches!(found, Outcome::WarmingUp { .. }));
    }
    // Those in which the core looked for the beginning are left out, too.
    let first = first.max(warm);
    let core = identifier.recursion().theta().map(f64::from);

    let start = config.structure.initial_state().then(|| {
        let slowest = f64::from(design.slow_mode);
        assert!(slowest > 0.0 && slowest < 1.0);
        slowest
    });
    let views: Vec<&[f64]> = u.iter().map(Vec::as_slice).collect();
    let (f, dt) = (f.as_deref(), f64::from(DT));
    let (phi, target) = rows(&structure, scheme, f, dt, &views, y, start, first);
    let units = design_units(&config);
    let noise = newest(scheme, M, f) * f64::from(config.output_noise);
    let batch: Vec<f64> = match config.memory {
        None => {
            let sd = units.map(|unit| 10.0 * unit);
            let found = recursive_equivalent(&phi, &target, 1.0, &[0.0; N], &sd, noise).unwrap();
            found.theta.as_slice().to_vec()
        }
        Some(memory) => {
            // The prior is ten design sizes, and its variance counts noise in the normalised
            // equation.
            let scale = 10.0 / prior[0].sqrt() / noise;
            forgotten(memory, prior, units, scale, (&phi, &target))
        }
    };
    let batch = in_s_plane(&batch, &config.structure, &design);
    (0..N).fold(0.0, |worst: f64, j| {
        // The start is some 1e-4 mm beside strokes of 100 mm: judged by its design size, like any
        // small parameter.
        let size = batch[j].abs().max(1e-3 * units[j]);
        worst.max((core[j] - batch[j]).abs() / size)
    })
}

/// The core without and with a memory of 0.4 s: the worst gaps.
pub(crate) fn both<const M: usize, const N: usize, const I: usize>(
    name: &str,
    config: Config<M, N, I>,
    trends: AnyTrends<M>,
    scheme: Scheme,
    (u, y): &(Vec<Vec<f64>>, Vec<f64>),
    limit: f64,
) {
    let all = gap(&config, trends.clone(), scheme, u, y);
    let mut forgetting = config;
    forgetting.memory = Some(0.4);
    let recent = gap(&forgetting, trends, scheme, u, y);
    println!("{name}: no forgetting {all:.1e}, memory 0.4 s {recent:.1e}, limit {limit:.0e}");
    assert!(all < limit && recent < limit, "{name}: {all} {recent}");
}
