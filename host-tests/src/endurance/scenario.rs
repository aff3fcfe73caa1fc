//! What is run: scenarios, structures, memories.

use crate::endurance::motion::Motion;

/// Sample time in s.
pub const DT: f64 = 1e-3;

/// Binary noise before the scenario, and after one whose data do not obey the model, in samples.
pub const MOTION: u64 = 10_000;

/// Velocity gain of every drive.
pub const GAIN: f64 = 2500.0;

/// Half width of the dead zone, where the drive has one.
pub const DEAD_ZONE: f64 = 0.03;

/// What the axis makes of the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Behaviour {
    /// It obeys the model.
    Free,
    /// It stands where it stood, whatever the command.
    Stands,
    /// It runs from here to 10^7 and back, whatever the command.
    Ramps,
}

/// One scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenario {
    /// Its name.
    pub name: &'static str,
    /// The command.
    pub motion: Motion,
    /// What the axis makes of it.
    pub behaviour: Behaviour,
    /// Whether the measured position carries the noise of the setup; otherwise none.
    pub noise: bool,
    /// Resolution of the measured position; 0 for none.
    pub resolution: f64,
}

impl Scenario {
    const fn free(name: &'static str, motion: Motion) -> Self {
        Self {
            name,
            motion,
            behaviour: Behaviour::Free,
            noise: true,
            resolution: 0.0,
        }
    }

    /// Whether the estimate is expected to be right again ten seconds after data that did not obey
    /// the model.
    ///
    /// An axis that is carried along at any speed is not: its rows outweigh those of any motion
    /// after them.
    pub fn recovers(&self) -> bool {
        self.behaviour != Behaviour::Ramps
    }

    /// Whether the data obey the model.
    pub fn obeys_model(&self) -> bool {
        self.behaviour == Behaviour::Free
    }
}

const fn sine(amplitude: f64, hz: f64) -> Motion {
    Motion::Sine { amplitude, hz }
}

/// All scenarios.
pub const SCENARIOS: [Scenario; 16] = [
    Scenario {
        noise: false,
        ..Scenario::free("rest, exact", Motion::Rest)
    },
    Scenario::free("rest", Motion::Rest),
    Scenario::free("constant speed 0.4", Motion::Speed(0.4)),
    Scenario::free("constant speed 0.371", Motion::Speed(0.371)),
    Scenario::free("constant speed 0.02", Motion::Speed(0.02)),
    Scenario::free("sine 0.4 at 0.1 Hz", sine(0.4, 0.1)),
    Scenario::free("sine 0.02 at 0.1 Hz", sine(0.02, 0.1)),
    Scenario::free("sine 0.1 at 0.5 Hz", sine(0.1, 0.5)),
    Scenario::free("sine 0.4 at 3 Hz", sine(0.4, 3.0)),
    Scenario::free("stop and go", Motion::StopAndGo),
    Scenario::free("feedback, small steps", Motion::SmallSteps),
    Scenario::free("a day's mixture", Motion::Day),
    Scenario {
        noise: false,
        resolution: 0.005,
        ..Scenario::free("resolution 5 um, slow sine", sine(0.02, 0.1))
    },
    Scenario {
        behaviour: Behaviour::Stands,
        ..Scenario::free("blocked under 0.37", Motion::Speed(0.37))
    },
    Scenario {
        behaviour: Behaviour::Stands,
        ..Scenario::free("0.01 inside the dead zone", Motion::Speed(0.01))
    },
    Scenario {
        behaviour: Behaviour::Ramps,
        ..Scenario::free("ramps to 1e7", Motion::Speed(1.0))
    },
];

/// The drive and the structure that identifies it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// The reference servo with the default structure.
    Servo,
    /// The same without constant and initial state.
    Integrating3,
    /// A drive of order 2 without constant and initial state.
    Integrating2,
    /// The reference servo behind a dead zone of 0.03 that is an input of the model.
    DeadZone,
    /// A drive of order 2 with Coulomb friction that is an input of the model.
    Coulomb,
}

