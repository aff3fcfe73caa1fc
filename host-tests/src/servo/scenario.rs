//! Scenarios of the adaptive position loop: the core's `ServoLoop` on a simulated axis, with its figures per seed.

use trendid::hardware::{Axis as Counts, PositionSensor, Scale, Valve};
use trendid::{LoopConfig, Reason, Report, ServoLoop, ServoModel, State, Travel};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::plants::linear::{Input, LinearPlant};
use crate::plants::pneumatic::{Axis, AxisParameters, Fault};
use crate::plants::servo::{REFERENCE, Servo};
use crate::plants::valve::Valve as Null;
use crate::servo::shadow::{Companion, Request};
use crate::signals::noise::{Additive, Condition};

/// Sensor of the loop: the code that the simulation put there.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedSensor {
    /// The code of the next reading; `None` is a reading that fails.
    pub code: Option<i32>,
}

impl PositionSensor for SimulatedSensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        self.code.ok_or(())
    }
}

/// Valve of the loop: sets what it is told.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedValve;

impl Valve for SimulatedValve {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        Ok(command)
    }
}

/// The drive under the loop.
pub enum Plant {
    /// The pneumatic axis.
    Pneumatic(Box<Axis>),
    /// The reference servo behind a valve with dead zone, with the same sensor as the axis.
    Linear {
        /// The servo.
        plant: Box<LinearPlant>,
        /// Its valve.
        valve: Null,
        /// Noise of the sensor.
        noise: Box<Additive>,
    },
}

impl Plant {
    /// The pneumatic axis of the figures.
    pub fn pneumatic(parameters: &AxisParameters, seed: u64) -> Self {
        Self::Pneumatic(Box::new(Axis::new(parameters, seed)))
    }

    /// The linear reference servo at 200 mm with a dead zone of 3 % and noise of +-10 um.
    pub fn linear(seed: u64) -> Self {
        let mut plant = REFERENCE.plant(1e-3);
        plant.reset(200.0);
        Self::Linear {
            plant: Box::new(plant),
            valve: Null {
                dead_zone: 0.03,
                ..Null::IDEAL
            },
            noise: Box::new(Additive::new(&Condition::white(20.0), seed)),
        }
    }

    fn code(&mut self) -> i32 {
        match self {
            Self::Pneumatic(axis) => axis.measure_counts(),
            Self::Linear { plant, noise, .. } => {
                let noise = noise.next().unwrap_or(0.0);
                ((plant.output() + noise) / RESOLUTION_MM).round() as i32
            }
        }
    }

    fn step(&mut self, u: f64) {
        match self {
            Self::Pneumatic(axis) => axis.step(u),
            Self::Linear { plant, valve, .. } => {
                plant.step(&[valve.flow(u)]);
            }
        }
    }

