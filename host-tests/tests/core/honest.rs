//! Whatever is called meanwhile, an estimate is as good as it says, and good behind ten seconds of
//! motion.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::linear::LinearPlant;
use trendid_host_tests::random::Random;

type Servo = Identifier<FilteredTrends<3>, 3, 5, 1, 0>;

const DT: f64 = 1e-3;

/// What happens to an identifier on a drive that obeys its model.
#[derive(Debug, Clone, Copy)]
enum Event {
    Motion(u32),
    Rest(u32),
    /// Samples without a call, then one that is `off` by so much.
    Gap {
        samples: u32,
        off: f64,
    },
    /// Readings that are none, then one that is off.
    Refused {
        samples: u32,
        off: f64,
    },
    Adapt(bool),
    RestartTrends,
    SetNominal,
    Retune(f32),
    WarmStart(f64),
    Reset,
}

fn event() -> impl Strategy<Value = Event> {
    // From one unit on: what is less passes for the motion behind a gap.
    let off = || {
        let spike = (0.0_f64..6.0, any::<bool>());
        prop_oneof![
            Just(0.0),
            spike.prop_map(|(decades, up)| 10_f64.powf(decades) * if up { 1.0 } else { -1.0 }),
        ]
    };
    prop_oneof![
        3 => (50_u32..2500).prop_map(Event::Motion),
        1 => (50_u32..4000).prop_map(Event::Rest),
        2 => (0_u32..60, off()).prop_map(|(samples, off)| Event::Gap { samples, off }),
        1 => (1_u32..60, off()).prop_map(|(samples, off)| Event::Refused { samples, off }),
        1 => (1000_u32..6000).prop_map(|samples| Event::Gap { samples, off: 0.0 }),
        1 => any::<bool>().prop_map(Event::Adapt),
        1 => Just(Event::RestartTrends),
        1 => Just(Event::SetNominal),
        1 => (10_f32..40.0).prop_map(Event::Retune),
        1 => (0.9_f64..1.1).prop_map(Event::WarmStart),
        1 => Just(Event::Reset),
    ]
}

fn trends(bandwidth: f32) -> FilteredTrends<3> {
    FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, bandwidth).expect("a filter")
}

/// The drive, its command and the noise of its sensor.
struct Bench {
    plant: LinearPlant,
    truth: [f64; 3],
    command: f64,
    noise: f64,
    random: Random,
    /// Samples of motion until a spike is one: before, it is where a motion begins.
    settles: u32,
}

impl Bench {
    fn new(frequency: f64, damping: f64, noise: f64, seed: u32) -> Self {
        let square = frequency * frequency;
        let truth = [square, 2.0 * damping * frequency, 2500.0 * square];
        let [a1, a2, b0] = truth;
        Self {
            plant: LinearPlant::new(&[0.0, a1, a2], &[b0], DT).expect("a drive"),
            truth,
            command: 0.0,
            noise,
            random: Random::seed_from_u64(u64::from(seed)),
            settles: 0,
        }
    }

