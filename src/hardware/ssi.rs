//! Absolute encoder with a synchronous serial interface.

use embedded_hal::spi::{Operation, SpiDevice};

use super::PositionSensor;

/// How the encoder writes the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SsiCode {
    /// Plain binary.
    Binary,
    /// Reflected binary: neighbours differ in one bit.
    Gray,
}

/// The frame of an encoder, from its data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SsiFormat {
    /// Bits of the position, 1 to 29; 24 for most linear transducers.
    pub bits: u8,
    /// Code of the position.
    pub code: SsiCode,
    /// Whether an alarm bit (1 = fault) follows the position.
    pub alarm: bool,
    /// Whether a bit of even parity over everything before it ends the frame.
    pub parity: bool,
}

/// Why a frame was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SsiError<E> {
    /// The bus failed.
    Bus(E),
    /// The data line was low before the frame, since the encoder is still in its pause or not
    /// connected; or high in every bit, as that of a receiver without a signal.
    NotReady,
    /// The encoder reports a fault.
    Alarm,
    /// The parity is odd.
    Parity,
}

/// An SSI encoder on a bus without chip select (wire the clock and the data line only).
///
/// The bus must idle high and sample on the falling edge (SPI mode 2). The first falling edge
/// latches the position, the encoder then shifts out a bit on each rising edge; so the first
/// sampled bit is the idle level, always high, and the position begins with the second. Four bytes
/// are read in one transaction: 32 clocks, 64 us at 500 kHz.
#[derive(Debug)]
pub struct SsiEncoder<SPI> {
    spi: SPI,
    format: SsiFormat,
}

impl<SPI: SpiDevice> SsiEncoder<SPI> {
    /// An encoder with frames of `format`; `None` when the position does not fit (1 to 29 bits).
    pub fn new(spi: SPI, format: SsiFormat) -> Option<Self> {
        (1..=29)
            .contains(&format.bits)
            .then_some(Self { spi, format })
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }
}

impl<SPI: SpiDevice> PositionSensor for SsiEncoder<SPI> {
    type Error = SsiError<SPI::Error>;

    fn counts(&mut self) -> Result<i32, Self::Error> {
        let mut bytes = [0; 4];
        self.spi
            .transaction(&mut [Operation::Read(&mut bytes)])
            .map_err(SsiError::Bus)?;
        let frame = u32::from_be_bytes(bytes);
        // An encoder takes the line down behind its last bit; receivers of RS-422 take it up where
        // no encoder is, and ones pass for a position without an alarm bit, and for even parity.
        if frame >> 31 == 0 || frame == u32::MAX {
            return Err(SsiError::NotReady);
        }
        let SsiFormat {
            bits,
            code,
            alarm,
            parity,
        } = self.format;
        let length = u32::from(bits) + u32::from(alarm) + u32::from(parity);
        let frame = (frame << 1) >> (32 - length);
        if parity && frame.count_ones() % 2 == 1 {
            return Err(SsiError::Parity);
        }
        let frame = frame >> u32::from(parity);
        if alarm && frame & 1 == 1 {
            return Err(SsiError::Alarm);
        }
        let position = frame >> u32::from(alarm);
        let position = match code {
            SsiCode::Binary => position,
            SsiCode::Gray => binary(position),
        };
        Ok(position.cast_signed())
    }
}

/// The number behind a reflected code: every bit is the parity of the bits from the top down to it.
const fn binary(gray: u32) -> u32 {
    let mut value = gray;
    value ^= value >> 16;
    value ^= value >> 8;
    value ^= value >> 4;
    value ^= value >> 2;
    value ^ (value >> 1)
}

#[cfg(test)]
mod tests {
    use embedded_hal::spi::ErrorKind;
    use embedded_hal_mock::eh1::spi::{Mock, Transaction};

    use super::*;

    const LINEAR: SsiFormat = SsiFormat {
        bits: 24,
        code: SsiCode::Gray,
        alarm: true,
        parity: true,
    };

