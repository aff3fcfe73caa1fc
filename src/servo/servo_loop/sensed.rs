//! The newest reading of the sensor.

/// The newest position, and how many readings in a row have failed.
#[derive(Debug, Clone)]
pub(crate) struct Sensed {
    code: i32,
    /// Position as the loop takes it, in units of y.
    pub(crate) position: f32,
    /// Whether there was a position.
    pub(crate) begun: bool,
    /// Failed readings in a row.
    pub(crate) errors: u32,
    /// Failed readings in a row that stop the axis.
    pub(crate) errors_max: u32,
}

impl Sensed {
    /// No reading yet; so many failed ones in a row stop the axis.
    pub(crate) const fn new(errors_max: u32) -> Self {
        Self {
            code: 0,
            position: 0.0,
            begun: false,
            errors: 0,
            errors_max,
        }
    }

    /// Counts a reading, `None` for one that failed; whether it is the code of the one before.
    #[inline]
    pub(crate) fn count(&mut self, code: Option<i32>) -> bool {
        let Some(code) = code else {
            self.errors = self.errors.saturating_add(1);
            return self.begun;
        };
        self.errors = 0;
        let same = self.begun && code == self.code;
        self.code = code;
        same
    }

    /// Whether more readings in a row have failed than are bridged.
    pub(crate) const fn is_lost(&self) -> bool {
        self.errors >= self.errors_max
    }
}
