//! What a commissioning has seen of the axis.

/// What a commissioning has seen of the axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Commissioning {
    /// Samples in a row with the same position code.
    repeated_codes: u32,
    low: f32,
    high: f32,
    /// Whether the axis moved downwards and upwards.
    directions: [bool; 2],
    failed_validations: u32,
}

impl Commissioning {
    /// A commissioning that begins at `position`.
    pub(crate) fn at(position: f32) -> Self {
        Self {
            low: position,
            high: position,
            ..Self::default()
        }
    }

    /// Takes a position and a velocity; beyond `min_speed` the axis counts as moving.
    #[inline]
    pub(crate) fn update(&mut self, y: f32, velocity: f32, min_speed: f32, same_code: bool) {
        self.directions[0] |= velocity < -min_speed;
        self.directions[1] |= velocity > min_speed;
        self.repeated_codes = if same_code {
            self.repeated_codes.saturating_add(1)
        } else {
            0
        };
        self.low = if y < self.low { y } else { self.low };
        self.high = if y > self.high { y } else { self.high };
    }

    /// Counts a failed validation; how many there are.
    pub(crate) const fn fail_validation(&mut self) -> u32 {
        self.failed_validations = self.failed_validations.saturating_add(1);
        self.failed_validations
    }

    pub(crate) const fn repeated_codes(&self) -> u32 {
        self.repeated_codes
    }

    /// Distance between the lowest and the highest position.
    pub(crate) const fn range(&self) -> f32 {
        self.high - self.low
    }

    /// Whether the axis moved both ways: a drive that obeys does.
    pub(crate) const fn is_two_way(&self) -> bool {
        self.directions[0] && self.directions[1]
    }

    /// Whether the axis moved in one direction only.
    pub(crate) const fn is_one_way(&self) -> bool {
        self.directions[0] != self.directions[1]
    }
}