    /// Even within 0..1.
    fn roll(&mut self) -> f64 {
        self.random.random()
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.roll()).sum::<f64>() - 6.0
    }

    fn reading(&mut self) -> f32 {
        let noise = self.noise * self.normal();
        (self.plant.output() + noise) as f32
    }

    fn step(&mut self) {
        let _ = self.plant.step(&[self.command]);
    }

    /// Commands that change now and then and keep the axis within 150 units.
    fn motion(&mut self, servo: &mut Servo, samples: u32) {
        for _ in 0..samples {
            if self.roll() < 0.012 {
                let y = self.plant.output();
                self.command = match y.abs() > 150.0 {
                    true => -0.3 * y.signum(),
                    false => 0.4 * (2.0 * self.roll() - 1.0),
                };
            }
            let y = self.reading();
            let _ = servo.update(self.command as f32, y);
            self.step();
            self.settles = self.settles.saturating_sub(1);
        }
    }

    /// One reading that is wrong, where a motion has been seen; two in a row are a position that
    /// has changed.
    fn wrong(&mut self, servo: &mut Servo, off: f64) {
        if self.settles == 0 && off != 0.0 {
            self.settles = 100;
            let y = self.reading() + off as f32;
            let _ = servo.update(self.command as f32, y);
            self.step();
        }
    }

    fn event(&mut self, servo: &mut Servo, event: Event) {
        // Ten times 1/omega behind a begin, and a model; behind another filter what it settles in.
        let (begin, settling) = (2000, 12_000);
        match event {
            Event::Motion(samples) => self.motion(servo, samples),
            Event::Rest(samples) => {
                self.command = 0.0;
                for _ in 0..samples {
                    let y = self.reading();
                    let _ = servo.update(0.0, y);
                    self.step();
                }
            }
            Event::Gap { samples, off } => {
                if samples > 250 {
                    // So that the axis stays near.
                    self.command *= 0.05;
                }
                servo.skip(samples);
                for _ in 0..samples {
                    self.step();
                }
                if samples > 250 {
                    self.settles = begin;
                }
                self.wrong(servo, off);
            }
            Event::Refused { samples, off } => {
                for _ in 0..samples {
                    let _ = servo.update(self.command as f32, f32::NAN);
                    self.step();
                }
                self.wrong(servo, off);
            }
            Event::Adapt(on) => servo.adapt(on),
            Event::RestartTrends => {
                servo.restart_trends();
                self.settles = begin;
            }
            Event::SetNominal => servo.set_nominal(),
            Event::Retune(bandwidth) => {
                servo.retune(trends(bandwidth), 0.2).expect("a filter");
                self.settles = settling;
            }
            Event::WarmStart(factor) => {
                let [a1, a2, b0] = self.truth;
                let theta = [a1 * factor, a2 / factor, b0 * factor, 0.0, 0.0];
                let std = [0.1 * a1, 0.1 * a2, 0.1 * b0, 1e4, 1e3];
                let both = [theta, std].map(|of| of.map(|value| value as f32));
                servo.warm_start(both[0], both[1]).expect("a start");
                self.settles = begin;
            }
            Event::Reset => {
                // The settings are those of a drive that begins at rest.
                self.command = 0.0;
                for _ in 0..2000 {
                    self.step();
                }
                servo.reset();
                self.settles = begin;
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    #[test]
    fn behind_any_calls_an_estimate_is_within_what_it_says(
        events in prop::collection::vec(event(), 4..12),
        memory in prop::sample::select(vec![None, Some(0.2), Some(2.0), Some(10.0)]),
        changes in any::<bool>(),
        noise in prop::sample::select(vec![0.0, 0.01, 0.05]),
        frequency in 12.0_f64..32.0,
        damping in 0.3_f64..0.8,
        seed in any::<u32>(),
    ) {
        let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
        config.memory = memory;
        config.follow_changes = changes && memory.is_some();
        config.output_noise = 0.02;
        let mut servo = Servo::try_new(&config, trends(20.0)).expect("settings");
        let mut bench = Bench::new(frequency, damping, noise, seed);
        bench.motion(&mut servo, 2000);
        for event in events {
            bench.event(&mut servo, event);
        }
        servo.adapt(true);
        bench.motion(&mut servo, 10_000);
        let estimate = servo.estimate();
        for (j, truth) in bench.truth.into_iter().enumerate() {
            let error = (f64::from(estimate.theta()[j]) - truth).abs();
            let std = f64::from(estimate.std()[j]);
            // 200 samples are few that tell something new: their deviation is a guess itself.
            let times = if memory == Some(0.2) { 10.0 } else { 5.0 };
            // Without noise a begin in motion is left, which no residual shows.
            let left = if noise == 0.0 { 0.01 } else { 0.003 };
            let within = error <= times * std + left * truth;
            prop_assert!(within, "{}: off by {} of {}, +-{}", j, error, truth, std);
            // What was wrong is forgotten with the memory, and a short one sees little motion.
            let most = match memory {
                Some(2.0) => 0.05,
                Some(0.2) => 0.5,
                _ => f64::INFINITY,
            };
            prop_assert!(error <= most * truth, "{}: off by {} of {}, +-{}", j, error, truth, std);
        }
    }
}