    /// Brings the change or the fault of a scenario.
    fn change(&mut self, scenario: Scenario) {
        match self {
            Self::Pneumatic(axis) => match scenario {
                Scenario::Mass => axis.set_mass(3.0 * axis.parameters().mass),
                Scenario::Supply => axis.set_supply(4.0),
                Scenario::ValveGain => axis.set_valve_gain(0.7),
                Scenario::Friction => axis.set_friction_scale(2.0),
                Scenario::WrongSign => axis.set_fault(Some(Fault::WrongSign)),
                Scenario::StuckSensor => axis.set_fault(Some(Fault::StuckSensor)),
                Scenario::StuckValve => axis.set_fault(Some(Fault::StuckValve)),
                Scenario::BlockedAxis => axis.set_fault(Some(Fault::BlockedAxis)),
                Scenario::WrongOrder => {
                    let seed = axis.time().to_bits();
                    *self = Self::other_order(self.position_mm(), seed);
                }
                Scenario::Nominal | Scenario::Rest => {}
            },
            Self::Linear { plant, valve, .. } => {
                let x = plant.output();
                let servo = match scenario {
                    // Natural frequency and gain of a third of the mass's inverse; half the damping.
                    Scenario::Mass => Servo {
                        omega0: REFERENCE.omega0 / 3.0_f64.sqrt(),
                        ..REFERENCE
                    },
                    Scenario::Supply => Servo {
                        c: 0.7 * REFERENCE.c,
                        omega0: 0.85 * REFERENCE.omega0,
                        ..REFERENCE
                    },
                    Scenario::Friction => Servo {
                        xi: 2.0 * REFERENCE.xi,
                        ..REFERENCE
                    },
                    _ => REFERENCE,
                };
                match scenario {
                    Scenario::ValveGain => {
                        valve.gain_positive = 0.7;
                        valve.gain_negative = 0.7;
                    }
                    Scenario::WrongSign => {
                        valve.gain_positive = -1.0;
                        valve.gain_negative = -1.0;
                    }
                    Scenario::StuckValve => {
                        valve.gain_positive = 0.0;
                        valve.gain_negative = 0.0;
                        valve.limit = 0.0;
                    }
                    Scenario::WrongOrder => *self = Self::other_order(x, 1),
                    Scenario::Mass | Scenario::Supply | Scenario::Friction => {
                        let state = [x, plant.derivative(1), plant.derivative(2)];
                        **plant = servo.plant(1e-3);
                        plant.place(&state);
                    }
                    _ => {}
                }
            }
        }
    }

    /// An axis held by a spring behind a slow valve: order 4, and no integrator.
    fn other_order(position_mm: f64, seed: u64) -> Self {
        // (s + 60)(s + 30)(s^2 + 20 s + 400), 60 mm per unit of command.
        let a = [720_000.0, 72_000.0, 4_000.0, 110.0];
        let constant = a[0] * position_mm;
        let plant = LinearPlant::with_inputs(&a, &[Input::new(&[60.0 * a[0]])], constant, 1e-3);
        let Ok(mut plant) = plant else {
            panic!("a plant of order 4");
        };
        plant.reset(position_mm);
        Self::Linear {
            plant: Box::new(plant),
            valve: Null {
                dead_zone: 0.03,
                ..Null::IDEAL
            },
            noise: Box::new(Additive::new(&Condition::white(20.0), seed)),
        }
    }

    /// Flow opening of the valve.
    fn opening(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.opening(),
            Self::Linear { .. } => 0.0,
        }
    }

    /// True position \[mm\].
    pub fn position_mm(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.position_mm(),
            Self::Linear { plant, .. } => plant.output(),
        }
    }
}

/// Resolution of the sensor of both plants \[mm\].
pub const RESOLUTION_MM: f64 = 0.01;

/// One instant of a scenario.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// Time \[s\].
    pub t: f64,
    /// True position \[mm\].
    pub position_mm: f64,
    /// What the loop reported.
    pub report: Report,
}

/// The loop on its plant.
pub struct Rig {
    /// The drive.
    pub plant: Plant,
    /// The loop.
    pub servo: ServoLoop<SimulatedSensor, SimulatedValve>,
    samples: u64,
}

/// Travel of both plants \[mm\].
pub const TRAVEL: Travel = Travel {
    begin: 0.0,
    end: 400.0,
};

/// Bandwidth that the user believes the axis to have \[rad/s\]; the pneumatic axis has about 31, the linear one 20.
pub const ROUGH_BANDWIDTH: f32 = 25.0;

impl Rig {
    /// A rig with these settings of the loop.
    ///
    /// # Panics
    /// When the settings cannot work; the message names the setting.
    pub fn new(plant: Plant, config: &LoopConfig) -> Self {
        let Some(scale) = Scale::new(RESOLUTION_MM as f32) else {
            panic!("resolution");
        };
        let counts = Counts {
            scale,
            reference: 0,
        };
        match ServoLoop::try_new(config, counts, SimulatedSensor::default(), SimulatedValve) {
            Ok(servo) => Self {
                plant,
                servo,
                samples: 0,
            },
            Err(error) => panic!("{error}"),
        }
    }

