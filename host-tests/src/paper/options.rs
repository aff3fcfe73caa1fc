//! One run of each option of the core: the same record without it and with it.

use trendid::identifier::DelayBank;
use trendid::inputs::{DeadZone, Valved};
use trendid::trends::{ExactTrends, FilteredTrends, RawTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};

use crate::oracles::forgetting::{Forgetting, Kind, ServoRows};
use crate::paper::trial::{Filter, Method, Setting, trial};
use crate::plants::linear::{Input, LinearPlant};
use crate::plants::servo::{REFERENCE, Servo};
use crate::signals::excitation::Excitation;
use crate::signals::experiment::{Experiment, Record};
use crate::signals::noise::{Additive, Condition, Reading};

/// Errors of one run without and with the option.
pub type Pair = [[f64; 3]; 2];

/// Rough bandwidth of the reference servo \[rad/s\].
const BANDWIDTH: f32 = 20.0;
/// Sample time unless stated otherwise \[s\].
const DT: f64 = 0.001;

/// The default filter for the servo, or for another bandwidth given.
fn trends(bandwidth: f32) -> FilteredTrends<3> {
    FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, bandwidth)
        .expect("a bandwidth of rad/s")
}

/// An identifier of the servo under commands of 0.4 and strokes of 50 mm.
fn identifier<T: TrendOperator<3>, const N: usize>(
    trends: T,
    structure: Structure<3, N, 1>,
) -> Identifier<T, 3, N> {
    let config = Config::new(structure, BANDWIDTH, [0.4], 50.0);
    Identifier::try_new(&config, trends).expect("a structure of the servo")
}

/// Errors at the end of a record.
fn ending<T: TrendOperator<3>, const N: usize>(
    record: &Record,
    mut identifier: Identifier<T, 3, N>,
) -> [f64; 3] {
    for s in record.samples() {
        let _ = identifier.update(s.u as f32, s.y as f32);
    }
    Servo::errors_of(&identifier.theta(), &REFERENCE)
}

/// Filtered trends for raw ones.
pub fn filtered(seed: u64) -> Pair {
    let record = Experiment::reference(Condition::white(100.0), 0.5).record(seed);
    let structure = Structure::<3, 3, 1>::INTEGRATING;
    let raw = RawTrends::try_new(Scheme::Tustin, DT as f32).expect("1 ms");
    let filtered = FilteredTrends::try_new(Scheme::Tustin, DT as f32, [25.0; 3]).expect("25 rad/s");
    [
        ending(&record, identifier(raw, structure)),
        ending(&record, identifier(filtered, structure)),
    ]
}

/// The noise bias taken out.
pub fn compensated(seed: u64) -> Pair {
    let methods = [false, true].map(|compensated| Method::Core {
        scheme: Scheme::Tustin,
        filter: Filter::Default,
        compensated,
    });
    let setting = Setting {
        condition: Condition::white_relative(16.72),
        ..Setting::all(Reading::Relative)[0]
    };
    let runs = trial(&setting, 3.0, seed, &methods).runs;
    [runs[0].error_pct, runs[1].error_pct]
}

/// The servo with the start and without a constant.
const STARTED: Structure<3, 4, 1> = Structure::INTEGRATING_WITH_INITIAL_STATE;

/// The initial state as a parameter, of a record that begins in motion.
pub fn start(seed: u64) -> Pair {
    let mut record = Experiment::reference(Condition::white(100.0), 1.0).record(seed);
    for signal in [&mut record.u, &mut record.y, &mut record.y_true] {
        signal.drain(..300);
    }
    let without = Structure::<3, 3, 1>::INTEGRATING;
    [
        ending(&record, identifier(trends(BANDWIDTH), without)),
        ending(&record, identifier(trends(BANDWIDTH), STARTED)),
    ]
}

/// The offset of the valve as a parameter.
pub fn constant(seed: u64) -> Pair {
    let mut experiment = Experiment::reference(Condition::white(10.0), 1.0);
    experiment.valve.offset = 0.04;
    let record = experiment.record(seed);
    let with = Structure::<3, 5, 1>::SERVO;
    [
        ending(&record, identifier(trends(BANDWIDTH), STARTED)),
        ending(&record, identifier(trends(BANDWIDTH), with)),
    ]
}

/// A dead zone that is found on the way.
pub fn dead_zone(seed: u64) -> Pair {
    let mut experiment = Experiment::closed_loop(Condition::white(20.0), 4.0);
    experiment.valve.dead_zone = 0.03;
    let record = experiment.record(seed);
    let mut without = identifier(
        trends(BANDWIDTH),
        Structure::<3, 4, 1>::INTEGRATING_WITH_CONSTANT,
    );
    let structure = Structure::<3, 5, 2>::INTEGRATING_WITH_CONSTANT;
    let mut config = Config::new(structure, BANDWIDTH, [0.2, 0.05], 50.0);
    config.memory = Some(0.7);
    // Its width is found on the way, from two thirds of the truth.
    let valve = DeadZone::new(0.02, 0.1, 300);
    let mut with: Valved<_, 3, 5> =
        Valved::try_new(&config, trends(BANDWIDTH), valve).expect("a servo with two inputs");
    for s in record.samples() {
        let _ = without.update(s.u as f32, s.y as f32);
        let _ = with.update(s.u as f32, s.y as f32);
    }
    [
        Servo::errors_of(&without.theta(), &REFERENCE),
        Servo::errors_of(&with.identifier().theta(), &REFERENCE),
    ]
}

