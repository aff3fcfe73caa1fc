//! A scenario from the commissioning to its figures.

use trendid::servo::{self, State};

use crate::random::Random;
use rand::{RngExt, SeedableRng};

use crate::plants::pneumatic::AxisParameters;
use crate::servo::figures::Figures;
pub use crate::servo::passage::Watcher;
use crate::servo::passage::{Run, error};
use crate::servo::plant::Plant;
use crate::servo::population::range::{Purpose, stream};
use crate::servo::rig::{DEAD_VOLUME, ROUGH_BANDWIDTH, Rig, TRAVEL};
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
    /// Where the pneumatic axis stands at the start \[mm\].
    pub start_mm: f64,
}

impl Options {
    /// The pneumatic axis with gains that follow the model.
    pub const fn adaptive(seed: u64) -> Self {
        Self {
            fixed: false,
            linear: false,
            seed,
            start_mm: AxisParameters::SERVO.start_mm,
        }
    }

    /// The same from a place of its seed: from one place all records are one, as the levels of the
    /// excitation turn where the axis is.
    pub fn somewhere(self) -> Self {
        let mut random = stream(self.seed, Purpose::Axis);
        Self {
            start_mm: random.random_range(150.0..250.0),
            ..self
        }
    }
}

impl Run<'_> {
    /// A sine of 0.5 Hz, the change at a random time in it, and 4 s more.
    fn change(&mut self) -> Option<()> {
        self.move_to(200.0, 1.5)?;
        self.oscillate(60.0, 0.5);
        let delay = Random::seed_from_u64(self.figures.seed ^ 0x5eed).random_range(0.0..2.0);
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
        // How the commissioning ended; what the monitors then make of the wrong axis is another
        // matter.
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

fn same_bits(a: Option<servo::Model>, b: Option<servo::Model>) -> bool {
    let bits = |m: Option<servo::Model>| m.map(|m| m.parameters().map(f32::to_bits));
    a.is_some() && bits(a) == bits(b)
}

/// The settings of the loop in all scenarios.
pub fn loop_config(options: &Options) -> servo::Config {
    stating(options, 1.0)
}

/// The settings of a user whose bandwidth is so many times the usual guess.
pub fn stating(options: &Options, ratio: f32) -> servo::Config {
    let mut config = servo::Config::new(1e-3, ratio * ROUGH_BANDWIDTH, TRAVEL);
    config.adaptive = !options.fixed;
    let dead_volume = if options.linear {
        f32::INFINITY
    } else {
        DEAD_VOLUME
    };
    config.controller.dead_volume = Some(dead_volume);
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
        let axis = AxisParameters {
            start_mm: options.start_mm,
            ..AxisParameters::SERVO
        };
        Plant::pneumatic(&axis, options.seed)
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
