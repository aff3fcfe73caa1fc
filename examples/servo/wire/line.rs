//! What the wire runs over.

/// A line as the slot sees it. Neither direction waits.
pub(crate) trait Line {
    /// The next byte that came in.
    fn receive(&mut self) -> Option<u8>;

    /// Takes as many bytes as there is room for, and leaves the others.
    fn send(&mut self, bytes: impl Iterator<Item = u8>);
}
