//! Choices and numbers out of bytes.

/// The bytes that are left; behind their end come zeros.
#[derive(Debug)]
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// All of them.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Whether none is left.
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The rest.
    pub const fn rest(self) -> &'a [u8] {
        self.0
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().unwrap_or((&0, &[]));
        self.0 = rest;
        *first
    }

    /// The next `N` bytes.
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    /// One of `count` choices.
    pub fn choice(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    /// A number by its bits: also NaN, infinity, subnormal.
    pub fn any(&mut self) -> f32 {
        f32::from_bits(u32::from_le_bytes(self.take()))
    }

    /// A share from -1 to 1.
    pub fn share(&mut self) -> f32 {
        f32::from(i16::from_le_bytes(self.take())) / 32767.0
    }

    /// A positive number over many decades: `10^-decades ..= 10^decades`.
    pub fn decades(&mut self, decades: f32) -> f32 {
        10.0_f32.powf(decades * self.share())
    }

    /// A signal of a usual size, or now and then any number.
    pub fn signal(&mut self, size: f32) -> f32 {
        match self.byte() {
            0..=239 => size * self.share(),
            240..=250 => size * self.share() * 1e3,
            _ => self.any(),
        }
    }
}
