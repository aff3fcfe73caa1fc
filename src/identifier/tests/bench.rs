//! A servo that is simulated, and an identifier for it.

use crate::estimation::structure::Structure;
use crate::identifier::{Config, Identifier};
use crate::trends::{FilteredTrends, Scheme};

pub(in crate::identifier) type Trends = FilteredTrends<3>;
pub(in crate::identifier) type Servo3 = Identifier<Trends, 3, 3, 1, 0>;

pub(in crate::identifier) fn config() -> Config<3, 3, 1> {
    Config::new(Structure::INTEGRATING, 20.0, [0.4], 50.0)
}

/// The trends for a bandwidth, of samples of 1 ms.
pub(in crate::identifier) fn trends(bandwidth: f32) -> Trends {
    Trends::for_bandwidth(Scheme::Tustin, 1e-3, bandwidth).expect("a filter")
}

pub(in crate::identifier) fn identifier(config: &Config<3, 3, 1>) -> Servo3 {
    Identifier::try_new(config, trends(20.0)).expect("settings")
}

/// An identifier that has seen `samples` of the drive, and where that is.
pub(in crate::identifier) fn trained(config: &Config<3, 3, 1>, samples: u32) -> (Servo3, Drive) {
    let mut identifier = identifier(config);
    let mut drive = Drive::new(1e-4);
    for k in 0..samples {
        let [u, y] = drive.sample(k);
        let _ = identifier.update(u, y);
    }
    (identifier, drive)
}

/// A command of random steps and the position of a servo under it, rounded to `step`:
/// y''' + 20 y'' + 400 y' = 10^6 u.
#[derive(Clone)]
pub(in crate::identifier) struct Drive {
    state: u32,
    pub(in crate::identifier) u: f32,
    pub(in crate::identifier) at: [f32; 3],
    step: f32,
    /// What the command is multiplied by, 1 unless the drive is another one.
    pub(in crate::identifier) gain: f32,
}

impl Drive {
    pub(in crate::identifier) const fn new(step: f32) -> Self {
        Self {
            state: 1,
            u: 0.0,
            at: [0.0; 3],
            step,
            gain: 1.0,
        }
    }

    /// A number without a pattern, from -1 to 1.
    pub(in crate::identifier) fn draw(&mut self) -> f32 {
        self.state = self
            .state
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        (self.state >> 8) as f32 / 8_388_608.0 - 1.0
    }

    /// The command of sample `k`.
    pub(in crate::identifier) fn command(&mut self, k: u32) -> f32 {
        if k.is_multiple_of(120) {
            self.u = 0.3 * self.draw() - 0.2 * self.at[0].signum();
        }
        self.u
    }

    /// The position now, and a sample time under `u`.
    pub(in crate::identifier) fn under(&mut self, u: f32) -> f32 {
        let [y, ..] = self.at;
        for _ in 0..10 {
            let [y, v, a] = self.at;
            let jerk = 1e6 * self.gain * u - 400.0 * v - 20.0 * a;
            self.at = [y + 1e-4 * v, v + 1e-4 * a, a + 1e-4 * jerk];
        }
        libm::roundf(y / self.step) * self.step
    }

    pub(in crate::identifier) fn sample(&mut self, k: u32) -> [f32; 2] {
        let u = self.command(k);
        [u, self.under(u)]
    }
}
