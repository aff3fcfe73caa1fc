//! The movement by which a drive is identified: bounded random levels around the actual position.

use crate::servo::design::ExcitationDesign;
use crate::servo::design::constants::RUNAWAY_SLACK_RATIO;
use crate::servo::motion::Travel;

/// Binary noise with random levels that turns back before it leaves its band.
///
/// Signs and levels come from a shift register of 15 bits (x^15 + x^14 + 1, period
/// 32767). The levels are 25 to 100 % of the amplitude: with two levels alone a dead
/// zone looks like a smaller gain. The place where the axis would come to rest, y + v times
/// the stopping time, is compared with the band; beyond it only a command that leads back is given.
///
/// Guarantees: |u| <= amplitude; beyond the band the sign leads inwards.
///
/// Known as: amplitude-modulated pseudo-random binary signal, APRBS (Isermann and Munchhof 2011).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Excitation {
    design: ExcitationDesign,
    band: Travel,
    register: u16,
    /// Samples of the present level that are left.
    remaining: u32,
    level: f32,
    /// Samples in a row outside of the band.
    outside: u32,
}

/// Seed, chosen among several hundred so that the first 0.3 s separate gain, dead zone and friction, for axes of several
/// masses and frictions.
const SEED: u16 = 0x1505;

impl Excitation {
    /// An excitation that has not begun.
    pub(crate) fn new(design: &ExcitationDesign) -> Self {
        Self {
            design: *design,
            band: design.travel.inner(),
            register: SEED,
            remaining: 0,
            level: 0.0,
            outside: 0,
        }
    }

    /// Begins around `position`, with the same sequence every time.
    pub(crate) fn begin(&mut self, position: f32) {
        let inner = self.design.travel.inner();
        let (low, high) = (position - self.design.stroke, position + self.design.stroke);
        let band = Travel {
            min: if low > inner.min { low } else { inner.min },
            max: if high < inner.max { high } else { inner.max },
        };
        // Outside the inner travel the band is the nearest part of it.
        let band = if band.length() > 0.0 { band } else { inner };
        *self = Self {
            band,
            ..Self::new(&self.design)
        };
    }

    /// The next command, at `position` with about this `velocity`. Cost: about 40 instructions.
    pub(crate) fn update(&mut self, position: f32, velocity: f32) -> f32 {
        let ahead = position + self.design.stopping_time * velocity;
        if self.remaining == 0 {
            self.remaining = self.design.hold;
            let sign = if self.bit() { 1.0 } else { -1.0 };
            let bits = 2 * u8::from(self.bit()) + u8::from(self.bit());
            self.level = sign * self.design.amplitude * (0.25 + 0.25 * f32::from(bits));
        }
        self.remaining = self.remaining.saturating_sub(1);
        let outwards = (ahead > self.band.max && self.level > 0.0)
            || (ahead < self.band.min && self.level < 0.0);
        if outwards {
            self.level = -self.level;
            self.remaining = self.design.hold;
        }
        self.level
    }

    /// Takes a position; whether the axis has been too long beyond the band and the way back, or at an end of its travel.
    pub(crate) fn runs_away(&mut self, y: f32) -> bool {
        let (band, travel) = (self.band, self.design.travel);
        let slack = RUNAWAY_SLACK_RATIO * band.length();
        let outside = y > band.max + slack || y < band.min - slack;
        let at_end = y >= travel.max || y <= travel.min;
        self.outside = if outside || at_end {
            self.outside.saturating_add(1)
        } else {
            0
        };
        self.outside > self.design.runaway
    }

    fn bit(&mut self) -> bool {
        let bit = ((self.register >> 14) ^ (self.register >> 13)) & 1;
        self.register = ((self.register << 1) | bit) & 0x7fff;
        bit == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::config::Config;
    use crate::servo::error::Error;

    #[test]
    fn beyond_the_band_the_command_leads_inwards() -> Result<(), Error> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let design = Config::new(0.001, 20.0, travel).resolve()?;
        let mut excitation = Excitation::new(&design.excitation);
        excitation.begin(200.0);
        assert!(excitation.update(200.0, 0.0).abs() <= 0.5);
        assert!(excitation.update(399.0, 0.0) < 0.0);
        assert!(excitation.update(1.0, 0.0) > 0.0);
        Ok(())
    }
}