/// What 20 s of rest do to the reading under plain exponential forgetting, and under that of the
/// core.
pub fn bounded(seed: u64) -> Pair {
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, BANDWIDTH, [0.4], 50.0);
    config.memory = Some(0.2);
    let mut with: Identifier<_, 3, 5> =
        Identifier::try_new(&config, trends(BANDWIDTH)).expect("a servo");
    let mut rows = ServoRows::new(f64::from(BANDWIDTH), 0.4, 50.0, DT);
    let mut without = Forgetting::<5>::new(Kind::Plain, [1e8; 5], 0.2 / DT);
    let mut noise = Additive::new(&Condition::white(30.0), seed);
    let mut plant = REFERENCE.plant(DT);
    let mut sample = |u: f64| {
        let y = plant.output() + noise.next().unwrap_or(0.0);
        let _ = with.update(u as f32, y as f32);
        let (phi, psi) = rows.update(u, y);
        without.update(&phi, psi);
        plant.step(&[u]);
        let plain: [f64; 5] = std::array::from_fn(|j| rows.units[j] * without.theta()[j]);
        let [a1, a2, b0, ..] = with.theta().map(f64::from);
        [
            Servo::from_coefficients(plain[0], plain[1], plain[2]),
            Servo::from_coefficients(a1, a2, b0),
        ]
    };
    let mut before = [None; 2];
    for u in Excitation::ABSOLUTE.sequence(2000, DT, seed) {
        before = sample(u);
    }
    let mut after = [None; 2];
    for _ in 0..20_000 {
        after = sample(0.0);
    }
    std::array::from_fn(|way| match (before[way], after[way]) {
        (Some(before), Some(after)) => after.error_pct(&before),
        _ => [f64::INFINITY; 3],
    })
}

/// The filter retuned to what was found, from three times the bandwidth.
pub fn retuned(seed: u64) -> Pair {
    let record = Experiment::reference(Condition::white_relative(16.72), 3.0).record(seed);
    let rough = 3.0 * BANDWIDTH;
    let config = Config::new(Structure::<3, 5, 1>::SERVO, rough, [1.0], 50.0);
    let mut fixed: Identifier<_, 3, 5> =
        Identifier::try_new(&config, trends(rough)).expect("a servo");
    let mut tuned = fixed.clone();
    for (k, s) in record.samples().enumerate() {
        let _ = fixed.update(s.u as f32, s.y as f32);
        let _ = tuned.update(s.u as f32, s.y as f32);
        if k != 700 && k != 1400 {
            continue;
        }
        let estimate = tuned.estimate();
        if let (Some(omega0), Some(sigma)) = (estimate.physical().omega0, estimate.physical_std())
            && sigma[1] < 0.3 * omega0
        {
            let omega0 = omega0.clamp(2.0, 200.0);
            let _ = tuned.retune_to(omega0);
        }
    }
    [fixed, tuned].map(|identifier| Servo::errors_of(&identifier.theta(), &REFERENCE))
}

/// A delay that is found.
pub fn banked(seed: u64) -> Pair {
    const DELAY: usize = 3;
    let mut experiment = Experiment::reference(Condition::white(100.0), 0.5);
    let inputs = [Input::delayed(&[REFERENCE.b0()], DELAY)];
    experiment.plant = LinearPlant::with_inputs(&REFERENCE.a(), &inputs, 0.0, DT).expect("a servo");
    let record = experiment.record(seed);
    let config = Config::new(Structure::<3, 5, 1>::SERVO, BANDWIDTH, [0.4], 50.0);
    let mut bank: DelayBank<trendid::Servo<7>, 8> =
        DelayBank::try_new(&config, trends(BANDWIDTH), 0).expect("a bank");
    for s in record.samples() {
        let _ = bank.update_inputs([s.u as f32], s.y as f32);
    }
    let read = |identifier: Option<&trendid::Servo<7>>| {
        identifier.map_or([f64::INFINITY; 3], |i| {
            Servo::errors_of(&i.theta(), &REFERENCE)
        })
    };
    [read(bank.candidate(0)), read(bank.chosen())]
}

/// Exact trends for a slow sampling.
pub fn exact(seed: u64) -> Pair {
    const SLOW: f64 = 0.005;
    let truth = Servo {
        c: 2500.0,
        omega0: 60.0,
        xi: 0.3,
    };
    let bandwidth = 60.0;
    let structure = Structure::<3, 5, 1>::SERVO;
    let mut config = Config::new(structure, bandwidth, [0.4], 50.0);
    config.memory = Some(1.0);
    let plain = FilteredTrends::for_bandwidth(Scheme::Tustin, SLOW as f32, bandwidth);
    let mut without: Identifier<_, 3, 5> =
        Identifier::try_new(&config, plain.expect("5 ms")).expect("a servo");
    let trends = ExactTrends::for_bandwidth(SLOW as f32, bandwidth).expect("5 ms");
    let mut with: Identifier<_, 3, 5> =
        Identifier::try_new(&config, trends.clone()).expect("a servo");
    let mut noise = Additive::new(&Condition::white(10.0), seed);
    let mut plant = truth.plant(SLOW);
    let commands = Excitation::ABSOLUTE.sequence(800, SLOW, seed);
    for (k, u) in commands.into_iter().enumerate() {
        let y = (plant.output() + noise.next().unwrap_or(0.0)) as f32;
        let _ = without.update(u as f32, y);
        let _ = with.update(u as f32, y);
        plant.step(&[u]);
        // The numerators become those of the model found.
        if (k == 200 || k == 400)
            && let Ok(own) = trends.with_model(with.estimate().transfer_function().a)
        {
            let _ = with.retune(own, 0.0);
        }
    }
    [
        Servo::errors_of(&without.theta(), &truth),
        Servo::errors_of(&with.theta(), &truth),
    ]
}