    /// One reading of the frame with the bits of `frame` after the idle bit.
    fn read(format: SsiFormat, word: u32) -> Result<i32, SsiError<ErrorKind>> {
        let mut bus = Mock::new(&[
            Transaction::transaction_start(),
            Transaction::read_vec(word.to_be_bytes().into()),
            Transaction::transaction_end(),
        ]);
        let mut encoder = SsiEncoder::new(bus.clone(), format).expect("a format");
        let counts = encoder.counts();
        bus.done();
        counts
    }

    /// Idle bit, gray position, alarm, even parity, then the line low.
    fn frame(position: u32, alarm: u32) -> u32 {
        let body = ((position ^ (position >> 1)) << 1) | alarm;
        let body = (body << 1) | (body.count_ones() & 1);
        (1 << 31) | (body << (31 - 26))
    }

    #[test]
    fn every_kind_of_position_is_read() {
        for position in [
            0, 1, 2, 0x55_5555, 0xAA_AAAA, 0x80_0000, 0xFF_FFFF, 12_345_678,
        ] {
            assert_eq!(read(LINEAR, frame(position, 0)), Ok(position.cast_signed()));
        }
    }

    #[test]
    fn a_binary_frame_without_checks_is_read() {
        let format = SsiFormat {
            bits: 24,
            code: SsiCode::Binary,
            alarm: false,
            parity: false,
        };
        assert_eq!(
            read(format, (1 << 31) | (0xABCDEF << 7) | 0x7F),
            Ok(0xABCDEF)
        );
        let longest = SsiFormat {
            bits: 29,
            code: SsiCode::Binary,
            alarm: true,
            parity: true,
        };
        assert_eq!(
            read(longest, (1 << 31) | (0x1234_5678 << 2) | 1),
            Ok(0x1234_5678),
            "13 ones and the parity"
        );
    }

    #[test]
    fn faults_are_errors() {
        assert_eq!(read(LINEAR, frame(77, 1)), Err(SsiError::Alarm));
        assert_eq!(
            read(LINEAR, frame(77, 0) & !(1 << 31)),
            Err(SsiError::NotReady)
        );
        assert_eq!(
            read(LINEAR, 0),
            Err(SsiError::NotReady),
            "a wire that is broken"
        );
        // Every single wrong bit of position, alarm or parity.
        for bit in 5..31 {
            assert_eq!(
                read(LINEAR, frame(0x12_3456, 0) ^ (1 << bit)),
                Err(SsiError::Parity),
                "bit {bit}"
            );
        }
    }

    #[test]
    fn a_line_that_stands_still_is_no_position_in_any_format() {
        for bits in 1..=29 {
            for (alarm, parity) in [(false, false), (false, true), (true, false), (true, true)] {
                for code in [SsiCode::Binary, SsiCode::Gray] {
                    let format = SsiFormat {
                        bits,
                        code,
                        alarm,
                        parity,
                    };
                    for line in [0, u32::MAX] {
                        assert_eq!(read(format, line), Err(SsiError::NotReady), "{format:?}");
                    }
                }
            }
        }
        // The last position of a travel is one.
        let plain = SsiFormat {
            alarm: false,
            parity: false,
            code: SsiCode::Binary,
            ..LINEAR
        };
        assert_eq!(read(plain, 0xFFFF_FF80), Ok(0xFF_FFFF));
    }

    #[test]
    fn a_bus_error_is_passed_on() {
        let mut encoder = SsiEncoder::new(super::super::DeadBus, LINEAR).expect("a format");
        assert_eq!(encoder.counts(), Err(SsiError::Bus(ErrorKind::Overrun)));
    }

    #[test]
    fn a_position_that_does_not_fit_is_refused() {
        let mut bus = Mock::new(&[]);
        for bits in [0, 30] {
            assert!(SsiEncoder::new(bus.clone(), SsiFormat { bits, ..LINEAR }).is_none());
        }
        bus.done();
    }
}
