//! The edge to the machine: position sensors and valves over embedded-hal 1.0, and the scale
//! between counts and units.
//!
//! Drivers speak raw integer codes. A code is converted to a float once, by [`Axis`], after a
//! reference has been subtracted in counts: the float then carries the increment and not the
//! distance from a far zero, which would exceed the resolution of an f32. The valve takes the
//! command of the model, -1 to 1.
//!
//! Every driver has a safe output for a controller that gives up ([`Valve::safe`]).

mod dac;
mod pwm;
mod ssi;

pub use dac::DacValve;
pub use pwm::{PwmError, PwmValve};
pub use ssi::{SsiCode, SsiEncoder, SsiError, SsiFormat};

/// A sensor that gives the position as an integer code.
pub trait PositionSensor {
    /// Why a reading failed.
    type Error;

    /// Reads the position in counts, which go on over the whole travel: what wraps within it, as a
    /// quadrature counter of 16 bits, is a jump unless it wraps at 32 bits.
    ///
    /// # Errors
    /// A reading that failed its own checks (bus, alarm, parity) is an error and never a number.
    fn counts(&mut self) -> Result<i32, Self::Error>;
}

/// An actuator that takes the command u of the model.
pub trait Valve {
    /// Why the output failed.
    type Error;

    /// Sets the command and returns what was set: `command` limited to -1..=1, and zero for NaN.
    ///
    /// The identifier must see the returned value, not the requested one: a saturation that it does
    /// not see is a gain error.
    ///
    /// # Errors
    /// The error of the output; the command is then unknown.
    fn drive(&mut self, command: f32) -> Result<f32, Self::Error>;

    /// Sets the output at which the machine comes to rest: command zero.
    ///
    /// # Errors
    /// The error of the output.
    fn safe(&mut self) -> Result<(), Self::Error> {
        self.drive(0.0).map(|_| ())
    }
}

/// Units per count, e.g. 0.005 mm for a scale of 5 um.
///
/// ```
/// use trendid::hardware::Scale;
///
/// assert_eq!(Scale::new(0.005).map(|scale| scale.units(200)), Some(1.0));
/// assert_eq!(Scale::new(0.0), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(f32);

impl Scale {
    /// A scale of `units_per_count`; negative when the sensor counts against the model.
    ///
    /// `None` unless the value is finite and not zero.
    #[must_use]
    pub const fn new(units_per_count: f32) -> Option<Self> {
        if units_per_count.is_finite() && units_per_count != 0.0 {
            Some(Self(units_per_count))
        } else {
            None
        }
    }

    /// The length of `counts`; exact to the last bit of the product up to 2^24 counts.
    #[must_use]
    pub const fn units(self, counts: i32) -> f32 {
        counts as f32 * self.0
    }
}

/// A scale with the code that stands for position zero.
///
/// ```
/// use trendid::hardware::{Axis, Scale};
///
/// let axis = Axis { scale: Scale::new(0.001).ok_or("scale")?, reference: 16_000_000 };
/// // An f32 of 16 000.001 mm does not exist; the increment from the reference is exact.
/// assert_eq!(axis.position(16_000_001), 0.001);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Units per count.
    pub scale: Scale,
    /// Counts at position zero, taken when the controller starts.
    pub reference: i32,
}

impl Axis {
    /// Position relative to the reference, in units of the scale.
    ///
    /// The difference wraps with a counter of 32 bits, so a reference near its end causes no jump.
    /// A code of fewer bits that passes its end does: a driver must carry on what wraps before.
    #[must_use]
    pub const fn position(self, counts: i32) -> f32 {
        self.scale.units(counts.wrapping_sub(self.reference))
    }

    /// Length of one code, in units of the scale.
    #[must_use]
    pub const fn resolution(self) -> f32 {
        self.scale.units(1).abs()
    }
}

/// The command that an output can carry: limited to -1..=1, zero for NaN.
fn limited(command: f32) -> f32 {
    if command.is_nan() {
        0.0
    } else {
        command.clamp(-1.0, 1.0)
    }
}

#[cfg(test)]
extern crate std;

/// A bus on which every transaction fails.
#[cfg(test)]
#[derive(Debug)]
struct DeadBus;

#[cfg(test)]
impl embedded_hal::spi::ErrorType for DeadBus {
    type Error = embedded_hal::spi::ErrorKind;
}

#[cfg(test)]
impl embedded_hal::spi::SpiDevice for DeadBus {
    fn transaction(
        &mut self,
        _: &mut [embedded_hal::spi::Operation<'_, u8>],
    ) -> Result<(), Self::Error> {
        Err(embedded_hal::spi::ErrorKind::Overrun)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_refuses_what_is_no_scale() {
        for bad in [0.0, -0.0, f32::NAN, f32::INFINITY] {
            assert_eq!(Scale::new(bad), None);
        }
    }

    #[test]
    fn the_difference_wraps_with_the_counter() {
        let axis = Axis {
            scale: Scale(0.5),
            reference: i32::MAX,
        };
        assert_eq!(axis.position(i32::MIN), 0.5);
        assert_eq!(axis.position(i32::MAX - 2), -1.0);
    }

    #[test]
    fn a_command_is_limited() {
        assert_eq!(limited(f32::NAN), 0.0);
        assert_eq!(limited(f32::INFINITY), 1.0);
        assert_eq!(limited(-1.5), -1.0);
        assert_eq!(limited(0.25), 0.25);
    }
}