    /// One sample of the loop; [`Rig::drive`] must follow.
    fn sample(&mut self, reading: Option<i32>) -> Instant {
        self.servo.sensor_mut().code = reading;
        Instant {
            t: 1e-3 * self.samples as f64,
            position_mm: self.plant.position_mm(),
            report: self.servo.update(),
        }
    }

    /// Moves the plant on to the next sample.
    fn drive(&mut self, command: f32) {
        self.plant.step(f64::from(command));
        self.samples += 1;
    }

    fn ask(&mut self, request: Request) {
        request.put_to(&mut self.servo);
    }
}

/// What happens to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scenario {
    /// Commissioning, 60 mm steps, sines of 0.5 and 1 Hz.
    Nominal,
    /// The moving mass is tripled in motion.
    Mass,
    /// The supply falls from 6 to 4 bar in motion.
    Supply,
    /// The valve loses 30 % of its gain in motion.
    ValveGain,
    /// Friction doubles in motion.
    Friction,
    /// 60 s at rest, then motion.
    Rest,
    /// The valve is connected the wrong way round.
    WrongSign,
    /// The plant is not what the model assumes: a spring holds it and the valve is slow.
    WrongOrder,
    /// The sensor repeats its last code.
    StuckSensor,
    /// The spool stays where it is.
    StuckValve,
    /// The slide is clamped.
    BlockedAxis,
}

impl Scenario {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Nominal,
        Self::Mass,
        Self::Supply,
        Self::ValveGain,
        Self::Friction,
        Self::Rest,
        Self::WrongSign,
        Self::WrongOrder,
        Self::StuckSensor,
        Self::StuckValve,
        Self::BlockedAxis,
    ];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Mass => "mass",
            Self::Supply => "supply",
            Self::ValveGain => "valve-gain",
            Self::Friction => "friction",
            Self::Rest => "rest",
            Self::WrongSign => "wrong-sign",
            Self::WrongOrder => "wrong-order",
            Self::StuckSensor => "stuck-sensor",
            Self::StuckValve => "stuck-valve",
            Self::BlockedAxis => "blocked-axis",
        }
    }

    /// The scenario of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// One sentence for a person.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Nominal => "commissioning, 60 mm steps, sines of 0.5 and 1 Hz",
            Self::Mass => "the moving mass is tripled in motion",
            Self::Supply => "the supply falls from 6 to 4 bar in motion",
            Self::ValveGain => "the valve loses 30 % of its gain in motion",
            Self::Friction => "friction doubles in motion",
            Self::Rest => "60 s at rest under noise, then motion",
            Self::WrongSign => "the valve is connected the wrong way round",
            Self::WrongOrder => "the plant has another order than the model",
            Self::StuckSensor => "the sensor repeats its last code",
            Self::StuckValve => "the spool stays where it is",
            Self::BlockedAxis => "the slide is clamped",
        }
    }

    /// Whether the drive changes in motion.
    pub const fn is_change(self) -> bool {
        matches!(
            self,
            Self::Mass | Self::Supply | Self::ValveGain | Self::Friction
        )
    }

    /// Whether the drive has a fault that must be refused, and the reasons that are right for it.
    pub fn expected(self) -> Option<&'static [Reason]> {
        match self {
            Self::WrongSign => Some(&[Reason::WrongSign]),
            Self::WrongOrder => Some(&[Reason::PoorFit]),
            Self::StuckSensor => Some(&[Reason::SensorStuck]),
            Self::StuckValve => Some(&[Reason::ValveStuck]),
            Self::BlockedAxis => Some(&[Reason::Blocked]),
            _ => None,
        }
    }
}

/// How a scenario is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Gains stay as the commissioning found them.
    pub fixed: bool,
    /// The linear servo instead of the pneumatic axis.
    pub linear: bool,
    /// Seed of the noise, and of the time of a change.
    pub seed: u64,
}

