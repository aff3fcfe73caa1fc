//! A scenario from the commissioning to its figures.

use trendid::servo::{self, State};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::plants::pneumatic::AxisParameters;
use crate::servo::figures::Figures;
use crate::servo::plant::Plant;
use crate::servo::rig::{Instant, ROUGH_BANDWIDTH, Request, Rig, TRAVEL};
use crate::servo::scenario::Scenario;
use crate::servo::shadow::Shadow;

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

impl Options {
    /// The pneumatic axis with gains that follow the model.
    pub const fn adaptive(seed: u64) -> Self {
        Self {
            fixed: false,
            linear: false,
            seed,
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
    shadow: Option<&'a mut dyn Shadow>,
}

/// Everything in a run gives `None` when the shadow ends it.
impl Run<'_> {
    fn step(&mut self) -> Option<Instant> {
        let code = self.rig.plant.code();
        let reading = match &mut self.shadow {
            Some(shadow) => shadow.reading(code),
            None => Some(code),
        };
        let instant = self.rig.sample(reading);
        let command = match &mut self.shadow {
            Some(shadow) => shadow.update(reading, &instant.report, &self.rig)?,
            None => instant.report.command,
        };
        self.rig.drive(command);
        (self.watcher)(&instant, &self.rig);
        Some(instant)
    }

    fn request(&mut self, request: Request) {
        self.rig.request(request);
        if let Some(shadow) = &mut self.shadow {
            shadow.request(request);
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
        self.request(Request::Commission);
        for k in 1..=7000 {
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
        self.request(Request::MoveTo(target as f32));
        self.pass(seconds)
    }

    /// Steps of 60 mm there and back; the worse of both counts.
    fn steps(&mut self) -> Option<()> {
        self.move_to(170.0, 2.0)?;
        let (mut steady, mut rise, mut over) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (from, to) in [(170.0, 230.0), (230.0, 170.0)] {
            self.request(Request::MoveTo(to as f32));
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
        self.request(Request::Oscillate {
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
        self.rig
            .plant
            .change(self.figures.scenario, self.figures.seed);
        let mut last_bad = 0;
        for k in 1..=7000 {
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
        let before = self.rig.servo.supervisor().verified_model();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..60_000 {
            let x = self.step()?.position_mm;
            low = low.min(x);
            high = high.max(x);
        }
        self.figures.rest_range_mm = Some(high - low);
        self.figures.gains_kept = Some(same_bits(
            before,
            self.rig.servo.supervisor().verified_model(),
        ));
        Some(())
    }

    /// The fault comes after a good commissioning, and the axis is commissioned again.
    fn fault(&mut self) -> Option<()> {
        self.move_to(200.0, 1.5)?;
        let before = self.rig.servo.supervisor().verified_model();
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
        self.rig.plant.change(scenario, self.figures.seed);
        let verified = self.figures.verified_at_s;
        let _ = self.commission()?;
        // How the commissioning ended; what the monitors then make of the wrong axis is another matter.
        self.figures.state = self.rig.servo.supervisor().state();
        self.figures.verified_at_s = verified;
        self.pass(0.2)?;
        self.figures.gains_kept = Some(same_bits(
            before,
            self.rig.servo.supervisor().verified_model(),
        ));
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

fn same_bits(a: Option<servo::Model>, b: Option<servo::Model>) -> bool {
    let bits = |m: Option<servo::Model>| m.map(|m| m.parameters().map(f32::to_bits));
    a.is_some() && bits(a) == bits(b)
}

/// The settings of the loop in all scenarios.
pub fn loop_config(options: &Options) -> servo::Config {
    let mut config = servo::Config::new(1e-3, ROUGH_BANDWIDTH, TRAVEL);
    config.adaptive = !options.fixed;
    config
}

/// Runs a scenario; `watcher` sees every sample.
pub fn run(scenario: Scenario, options: &Options, watcher: Watcher) -> Figures {
    run_with(scenario, options, &loop_config(options), watcher)
}

/// As [`run`] with a shadow of the loop; the figures are those of the part that was run.
pub fn run_with_shadow<'a>(
    scenario: Scenario,
    options: &Options,
    shadow: &'a mut dyn Shadow,
    watcher: Watcher<'a>,
) -> Figures {
    let config = loop_config(options);
    run_all(scenario, options, &config, watcher, Some(shadow))
}

/// As [`run`] with other settings of the loop.
pub fn run_with(
    scenario: Scenario,
    options: &Options,
    config: &servo::Config,
    watcher: Watcher,
) -> Figures {
    run_all(scenario, options, config, watcher, None)
}

fn run_all<'a>(
    scenario: Scenario,
    options: &Options,
    config: &servo::Config,
    watcher: Watcher<'a>,
    shadow: Option<&'a mut dyn Shadow>,
) -> Figures {
    let plant = if options.linear {
        Plant::linear(options.seed)
    } else {
        Plant::pneumatic(&AxisParameters::SERVO, options.seed)
    };
    let mut run = Run {
        rig: Rig::new(plant, config),
        figures: Figures::new(scenario, options.seed),
        watcher,
        shadow,
    };
    // A run that was ended early has the figures that it came to.
    let _ = run.whole();
    run.figures.accepted = run.rig.servo.supervisor().counts().0;
    if run.figures.scenario.expected().is_none() || run.figures.state == State::Idle {
        run.figures.state = run.rig.servo.supervisor().state();
    }
    run.figures
}
