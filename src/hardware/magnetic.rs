//! Angle converter on SPI with 16-bit frames, as the magnetic encoders AS5047 and AS5147 speak them.

use embedded_hal::spi::SpiDevice;

use super::PositionSensor;

/// Read command for the angle with error compensation: register 0x3FFF, read bit, even parity (AS5047P data sheet,
/// "SPI communication").
const READ_ANGLE: u16 = 0xFFFF;

const FAULT: u16 = 1 << 14;
const ANGLE: u16 = FAULT - 1;

/// Why a reading was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MagneticError<E> {
    /// The bus failed.
    Bus(E),
    /// The converter reports a fault of an earlier command or of its magnet.
    Alarm,
    /// The parity is odd.
    Parity,
}

/// An angle converter that counts whole turns: 14 bits a turn, SPI mode 1.
///
/// A converter answers in the frame after the question, so a reading is one sample old; that is one sample of delay in
/// the structure. The first reading after power-up carries no angle: call [`counts`](PositionSensor::counts) once and
/// forget the result. Turns are counted by the nearest way: valid below half a turn per sample.
#[derive(Debug)]
pub struct MagneticEncoder<SPI> {
    spi: SPI,
    counts: i32,
}

impl<SPI: SpiDevice> MagneticEncoder<SPI> {
    /// A converter whose first reading lies within half a turn of zero.
    pub fn new(spi: SPI) -> Self {
        Self { spi, counts: 0 }
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }
}

impl<SPI: SpiDevice> PositionSensor for MagneticEncoder<SPI> {
    type Error = MagneticError<SPI::Error>;

    fn counts(&mut self) -> Result<i32, Self::Error> {
        let mut frame = READ_ANGLE.to_be_bytes();
        self.spi
            .transfer_in_place(&mut frame)
            .map_err(MagneticError::Bus)?;
        let frame = u16::from_be_bytes(frame);
        if frame.count_ones() % 2 == 1 {
            return Err(MagneticError::Parity);
        }
        if frame & FAULT != 0 {
            return Err(MagneticError::Alarm);
        }
        // Two bits up, and the difference of the turn is a signed 16-bit difference with its sign in place.
        let turned = ((frame & ANGLE) << 2)
            .wrapping_sub((self.counts.cast_unsigned() << 2) as u16)
            .cast_signed()
            >> 2;
        self.counts = self.counts.wrapping_add(i32::from(turned));
        Ok(self.counts)
    }
}

#[cfg(test)]
mod tests {
    use super::super::std::{vec, vec::Vec};
    use embedded_hal::spi::ErrorKind;
    use embedded_hal_mock::eh1::spi::{Mock, Transaction};

    use super::*;

    fn read(words: &[u16]) -> Vec<Result<i32, MagneticError<ErrorKind>>> {
        let expected: Vec<_> = words
            .iter()
            .flat_map(|word| {
                [
                    Transaction::transaction_start(),
                    Transaction::transfer_in_place(vec![0xFF, 0xFF], word.to_be_bytes().into()),
                    Transaction::transaction_end(),
                ]
            })
            .collect();
        let mut bus = Mock::new(&expected);
        let mut encoder = MagneticEncoder::new(bus.clone());
        let counts = words.iter().map(|_| encoder.counts()).collect();
        bus.done();
        counts
    }

    /// The angle with its even parity.
    fn frame(angle: u16) -> u16 {
        angle | ((angle.count_ones() as u16 & 1) << 15)
    }

    #[test]
    fn turns_are_counted_in_both_directions() {
        let angles = [
            0, 5000, 10_000, 15_000, 16_383, 0, 1, 0, 16_383, 9000, 4000, 0, 12_000,
        ];
        let expected = [
            0, 5000, 10_000, 15_000, 16_383, 16_384, 16_385, 16_384, 16_383, 9000, 4000, 0, -4384,
        ];
        let words: Vec<_> = angles.map(frame).into();
        assert_eq!(read(&words), expected.map(Ok));
    }

    #[test]
    fn a_bad_frame_is_an_error_and_leaves_the_count() {
        let fault = 0x4000 | 100;
        let words = [frame(100), frame(100) ^ 1, frame(fault), frame(101)];
        assert_eq!(
            read(&words),
            [
                Ok(100),
                Err(MagneticError::Parity),
                Err(MagneticError::Alarm),
                Ok(101)
            ]
        );
    }

    #[test]
    fn a_bus_error_is_passed_on() {
        let mut encoder = MagneticEncoder::new(super::super::DeadBus);
        assert_eq!(
            encoder.counts(),
            Err(MagneticError::Bus(ErrorKind::Overrun))
        );
    }
}
