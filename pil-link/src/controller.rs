//! The controller that runs on the target, and on the host beside it: one source, two processors.

use trendid::{Config, ConfigError, FilteredTrends, Identifier, Outcome, Scheme, Structure};

use crate::{Counters, Reply, flags, status};

/// Sample time in s.
pub const SAMPLE_TIME: f32 = 0.001;

/// Position gain in command per mm: a slow loop around the reference servo.
const GAIN: f32 = 0.002;

/// Stroke of the reference square in mm, and its half period in samples.
const STROKE: f32 = 50.0;
const HALF_PERIOD: u32 = 1000;

/// The test signal on top of the command, and its hold in samples: the loop alone does not excite the drive enough.
const TEST_SIGNAL: f32 = 0.2;
const HOLD: u32 = 40;

/// A position loop with identification: proportional controller, test signal, identifier of the reference servo.
#[derive(Clone, Debug)]
pub struct Controller {
    identifier: Identifier<FilteredTrends<3>, 3, 3>,
    sample: u32,
    register: u32,
    sign: f32,
    command: f32,
}

impl Controller {
    /// A controller at rest.
    ///
    /// # Errors
    /// None with the constants of this file; the constructors of the identifier say so by this type.
    pub fn try_new() -> Result<Self, ConfigError> {
        let mut config = Config::new(Structure::integrating(), 25.0, [1.0], 50.0);
        config.memory = Some(2.0);
        let trends = FilteredTrends::try_new(Scheme::Tustin, SAMPLE_TIME, [25.0; 3])?;
        Ok(Self {
            identifier: Identifier::try_new(&config, trends)?,
            sample: 0,
            register: 0x2545_F491,
            sign: 1.0,
            command: 0.0,
        })
    }

    /// Takes the position in mm, gives command, innovation, parameters and status; number and counters are the link's.
    ///
    /// A sample that is marked invalid or is no number leaves the command and the identifier as they were.
    pub fn update(&mut self, y: f32, bits: u8) -> Reply {
        let y = if bits & flags::INVALID == 0 {
            y
        } else {
            f32::NAN
        };
        if self.sample.is_multiple_of(HOLD) {
            // A shift register with the feedback of a maximal sequence of 32 bits (taps 32, 22, 2, 1).
            let low = self.register & 1;
            self.register >>= 1;
            if low == 1 {
                self.register ^= 0x8020_0003;
            }
            self.sign = if low == 1 { 1.0 } else { -1.0 };
        }
        let forth = (self.sample / HALF_PERIOD).is_multiple_of(2);
        self.sample = self.sample.wrapping_add(1);
        if y.is_finite() {
            let reference = if forth { STROKE } else { -STROKE };
            let wanted = GAIN * (reference - y) + TEST_SIGNAL * self.sign;
            self.command = wanted.clamp(-1.0, 1.0);
        }
        let outcome = self.identifier.update(self.command, y);
        Reply {
            seq: 0,
            u: self.command,
            innovation: outcome.innovation().unwrap_or(0.0),
            parameters: self.identifier.theta().into_iter().collect(),
            status: match outcome {
                Outcome::WarmingUp { .. } => status::WARMING_UP,
                Outcome::Estimated { .. } => status::ESTIMATED,
                Outcome::Held { .. } => status::HELD,
                Outcome::Refused(_) => status::REFUSED,
            },
            counters: Counters::default(),
        }
    }
}
