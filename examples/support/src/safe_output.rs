//! The valve to its middle by registers alone, whatever state the drivers are in (STM32F405/407,
//! RM0090).
//!
//! For handlers that do not return, and before a restart. Before the ports are set up it has no
//! effect, and the valve is at rest by its hardware.

use crate::registers::Registers;

/// TIM4: compare value of channel 1, and event generation.
const TIM4_CCR1: u32 = 0x4000_0834;
const TIM4_EGR: u32 = 0x4000_0814;

/// SPI3: status and data.
const SPI3_SR: u32 = 0x4000_3C08;
const SPI3_DR: u32 = 0x4000_3C0C;

/// Port A: set (low half) and reset (high half) of its pins.
const GPIOA_BSRR: u32 = 0x4002_0018;

/// The select line of the converter: PA15.
const SELECT: u32 = 15;

/// Transmit buffer empty, and busy.
const TXE: u32 = 1 << 1;
const BSY: u32 = 1 << 7;

/// Bounds a wait for the bus of the converter: 24 bits take less than 3 us.
const PATIENCE: u32 = 2000;

/// No pulse, from now on and not from the end of the period.
pub fn stop_pulse(registers: &mut impl Registers) {
    registers.write(TIM4_CCR1, 0);
    // The compare value counts from the next period on; an update begins it.
    registers.write(TIM4_EGR, 1);
}

/// The middle code into the converter, in a frame of its own.
pub fn middle_voltage(registers: &mut impl Registers) {
    wait(registers, |status| status & BSY == 0);
    // A new falling edge of the select line begins a frame, whatever was sent of the last one.
    registers.write(GPIOA_BSRR, 1 << SELECT);
    registers.write(GPIOA_BSRR, 1 << (16 + SELECT));
    // Normal operation, then the middle code.
    for byte in [0, 0x80, 0] {
        wait(registers, |status| status & TXE != 0);
        registers.write_byte(SPI3_DR, byte);
    }
    wait(registers, |status| status & TXE != 0);
    wait(registers, |status| status & BSY == 0);
    registers.write(GPIOA_BSRR, 1 << SELECT);
}

fn wait(registers: &mut impl Registers, ready: impl Fn(u32) -> bool) {
    let _ = (0..PATIENCE).find(|_| ready(registers.read(SPI3_SR)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Timer with a buffered compare value; bus with a buffer and a shift register of which a byte
    /// takes some looks at the status; converter that takes the last 24 bits between two edges of
    /// its select line.
    #[derive(Clone, Debug, Default)]
    struct Double {
        compare: u32,
        compare_in_force: u32,
        /// Set when the converter is not selected.
        released: bool,
        buffer: Option<u8>,
        shifting: Option<u8>,
        /// Looks until the byte in the shift register is sent.
        left: u32,
        looks_per_byte: u32,
        received: u32,
        bits: u32,
        code: Option<u32>,
        /// Bytes that were written to a full buffer.
        overwritten: u32,
    }

    impl Double {
        fn step(&mut self) {
            if self.left > 0 {
                self.left -= 1;
            }
            if self.left == 0 {
                if let Some(byte) = self.shifting.take()
                    && !self.released
                {
                    self.received = (self.received << 8) | u32::from(byte);
                    self.bits += 8;
                }
                self.shifting = self.buffer.take();
                if self.shifting.is_some() {
                    self.left = self.looks_per_byte;
                }
            }
        }
    }

    impl Registers for Double {
        fn read(&mut self, address: u32) -> u32 {
            assert_eq!(address, SPI3_SR);
            self.step();
            let busy = self.shifting.is_some() || self.buffer.is_some();
            (if busy { BSY } else { 0 }) | (if self.buffer.is_none() { TXE } else { 0 })
        }

        fn write(&mut self, address: u32, word: u32) {
            match (address, word) {
                (TIM4_CCR1, value) => self.compare = value,
                (TIM4_EGR, 1) => self.compare_in_force = self.compare,
                (GPIOA_BSRR, 0x0000_8000) => {
                    if !self.released && self.bits >= 24 {
                        self.code = Some(self.received & 0xFF_FFFF);
                    }
                    self.released = true;
                }
                (GPIOA_BSRR, 0x8000_0000) => {
                    self.released = false;
                    (self.received, self.bits) = (0, 0);
                }
                other => panic!("a register that nobody asked for: {other:x?}"),
            }
        }

        fn write_byte(&mut self, address: u32, byte: u8) {
            assert_eq!(address, SPI3_DR);
            if self.buffer.is_some() {
                self.overwritten += 1;
            }
            self.buffer = Some(byte);
        }
    }

    #[test]
    fn the_pulse_ends_within_its_period() {
        let mut chip = Double {
            compare: 4000,
            compare_in_force: 4000,
            ..Double::default()
        };
        stop_pulse(&mut chip);
        assert_eq!((chip.compare, chip.compare_in_force), (0, 0));
    }

    #[test]
    fn the_converter_gets_its_middle_code_whatever_was_under_way() {
        for looks_per_byte in [1, 3, 100] {
            for buffer in [None, Some(0xAA)] {
                for shifting in [None, Some(0x55)] {
                    for (released, bits) in
                        [(true, 0), (false, 0), (false, 8), (false, 16), (false, 24)]
                    {
                        let mut chip = Double {
                            buffer,
                            shifting,
                            released,
                            bits,
                            received: 0x00FF_FFFF,
                            looks_per_byte,
                            left: looks_per_byte,
                            ..Double::default()
                        };
                        middle_voltage(&mut chip);
                        assert_eq!(
                            chip.code,
                            Some(0x00_8000),
                            "{looks_per_byte} {buffer:?} {shifting:?} {bits}"
                        );
                        assert!(chip.released && chip.overwritten == 0);
                    }
                }
            }
        }
    }

    #[test]
    fn a_dead_bus_is_waited_for_with_an_end() {
        let mut chip = Double {
            shifting: Some(1),
            buffer: Some(2),
            looks_per_byte: u32::MAX,
            left: u32::MAX,
            ..Double::default()
        };
        middle_voltage(&mut chip);
        assert_eq!(chip.code, None);
    }
}
