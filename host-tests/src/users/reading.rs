//! What a user reads, beside the truth.

/// A parameter, or something read from several.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// `a1`, `b0`, `c` of the constant, `b0 sgn` of the sign of the command, `C`, `omega0`, `xi`,
    /// `delta` of the dead zone.
    pub name: String,
    /// As it was read, in the units of the user.
    pub value: f64,
    /// The truth.
    pub truth: f64,
    /// Standard deviation that was given.
    pub deviation: f64,
    /// What an error is measured by: the truth; of a constant and of a sign what a command makes.
    pub size: f64,
}

impl Quantity {
    /// A quantity whose errors are measured by its truth.
    pub fn new(name: &str, value: f64, truth: f64, deviation: f64) -> Self {
        Self {
            name: name.into(),
            value,
            truth,
            deviation,
            size: truth.abs(),
        }
    }

    /// Error over the standard deviation that was given.
    ///
    /// Infinite where there is no number; 0 behind an infinite deviation, which excludes nothing.
    pub fn error_deviations(&self) -> f64 {
        let error = self.value - self.truth;
        match (error.is_finite(), self.deviation) {
            (true, deviation) if deviation == f64::INFINITY => 0.0,
            (true, deviation) if deviation > 0.0 => error / deviation,
            _ => f64::INFINITY,
        }
    }

    /// Error over the size.
    pub fn error(&self) -> f64 {
        (self.value - self.truth) / self.size
    }

    /// Whether value and deviation are numbers, and the deviation is not 0; it may be infinite.
    pub fn is_sound(&self) -> bool {
        self.value.is_finite() && self.deviation > 0.0
    }
}

/// All that is read at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// When, in 1/w.
    pub time: f64,
    /// What; nothing where there is no estimate.
    pub quantities: Vec<Quantity>,
}

impl Reading {
    /// The quantity with the largest error in standard deviations.
    pub fn worst(&self) -> Option<&Quantity> {
        let size = |q: &&Quantity| q.error_deviations().abs();
        let quantities = self.quantities.iter();
        quantities.max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Whether an error exceeds so many standard deviations.
    pub fn exceeds(&self, deviations: f64) -> bool {
        let worst = self.worst().map(|q| q.error_deviations().abs());
        worst.is_some_and(|worst| worst > deviations)
    }

    /// Whether every deviation is finite.
    pub fn has_deviations(&self) -> bool {
        let mut quantities = self.quantities.iter();
        !self.quantities.is_empty() && quantities.all(|q| q.deviation.is_finite())
    }

    /// Whether every quantity is as near to the truth.
    pub fn within(&self, error: f64) -> bool {
        let mut quantities = self.quantities.iter();
        !self.quantities.is_empty() && quantities.all(|q| q.error().abs() <= error)
    }

    /// C, omega0 and xi alone.
    pub fn physical(&self) -> Self {
        let named = |q: &&Quantity| ["C", "omega0", "xi"].contains(&q.name.as_str());
        let quantities = self.quantities.iter().filter(named);
        Self {
            time: self.time,
            quantities: quantities.cloned().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_infinite_deviation_excludes_nothing_and_no_number_is_beyond_all() {
        let of = |value, deviation| Quantity::new("a1", value, 2.0, deviation);
        assert_eq!(of(3.0, 0.5).error_deviations(), 2.0);
        assert_eq!(of(3.0, f64::INFINITY).error_deviations(), 0.0);
        for wrong in [of(f64::NAN, 1.0), of(3.0, 0.0), of(3.0, f64::NAN)] {
            assert_eq!(wrong.error_deviations(), f64::INFINITY);
            assert!(!wrong.is_sound());
        }
        let reading = |quantities| Reading {
            time: 10.0,
            quantities,
        };
        let good = reading(vec![of(2.1, 0.5), of(1.95, f64::INFINITY)]);
        assert!(good.within(0.1) && !good.has_deviations() && !good.exceeds(1.0));
        let none = reading(vec![]);
        assert!(!none.within(0.1) && !none.has_deviations() && !none.exceeds(1.0));
    }
}
