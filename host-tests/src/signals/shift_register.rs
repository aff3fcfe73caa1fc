//! Maximum-length shift registers: binary noise.

/// Feedback taps of primitive polynomials for registers of 3 to 16 bits (Xilinx application note
/// XAPP052, table 3).
const TAPS: [&[u32]; 14] = [
    &[3, 2],
    &[4, 3],
    &[5, 3],
    &[6, 5],
    &[7, 6],
    &[8, 6, 5, 4],
    &[9, 5],
    &[10, 7],
    &[11, 9],
    &[12, 6, 4, 1],
    &[13, 4, 3, 1],
    &[14, 5, 3, 1],
    &[15, 14],
    &[16, 15, 13, 4],
];

/// Maximum-length shift register of 3 to 16 bits: a binary sequence of period `2^bits - 1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShiftRegister {
    state: u32,
    bits: u32,
}

impl ShiftRegister {
    /// A register of `bits` cells with the given content; content zero is replaced by one.
    ///
    /// # Panics
    /// When `bits` is not in `3..=16`.
    pub fn new(bits: u32, content: u32) -> Self {
        assert!((3..=16).contains(&bits), "{bits} bits are not in 3..=16");
        let state = content & ((1 << bits) - 1);
        Self {
            state: state.max(1),
            bits,
        }
    }

    /// Number of bits after which the sequence repeats, `2^bits - 1`.
    pub fn period(&self) -> u32 {
        (1 << self.bits) - 1
    }
}

impl Iterator for ShiftRegister {
    type Item = bool;

    fn next(&mut self) -> Option<bool> {
        let out = self.state >> (self.bits - 1) & 1 == 1;
        let feedback = TAPS[self.bits as usize - 3]
            .iter()
            .fold(0, |sum, tap| sum ^ (self.state >> (tap - 1)));
        self.state = (self.state << 1 | feedback & 1) & ((1 << self.bits) - 1);
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_have_the_full_period_and_one_surplus_bit() {
        for bits in 3..=16 {
            let start = ShiftRegister::new(bits, 1);
            let mut register = start;
            let mut ones = 0;
            for k in 1..=start.period() {
                ones += u32::from(register.next() == Some(true));
                assert_eq!(register == start, k == start.period(), "{bits} bits, {k}");
            }
            assert_eq!(ones, start.period().div_ceil(2), "{bits} bits");
        }
    }
}
