//! The movement by which a drive gets to know itself: bounded binary noise around the actual position.

use crate::error::positive;
use crate::servo::error::ServoError;
use crate::servo::motion::Travel;

/// How the axis is moved to identify it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ExcitationConfig {
    /// Largest command, within 0..=1.
    pub amplitude: f32,
    /// Time for which a level is held, in s; about one over the bandwidth of the plant.
    pub hold: f32,
    /// How far the axis may go from where it was, in units of y.
    pub stroke: f32,
    /// Time in which the axis stops when the command reverses, in s.
    pub stopping: f32,
    /// After this time the commissioning ends without a model, in s.
    pub time_limit: f32,
}

impl ExcitationConfig {
    /// Levels up to 0.5 held for 1.4 over the rough `bandwidth` (rad/s), a fifth of the travel, 3 s.
    pub fn new(bandwidth: f32, travel: Travel) -> Self {
        Self {
            amplitude: 0.5,
            hold: 1.4 / bandwidth,
            stroke: 0.2 * travel.length(),
            stopping: 2.0 / bandwidth,
            time_limit: 3.0,
        }
    }
}

/// Binary noise with random levels that turns back before it leaves its band.
///
/// Signs and levels come from a shift register of 15 bits (x^15 + x^14 + 1, period
/// 32767). The levels are 25 to 100 % of the amplitude: two levels alone could not tell a
/// dead zone from a gain. Where the axis would come to rest, y + v times the stopping
/// time, is compared with the band; beyond it only a command that leads back is given.
///
/// Guarantees: |u| <= amplitude; beyond the band the sign leads inwards.
///
/// # Examples
/// ```
/// use trendid::{Excitation, ExcitationConfig, Travel};
/// let travel = Travel { begin: 0.0, end: 400.0 };
/// let mut excitation = Excitation::try_new(&ExcitationConfig::new(20.0, travel), travel, 0.001)?;
/// excitation.begin(200.0);
/// assert!(excitation.update(200.0, 0.0).abs() <= 0.5);
/// assert!(excitation.update(399.0, 0.0) < 0.0);
/// # Ok::<(), trendid::ServoError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excitation {
    amplitude: f32,
    hold: u32,
    stroke: f32,
    stopping: f32,
    travel: Travel,
    band: Travel,
    register: u16,
    left: u32,
    level: f32,
}

/// Where the register begins: of some hundred places one after which signs and levels of the first 0.3 s
/// separate gain, dead zone and friction well, for axes of several masses and frictions.
const START: u16 = 0x1505;

impl Excitation {
    /// An excitation of an axis with this travel.
    ///
    /// # Errors
    /// [`ServoError::Travel`], [`ServoError::Amplitude`], [`ServoError::Time`], [`ServoError::Bound`].
    pub fn try_new(
        config: &ExcitationConfig,
        travel: Travel,
        sample_time: f32,
    ) -> Result<Self, ServoError> {
        travel.check()?;
        if !(config.amplitude > 0.0 && config.amplitude <= 1.0) {
            return Err(ServoError::Amplitude(config.amplitude));
        }
        if !(positive(config.hold) && config.hold / sample_time < 1e6) {
            return Err(ServoError::Time(config.hold));
        }
        if !positive(config.stopping) {
            return Err(ServoError::Time(config.stopping));
        }
        if !positive(config.stroke) {
            return Err(ServoError::Bound(config.stroke));
        }
        Ok(Self {
            amplitude: config.amplitude,
            hold: (config.hold / sample_time) as u32,
            stroke: config.stroke,
            stopping: config.stopping,
            travel,
            band: travel.inner(),
            register: START,
            left: 0,
            level: 0.0,
        })
    }

    /// Begins around `position`, with the same sequence every time.
    pub fn begin(&mut self, position: f32) {
        let inner = self.travel.inner();
        let (low, high) = (position - self.stroke, position + self.stroke);
        self.band = Travel {
            begin: if low > inner.begin { low } else { inner.begin },
            end: if high < inner.end { high } else { inner.end },
        };
        // Outside the inner travel the band is the nearest part of it.
        if !(self.band.length() > 0.0) {
            self.band = inner;
        }
        self.register = START;
        self.left = 0;
        self.level = 0.0;
    }

    /// The next command, at `position` with about this `velocity`. Cost: about 40 instructions.
    pub fn update(&mut self, position: f32, velocity: f32) -> f32 {
        let ahead = position + self.stopping * velocity;
        if self.left == 0 {
            self.left = self.hold;
            let sign = if self.bit() { 1.0 } else { -1.0 };
            let bits = 2 * u8::from(self.bit()) + u8::from(self.bit());
            self.level = sign * self.amplitude * (0.25 + 0.25 * f32::from(bits));
        }
        self.left = self.left.saturating_sub(1);
        let outwards = (ahead > self.band.end && self.level > 0.0)
            || (ahead < self.band.begin && self.level < 0.0);
        if outwards {
            self.level = -self.level;
            self.left = self.hold;
        }
        self.level
    }

    /// The band in which the axis is kept, without the overrun of one reversal.
    pub const fn band(&self) -> Travel {
        self.band
    }

    fn bit(&mut self) -> bool {
        let bit = ((self.register >> 14) ^ (self.register >> 13)) & 1;
        self.register = ((self.register << 1) | bit) & 0x7fff;
        bit == 1
    }
}
