//! Any sequence of calls of the identifier.

use trendid::identifier::Refusal;
use trendid::trends::{ExactTrends, FilteredTrends, Hold, RawTrends, Scheme, TrendOperator};
use trendid::{Config, ConfigError, Identifier, Outcome, Structure};

use crate::bytes::Bytes;

/// Longest delay of the structures here.
const DELAY: usize = 4;

/// Runs what the bytes say on one of the operators and structures.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let kind = bytes.byte();
    let sample_time = if kind & 0x80 == 0 {
        1e-3
    } else {
        1e-3 * bytes.decades(3.0)
    };
    let bandwidth = 20.0 * bytes.decades(1.0);
    let (tustin, goodwin) = (Scheme::Tustin, Scheme::Goodwin);
    let dt = sample_time;
    let servo = Structure::<3, 5, 1>::SERVO;
    match kind & 7 {
        0 => session(bytes, servo, bandwidth, filtered(tustin, dt)),
        1 => session(
            bytes,
            Structure::<3, 3, 1>::INTEGRATING,
            bandwidth,
            exact(dt),
        ),
        2 => session(
            bytes,
            Structure::<2, 4, 1>::FULL,
            bandwidth,
            raw::<2>(goodwin, dt),
        ),
        3 => session(
            bytes,
            Structure::<2, 2, 1>::INTEGRATING,
            bandwidth,
            filtered(goodwin, dt),
        ),
        4 => session(
            bytes,
            Structure::<1, 2, 1>::FULL,
            bandwidth,
            filtered(tustin, dt),
        ),
        5 => session(
            bytes,
            Structure::<4, 8, 1>::FULL,
            bandwidth,
            filtered(tustin, dt),
        ),
        6 => session(bytes, servo, bandwidth, exact(dt)),
        _ => session(
            bytes,
            Structure::<3, 6, 1>::FULL,
            bandwidth,
            raw::<3>(tustin, dt),
        ),
    }
}

type Built<T> = Result<T, ConfigError>;

fn filtered<const M: usize>(scheme: Scheme, dt: f32) -> impl Fn(f32) -> Built<FilteredTrends<M>> {
    move |bandwidth| FilteredTrends::for_bandwidth(scheme, dt, bandwidth)
}

fn exact<const M: usize>(dt: f32) -> impl Fn(f32) -> Built<ExactTrends<M>> {
    move |bandwidth| ExactTrends::for_bandwidth(dt, bandwidth)
}

fn raw<const M: usize>(scheme: Scheme, dt: f32) -> impl Fn(f32) -> Built<RawTrends<M>> {
    move |_| RawTrends::try_new(scheme, dt)
}

/// Settings, then calls to the end of the bytes.
fn session<T: TrendOperator<M> + PartialEq, const M: usize, const N: usize>(
    mut bytes: Bytes<'_>,
    structure: Structure<M, N, 1>,
    bandwidth: f32,
    trends: impl Fn(f32) -> Result<T, ConfigError>,
) {
    let Ok(first) = trends(bandwidth) else { return };
    let (input, output) = match bytes.choice(4) {
        0 => (bytes.decades(10.0), bytes.decades(10.0)),
        _ => (0.4, 50.0),
    };
    let mut config = Config::new(structure, bandwidth, [input], output);
    let options = bytes.byte();
    if options & 1 != 0 {
        config.memory = Some(2.0 * bytes.decades(3.0));
    }
    if options & 2 != 0 {
        config.output_noise = output * bytes.decades(7.0);
    }
    if options & 4 != 0 {
        config.prior_std = Some(std::array::from_fn(|_| bytes.decades(6.0)));
    }
    if options & 8 != 0 {
        config.initial = std::array::from_fn(|_| bytes.signal(1e3));
    }
    if options & 16 != 0 {
        config.settling = 0.05 * bytes.decades(2.0);
    }
    if options & 32 != 0 {
        config.holds = [if options & 64 == 0 {
            Hold::Zero
        } else {
            Hold::First
        }];
        config.delays = [usize::from(bytes.choice(8))];
        config.initial_input = [bytes.signal(input)];
    }
    let Ok(mut identifier) = Identifier::<T, M, N, 1, DELAY>::try_new(&config, first) else {
        return;
    };
    let fresh = identifier.clone();
    while !bytes.is_empty() {
        call(
            &mut identifier,
            &mut bytes,
            [input, output],
            &trends,
            bandwidth,
        );
        look(&identifier);
    }
    let estimate = identifier.estimate();
    assert!(
        estimate.std().iter().all(|std| *std >= 0.0),
        "a standard deviation that is no number: {:?}",
        estimate.std()
    );
    identifier.reset();
    assert!(identifier == fresh, "a reset leaves something behind");
}