/// The figures of one run; `None` where the scenario does not come to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// The scenario.
    pub scenario: Scenario,
    /// The seed.
    pub seed: u64,
    /// Time of excitation until a model was verified \[s\].
    pub verified_at_s: Option<f64>,
    /// Largest true error in the last 0.5 s of 2 s after a step of 60 mm was commanded \[mm\].
    pub steady_state_mm: Option<f64>,
    /// From 10 to 90 % of the step, true position \[ms\].
    pub rise_ms: Option<f64>,
    /// Largest true position beyond the target, in % of the step.
    pub overshoot_pct: Option<f64>,
    /// Largest true error over two periods of a sine of 60 mm at 0.5 Hz, after one period \[mm\].
    pub tracking_0p5hz_mm: Option<f64>,
    /// The same at 1 Hz over three periods \[mm\].
    pub tracking_1hz_mm: Option<f64>,
    /// Time from the change until the true error stays within 1.5 times 0.7 mm on the sine of 0.5 Hz \[s\].
    pub recovered_s: Option<f64>,
    /// Range of the true position over 60 s at rest \[mm\].
    pub rest_range_mm: Option<f64>,
    /// Whether the gains after the rest, or after a refusal, are bit for bit those before.
    pub gains_kept: Option<bool>,
    /// Models that reached the controller.
    pub accepted: u32,
    /// State at the end.
    pub state: State,
}

/// One figure of a run.
type Figure = fn(&Figures) -> Option<f64>;

impl Figures {
    /// What is wanted of the axis, and by which factor more is granted after a change in motion.
    const WANTED: [(&str, f64, Figure); 5] = [
        ("steady state in mm", 0.05, |f| f.steady_state_mm),
        ("rise in ms", 200.0, |f| f.rise_ms),
        ("overshoot in %", 1.0, |f| f.overshoot_pct),
        ("0.5 Hz in mm", 0.7, |f| f.tracking_0p5hz_mm),
        ("1 Hz in mm", 1.2, |f| f.tracking_1hz_mm),
    ];

    /// The figures that are worse than wanted: name, figure, limit. After a change in motion one and
    /// a half times the limits are granted, and 2 s until the error is as small as that again.
    pub fn outside(&self) -> Vec<(&'static str, f64, f64)> {
        let share = if self.scenario.is_change() { 1.5 } else { 1.0 };
        let mut figures: Vec<_> = Self::WANTED
            .iter()
            .map(|(name, limit, of)| (*name, of(self), share * limit))
            .collect();
        if self.scenario.is_change() {
            figures.push(("recovery in s", self.recovered_s, 2.0));
        }
        figures
            .into_iter()
            .map(|(name, figure, limit)| (name, figure.unwrap_or(f64::INFINITY), limit))
            .filter(|(_, figure, limit)| figure > limit)
            .collect()
    }

    /// Whether a fault was refused with the reason that belongs to it.
    pub fn refused_rightly(&self) -> bool {
        match self.state {
            State::Rejected(reason) | State::Failed(reason) => self
                .scenario
                .expected()
                .is_some_and(|expected| expected.contains(&reason)),
            _ => false,
        }
    }
}

/// Sees every sample of a run.
pub type Watcher<'a> = &'a mut dyn FnMut(&Instant, &Rig);

/// A run on its way: the rig, its figures and who watches.
struct Run<'a> {
    rig: Rig,
    figures: Figures,
    watcher: Watcher<'a>,
    /// Has the plant when it is there.
    companion: Option<&'a mut dyn Companion>,
}

