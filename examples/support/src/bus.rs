//! A serial bus with one device on it.

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::{ErrorType, Operation, SpiBus, SpiDevice};

/// A bus whose device needs no select line, or has it in `select`, low while it is spoken to.
pub struct Device<B, P> {
    /// The bus.
    pub bus: B,
    /// The line; a pin of the chip, which cannot fail.
    pub select: Option<P>,
}

impl<B: SpiBus, P> ErrorType for Device<B, P> {
    type Error = B::Error;
}

impl<B: SpiBus, P: OutputPin> SpiDevice for Device<B, P> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        let _ = self.select.as_mut().map(OutputPin::set_low);
        let result = operations
            .iter_mut()
            .try_for_each(|operation| match operation {
                Operation::Read(words) => self.bus.read(words),
                Operation::Write(words) => self.bus.write(words),
                Operation::Transfer(read, write) => self.bus.transfer(read, write),
                Operation::TransferInPlace(words) => self.bus.transfer_in_place(words),
                // No caller here needs a pause.
                Operation::DelayNs(_) => Ok(()),
            });
        let flushed = self.bus.flush();
        let _ = self.select.as_mut().map(OutputPin::set_high);
        result.and(flushed)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use core::cell::RefCell;
    use core::convert::Infallible;
    use std::vec::Vec;

    use embedded_hal::digital;
    use embedded_hal::spi::{Error, ErrorKind};
    use trendid::hardware::{DacValve, PositionSensor, SsiCode, SsiEncoder, SsiFormat, Valve};

    use super::*;

    /// What happens on the lines, in its order.
    #[derive(Clone, Debug, PartialEq)]
    enum Line {
        Select(bool),
        Read(usize),
        Write(Vec<u8>),
        Flush,
    }

    /// The registers of a bus: what it answers, and whether it fails.
    struct Double<'a> {
        lines: &'a RefCell<Vec<Line>>,
        answer: [u8; 4],
        fails: [bool; 2],
    }

    #[derive(Debug)]
    struct Broken;

    impl Error for Broken {
        fn kind(&self) -> ErrorKind {
            ErrorKind::Overrun
        }
    }

    impl Double<'_> {
        fn end(&self, fails: bool) -> Result<(), Broken> {
            if fails { Err(Broken) } else { Ok(()) }
        }
    }

    impl ErrorType for Double<'_> {
        type Error = Broken;
    }

    impl SpiBus for Double<'_> {
        fn read(&mut self, words: &mut [u8]) -> Result<(), Broken> {
            self.lines.borrow_mut().push(Line::Read(words.len()));
            words.copy_from_slice(&self.answer[..words.len()]);
            self.end(self.fails[0])
        }

        fn write(&mut self, words: &[u8]) -> Result<(), Broken> {
            self.lines.borrow_mut().push(Line::Write(words.to_vec()));
            self.end(self.fails[0])
        }

        fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Broken> {
            self.write(write)?;
            self.read(read)
        }

        fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Broken> {
            self.read(words)
        }

        fn flush(&mut self) -> Result<(), Broken> {
            self.lines.borrow_mut().push(Line::Flush);
            self.end(self.fails[1])
        }
    }

    struct Select<'a>(&'a RefCell<Vec<Line>>);

    impl digital::ErrorType for Select<'_> {
        type Error = Infallible;
    }

    impl OutputPin for Select<'_> {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.0.borrow_mut().push(Line::Select(true));
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.0.borrow_mut().push(Line::Select(false));
            Ok(())
        }
    }

    #[test]
    fn the_converter_takes_its_code_when_everything_was_sent() {
        let lines = RefCell::new(Vec::new());
        for fails in [[false, false], [true, false], [false, true]] {
            lines.borrow_mut().clear();
            let bus = Double {
                lines: &lines,
                answer: [0; 4],
                fails,
            };
            let select = Some(Select(&lines));
            let set = DacValve::new(Device { bus, select }).drive(1.0);
            assert_eq!(set.is_ok(), fails == [false, false]);
            // The line is released behind the last bit, whatever fails: the converter must not take
            // the next code for the rest of this one.
            let expected = [
                Line::Select(true),
                Line::Write([0, 0xFF, 0xFF].to_vec()),
                Line::Flush,
                Line::Select(false),
            ];
            assert_eq!(lines.borrow()[..], expected);
        }
    }

    #[test]
    fn the_encoder_of_the_board_is_read_through_its_bus() {
        let lines = RefCell::new(Vec::new());
        // The transducer of the wiring table, at code 5: idle bit, 24 bits Gray (5 is 7), alarm,
        // parity of an odd number of ones.
        let format = SsiFormat {
            bits: 24,
            code: SsiCode::Gray,
            alarm: true,
            parity: true,
        };
        let frame = (1_u32 << 31) | (0b111 << 7) | (1 << 5);
        for (fails, frame, counts) in [
            (false, frame, Some(5)),
            (false, frame ^ (1 << 7), None),
            (true, frame, None),
        ] {
            lines.borrow_mut().clear();
            let bus = Double {
                lines: &lines,
                answer: frame.to_be_bytes(),
                fails: [fails, false],
            };
            let device = Device {
                bus,
                select: None::<Select<'_>>,
            };
            let mut encoder = SsiEncoder::new(device, format).expect("a format");
            assert_eq!(encoder.counts().ok(), counts, "{frame:032b}");
            assert_eq!(lines.borrow()[..], [Line::Read(4), Line::Flush]);
        }
    }
}