/// One call, or some samples of a signal.
fn call<T: TrendOperator<M> + PartialEq, const M: usize, const N: usize>(
    identifier: &mut Identifier<T, M, N, 1, DELAY>,
    bytes: &mut Bytes<'_>,
    [input, output]: [f32; 2],
    trends: &impl Fn(f32) -> Result<T, ConfigError>,
    bandwidth: f32,
) {
    match bytes.byte() {
        0..=127 => {
            let (u, y) = (bytes.signal(input), bytes.signal(output));
            sample(identifier, u, y, [input, output]);
        }
        128..=207 => {
            // A movement: binary command, position that follows it.
            let (step, slope) = (input * bytes.share(), output * bytes.share());
            let mut y = output * bytes.share();
            for k in 0..u32::from(bytes.byte()) {
                let u = if (k / 16) % 2 == 0 { step } else { -step };
                y += 0.01 * slope * if u > 0.0 { 1.0 } else { -1.0 };
                sample(identifier, u, y, [input, output]);
            }
        }
        208..=215 => identifier.skip(u32::from(bytes.byte())),
        216..=220 => identifier.adapt(bytes.byte() & 1 != 0),
        221..=225 => identifier.set_nominal(),
        226..=230 => identifier.restart_trends(),
        231..=233 => identifier.reset(),
        234..=243 => {
            let theta = std::array::from_fn(|_| bytes.signal(1e3));
            let std = std::array::from_fn(|_| bytes.signal(1e2));
            let before = identifier.clone();
            if identifier.warm_start(theta, std).is_err() {
                assert!(*identifier == before, "a refused start changed something");
            }
        }
        _ => {
            let Ok(other) = trends(bandwidth * bytes.decades(0.5)) else {
                return;
            };
            let settling = bytes.signal(0.1);
            let before = identifier.clone();
            if identifier.retune(other, settling).is_err() {
                assert!(*identifier == before, "a refused filter changed something");
            }
        }
    }
}

/// One sample; a refused one by another number, too.
fn sample<T: TrendOperator<M> + PartialEq, const M: usize, const N: usize>(
    identifier: &mut Identifier<T, M, N, 1, DELAY>,
    u: f32,
    y: f32,
    [input, output]: [f32; 2],
) {
    let mut twin = None;
    if !(u.abs() <= input && y.abs() <= output) {
        twin = Some(identifier.clone());
    }
    let outcome = identifier.update(u, y);
    if let Outcome::Refused(refusal) = outcome {
        let mut twin = twin.unwrap_or_else(|| panic!("a usual sample is refused: {u}, {y}"));
        // A refused output leaves the input to be taken; of a refused input neither is.
        let other = match refusal {
            Refusal::Output => [u, f32::NAN],
            _ => [f32::NEG_INFINITY, y],
        };
        let outcome = twin.update(other[0], other[1]);
        assert!(matches!(outcome, Outcome::Refused(_)));
        assert!(
            *identifier == twin,
            "what a refused sample said is remembered"
        );
    } else {
        assert!(u.is_finite() && y.is_finite(), "taken: {u}, {y}");
    }
    if let Some(innovation) = outcome.innovation() {
        assert!(innovation.is_finite(), "innovation {innovation}");
    }
}

/// What must hold at any time.
fn look<T: TrendOperator<M>, const M: usize, const N: usize>(
    identifier: &Identifier<T, M, N, 1, DELAY>,
) {
    let estimator = identifier.estimator();
    let finite = |numbers: &[f32]| numbers.iter().all(|number| number.is_finite());
    assert!(finite(estimator.theta()), "theta {:?}", estimator.theta());
    let diagonal = estimator.diagonal();
    assert!(
        diagonal.iter().all(|d| *d >= 0.0 && d.is_finite()),
        "D {diagonal:?}"
    );
    assert!(identifier.prediction().is_finite(), "prediction");
    if let Some(noise) = identifier.noise_std() {
        assert!(noise >= 0.0, "noise {noise}");
    }
}
