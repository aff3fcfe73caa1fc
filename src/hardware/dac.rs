//! Valve driven by an analogue voltage from a 16-bit converter.

use embedded_hal::spi::SpiDevice;

use super::{Valve, limited};

/// Code of command zero: the middle of the straight binary range.
const MIDDLE: i32 = 0x8000;

/// Codes from zero to full command on either side.
const FULL: f32 = 32_767.0;

/// A valve amplifier on a DAC with 24-bit frames (eight control bits, zero for normal operation,
/// then the code, high byte first), as the DAC8551 and the AD5662 speak them; the middle code is
/// command zero.
///
/// The command is rounded to the steps of the converter and the rounded value is returned.
#[derive(Debug)]
pub struct DacValve<SPI> {
    spi: SPI,
}

impl<SPI: SpiDevice> DacValve<SPI> {
    /// A valve whose output is not touched before the first command.
    pub fn new(spi: SPI) -> Self {
        Self { spi }
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }
}

impl<SPI: SpiDevice> Valve for DacValve<SPI> {
    type Error = SPI::Error;

    fn drive(&mut self, command: f32) -> Result<f32, Self::Error> {
        let wanted = limited(command) * FULL;
        let half = if wanted < 0.0 { -0.5 } else { 0.5 };
        let steps = (wanted + half) as i32;
        let [.., high, low] = (MIDDLE + steps).to_be_bytes();
        self.spi.write(&[0, high, low])?;
        Ok(steps as f32 / FULL)
    }
}

#[cfg(test)]
mod tests {
    use super::super::std::vec;
    use embedded_hal::spi::ErrorKind;
    use embedded_hal_mock::eh1::spi::{Mock, Transaction};

    use super::*;

    #[test]
    fn codes_and_returned_commands() {
        let third = (10_922.0f32) / 32_767.0;
        let cases = [
            (0.0, 0x8000, 0.0),
            (1.0, 0xFFFF, 1.0),
            (-1.0, 0x0001, -1.0),
            (9.0, 0xFFFF, 1.0),
            (f32::NEG_INFINITY, 0x0001, -1.0),
            (f32::NAN, 0x8000, 0.0),
            (1.0 / 3.0, 0x8000 + 10_922, third),
            (-1.0 / 3.0, 0x8000 - 10_922, -third),
            (0.000_01, 0x8000, 0.0),
        ];
        for (command, code, set) in cases {
            let [.., high, low] = i32::to_be_bytes(code);
            let mut bus = Mock::new(&[
                Transaction::transaction_start(),
                Transaction::write_vec(vec![0, high, low]),
                Transaction::transaction_end(),
            ]);
            assert_eq!(
                DacValve::new(bus.clone()).drive(command),
                Ok(set),
                "command {command}"
            );
            bus.done();
        }
    }

    #[test]
    fn a_bus_error_is_passed_on() {
        assert_eq!(
            DacValve::new(super::super::DeadBus).safe(),
            Err(ErrorKind::Overrun)
        );
    }
}