/// What surrounds a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Drive and structure.
    pub drive: Drive,
    /// Natural frequency of the drive and bandwidth of the design in rad/s.
    pub bandwidth: f64,
    /// Width of the white noise in um.
    pub noise_um: f64,
}

impl Setup {
    /// The setup of the table.
    pub const DEFAULT: Self = Self {
        drive: Drive::Servo,
        bandwidth: 20.0,
        noise_um: 10.0,
    };

    /// What differs from the default, for the name of a row.
    pub fn differs(&self) -> String {
        let mut text = String::new();
        match self.drive {
            Drive::Servo => {}
            Drive::Integrating3 => text += ", INTEGRATING of order 3",
            Drive::Integrating2 => text += ", INTEGRATING of order 2",
            Drive::DeadZone => text += ", dead zone as input",
            Drive::Coulomb => text += ", Coulomb friction as input",
        }
        if self.bandwidth != Self::DEFAULT.bandwidth {
            text += &format!(", {} rad/s", self.bandwidth);
        }
        if self.noise_um != Self::DEFAULT.noise_um {
            text += &format!(", {} um", self.noise_um);
        }
        text
    }
}

/// One run of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The scenario.
    pub scenario: Scenario,
    /// What surrounds it.
    pub setup: Setup,
    /// Memory in s.
    pub memory: Option<f64>,
    /// Whether the estimate after the first ten seconds is made nominal.
    pub trusted: bool,
}

impl Case {
    /// Name of the scenario with its setup.
    pub fn name(&self) -> String {
        format!("{}{}", self.scenario.name, self.setup.differs())
    }

    /// Whether the errors of the default at 10 um apply.
    ///
    /// Not with more noise, nor where so much is left by 10 um: with friction to be found, and of a
    /// memory of 0.2 s at 5 rad/s, which is that of one radian, and at 100 rad/s, whose small steps
    /// show little.
    pub fn has_limits(&self) -> bool {
        let shows = self.setup.drive != Drive::Coulomb;
        let short = self.setup.bandwidth != 20.0 && self.memory == Some(0.2);
        shows && !short && self.setup.noise_um <= 10.0
    }

    /// Whether the estimate has to be held: a command that acts does not move the axis.
    pub fn must_hold(&self) -> bool {
        let acts = match (self.setup.drive, self.scenario.motion) {
            (Drive::DeadZone, Motion::Speed(speed)) => speed.abs() > DEAD_ZONE,
            _ => true,
        };
        self.scenario.behaviour == Behaviour::Stands && acts
    }
}

/// The memories of the table in s.
pub const MEMORIES: [Option<f64>; 4] = [Some(0.2), Some(2.0), Some(10.0), None];

/// Every run of the table: all scenarios with the default setup, nine with each of the others.
pub fn cases() -> Vec<Case> {
    let other = |drive, bandwidth, noise_um| Setup {
        drive,
        bandwidth,
        noise_um,
    };
    let setups = [
        Setup::DEFAULT,
        other(Drive::Integrating3, 20.0, 10.0),
        other(Drive::Integrating2, 20.0, 10.0),
        other(Drive::DeadZone, 20.0, 10.0),
        other(Drive::Coulomb, 20.0, 10.0),
        other(Drive::Servo, 5.0, 10.0),
        other(Drive::Servo, 100.0, 10.0),
        other(Drive::Servo, 20.0, 0.0),
        other(Drive::Servo, 20.0, 100.0),
    ];
    let short = [
        "rest",
        "constant speed 0.4",
        "constant speed 0.02",
        "sine 0.1 at 0.5 Hz",
        "stop and go",
        "feedback, small steps",
        "a day's mixture",
        "blocked under 0.37",
        "0.01 inside the dead zone",
    ];
    let mut cases = Vec::new();
    for setup in setups {
        for scenario in SCENARIOS {
            if setup != Setup::DEFAULT && !short.contains(&scenario.name) {
                continue;
            }
            for memory in MEMORIES {
                for trusted in [false, true] {
                    cases.push(Case {
                        scenario,
                        setup,
                        memory,
                        trusted,
                    });
                }
            }
        }
    }
    cases
}
