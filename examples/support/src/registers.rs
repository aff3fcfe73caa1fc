//! Registers by their address, so that what is written to a chip can be written to a double of it.

/// The registers of a chip.
pub trait Registers {
    /// Reads the word at `address`.
    fn read(&mut self, address: u32) -> u32;

    /// Writes the word at `address`.
    fn write(&mut self, address: u32, word: u32);

    /// Writes the byte at `address`.
    fn write_byte(&mut self, address: u32, byte: u8);
}
