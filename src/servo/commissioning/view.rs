//! Which part of the record is read, and how.

/// Largest rate of a correction times the spacing of the points.
pub(crate) const STEP_MAX: f32 = 0.3;

/// What is read of the record, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    /// First point, and the one after the last.
    pub(crate) begin: usize,
    pub(crate) end: usize,
    /// Spacing in s.
    pub(crate) time: f32,
    pub(crate) rest_velocity: f32,
    /// Sign of the valve.
    pub(crate) sign: f32,
}

impl View {
    /// Nothing.
    pub(crate) const EMPTY: Self = Self {
        begin: 0,
        end: 0,
        time: 1.0,
        rest_velocity: 0.0,
        sign: 1.0,
    };
}