/// Everything in a run gives `None` when the companion ends it.
impl Run<'_> {
    fn step(&mut self) -> Option<Instant> {
        let code = self.rig.plant.code();
        let reading = match &mut self.companion {
            Some(companion) => companion.reading(code),
            None => Some(code),
        };
        let instant = self.rig.sample(reading);
        let command = match &mut self.companion {
            Some(companion) => companion.update(reading, &instant.report, &self.rig)?,
            None => instant.report.command,
        };
        self.rig.drive(command);
        (self.watcher)(&instant, &self.rig);
        Some(instant)
    }

    fn ask(&mut self, request: Request) {
        self.rig.ask(request);
        if let Some(companion) = &mut self.companion {
            companion.request(request);
        }
    }

    fn pass(&mut self, seconds: f64) -> Option<()> {
        for _ in 0..(1e3 * seconds) as u32 {
            let _ = self.step()?;
        }
        Some(())
    }

    /// Commissions; whether there is a model.
    fn commission(&mut self) -> Option<bool> {
        self.ask(Request::Commission);
        for k in 1..=4000 {
            let state = self.step()?.report.state;
            if state == State::Verified {
                self.figures.verified_at_s = Some(1e-3 * f64::from(k));
                return Some(true);
            }
            if !state.is_commissioning() {
                return Some(false);
            }
        }
        Some(false)
    }

    fn move_to(&mut self, target: f64, seconds: f64) -> Option<()> {
        self.ask(Request::MoveTo(target as f32));
        self.pass(seconds)
    }

    /// Steps of 60 mm there and back; the worse of both counts.
    fn steps(&mut self) -> Option<()> {
        self.move_to(170.0, 2.0)?;
        let (mut steady, mut rise, mut over) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (from, to) in [(170.0, 230.0), (230.0, 170.0)] {
            self.ask(Request::MoveTo(to as f32));
            let share = |x: f64| (x - from) / (to - from);
            let (mut at_10, mut at_90) = (None, None);
            for k in 0..2000 {
                let x = self.step()?.position_mm;
                let s = share(x);
                if s >= 0.1 && at_10.is_none() {
                    at_10 = Some(k);
                }
                if s >= 0.9 && at_90.is_none() {
                    at_90 = Some(k);
                }
                over = over.max(100.0 * (s - 1.0));
                if k >= 1500 {
                    steady = steady.max((x - to).abs());
                }
            }
            rise = rise.max(match (at_10, at_90) {
                (Some(a), Some(b)) => f64::from(b - a),
                _ => f64::INFINITY,
            });
        }
        self.figures.steady_state_mm = Some(steady);
        self.figures.rise_ms = Some(rise);
        self.figures.overshoot_pct = Some(over);
        Some(())
    }

    /// A sine about the present reference.
    fn oscillate(&mut self, amplitude: f32, frequency: f32) {
        self.ask(Request::Oscillate {
            amplitude,
            frequency,
        });
    }

    /// Largest error over `periods` of a sine about 200 mm, after one to begin.
    fn sine(&mut self, hz: f64, periods: f64) -> Option<f64> {
        self.move_to(200.0, 1.5)?;
        self.oscillate(60.0, hz as f32);
        self.pass(1.0 / hz)?;
        let mut worst = 0.0_f64;
        for _ in 0..(1e3 * periods / hz) as u32 {
            worst = worst.max(error(&self.step()?).abs());
        }
        Some(worst)
    }

    fn performance(&mut self) -> Option<()> {
        self.steps()?;
        self.figures.tracking_0p5hz_mm = Some(self.sine(0.5, 2.0)?);
        self.figures.tracking_1hz_mm = Some(self.sine(1.0, 3.0)?);
        Some(())
    }

    /// A sine of 0.5 Hz, the change at a random time in it, and 4 s more.
    fn change(&mut self) -> Option<()> {
        self.move_to(200.0, 1.5)?;
        self.oscillate(60.0, 0.5);
        let delay = ChaCha8Rng::seed_from_u64(self.figures.seed ^ 0x5eed).random_range(0.0..2.0);
        self.pass(4.0 + delay)?;
        self.rig.plant.change(self.figures.scenario);
        let mut last_bad = 0;
        for k in 1..=4000 {
            if error(&self.step()?).abs() > 1.5 * 0.7 {
                last_bad = k;
            }
        }
        // Not recovered at the end of the observation is no recovery.
        self.figures.recovered_s = (last_bad < 4000).then_some(1e-3 * f64::from(last_bad));
        Some(())
    }

    fn rest(&mut self) -> Option<()> {
        self.move_to(230.0, 2.0)?;
        let before = self.rig.servo.supervisor().good();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..60_000 {
            let x = self.step()?.position_mm;
            low = low.min(x);
            high = high.max(x);
        }
        self.figures.rest_range_mm = Some(high - low);
        self.figures.gains_kept = Some(same_bits(before, self.rig.servo.supervisor().good()));
        Some(())
    }

    /// The fault comes after a good commissioning, and the axis is commissioned again.
    fn fault(&mut self) -> Option<()> {
        self.move_to(200.0, 1.5)?;
        let before = self.rig.servo.supervisor().good();
        let scenario = self.figures.scenario;
        if scenario == Scenario::StuckValve {
            // A spool that sticks, sticks where it works and not in the middle.
            self.oscillate(60.0, 1.0);
            let mut k = 0;
            while k < 5000 && self.rig.plant.opening().abs() < 0.1 {
                let _ = self.step()?;
                k += 1;
            }
        }
        self.rig.plant.change(scenario);
        let verified = self.figures.verified_at_s;
        let _ = self.commission()?;
        self.figures.verified_at_s = verified;
        self.pass(0.2)?;
        self.figures.gains_kept = Some(same_bits(before, self.rig.servo.supervisor().good()));
        Some(())
    }

    /// All of the scenario.
    fn whole(&mut self) -> Option<()> {
        if !self.commission()? {
            return Some(());
        }
        self.pass(0.5)?;
        let scenario = self.figures.scenario;
        if scenario.expected().is_some() {
            return self.fault();
        }
        if scenario.is_change() {
            self.change()?;
        } else if scenario == Scenario::Rest {
            self.rest()?;
        }
        self.performance()
    }
}

/// Reference minus true position \[mm\].
fn error(instant: &Instant) -> f64 {
    f64::from(instant.report.setpoint.position) - instant.position_mm
}

fn same_bits(a: Option<ServoModel>, b: Option<ServoModel>) -> bool {
    let bits = |m: Option<ServoModel>| m.map(|m| m.parameters().map(f32::to_bits));
    a.is_some() && bits(a) == bits(b)
}

/// The settings of the loop in all scenarios.
pub fn loop_config(options: &Options) -> LoopConfig {
    let mut config = LoopConfig::new(ROUGH_BANDWIDTH, TRAVEL);
    config.adaptive = !options.fixed;
    config
}

/// Runs a scenario; `watcher` sees every sample.
pub fn run(scenario: Scenario, options: &Options, watcher: Watcher) -> Figures {
    run_with(scenario, options, &loop_config(options), watcher)
}

/// As [`run`] with a companion of the loop; the figures are those of the part that was run.
pub fn run_beside<'a>(
    scenario: Scenario,
    options: &Options,
    companion: &'a mut dyn Companion,
    watcher: Watcher<'a>,
) -> Figures {
    let config = loop_config(options);
    run_all(scenario, options, &config, watcher, Some(companion))
}

/// As [`run`] with other settings of the loop.
pub fn run_with(
    scenario: Scenario,
    options: &Options,
    config: &LoopConfig,
    watcher: Watcher,
) -> Figures {
    run_all(scenario, options, config, watcher, None)
}

fn run_all<'a>(
    scenario: Scenario,
    options: &Options,
    config: &LoopConfig,
    watcher: Watcher<'a>,
    companion: Option<&'a mut dyn Companion>,
) -> Figures {
    let plant = if options.linear {
        Plant::linear(options.seed)
    } else {
        Plant::pneumatic(&AxisParameters::SERVO, options.seed)
    };
    let mut run = Run {
        rig: Rig::new(plant, config),
        figures: Figures {
            scenario,
            seed: options.seed,
            verified_at_s: None,
            steady_state_mm: None,
            rise_ms: None,
            overshoot_pct: None,
            tracking_0p5hz_mm: None,
            tracking_1hz_mm: None,
            recovered_s: None,
            rest_range_mm: None,
            gains_kept: None,
            accepted: 0,
            state: State::Idle,
        },
        watcher,
        companion,
    };
    // A run that was ended early has the figures that it came to.
    let _ = run.whole();
    run.figures.accepted = run.rig.servo.supervisor().counts().0;
    run.figures.state = run.rig.servo.supervisor().state();
    run.figures
}
