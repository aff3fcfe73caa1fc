//! The filter of a regression, a spacing at a time.

/// A filter rate^3/(s + rate)^3 of a signal and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Filter {
    pub(super) state: [f32; 3],
}

impl Filter {
    pub(super) const AT_REST: Self = Self { state: [0.0; 3] };

    /// Third derivative of the output under an input.
    #[inline]
    pub(super) fn highest([z, z1, z2]: [f32; 3], input: f32, rate: f32) -> f32 {
        rate * (rate * (rate * (input - z) - 3.0 * z1) - 3.0 * z2)
    }

    /// One spacing on under a held input.
    #[inline]
    pub(super) fn advance(&mut self, input: f32, by: &Spacing) {
        let [z, z1, z2] = self.state;
        let on = |k: usize| {
            let [a, a1, a2] = by.state[k];
            a * z + a1 * z1 + a2 * z2 + by.input[k] * input
        };
        self.state = [on(0), on(1), on(2)];
    }
}

/// What a filter becomes over a spacing: its state by its state, and by a held input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spacing {
    state: [[f32; 3]; 3],
    input: [f32; 3],
}

impl Spacing {
    pub(super) const NONE: Self = Self {
        state: [[0.0; 3]; 3],
        input: [0.0; 3],
    };

    /// Of filters with this rate over this time. Cost: some 200 instructions.
    pub(super) fn new(rate: f32, time: f32) -> Self {
        let of = |state: [f32; 3], input: f32| Self::series(state, input, rate, time);
        let [z, z1, z2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let [z, z1, z2] = [z, z1, z2].map(|unit| of(unit, 0.0));
        Self {
            state: core::array::from_fn(|k| [z[k], z1[k], z2[k]]),
            input: of([0.0; 3], 1.0),
        }
    }

    /// A state after a time under a held input: Taylor series to the fifth derivative.
    fn series([z, z1, z2]: [f32; 3], input: f32, rate: f32, time: f32) -> [f32; 3] {
        let z3 = Filter::highest([z, z1, z2], input, rate);
        let z4 = Filter::highest([z1, z2, z3], 0.0, rate);
        let z5 = Filter::highest([z2, z3, z4], 0.0, rate);
        let (h2, h3, h4) = (0.5 * time, time * (1.0 / 3.0), 0.25 * time);
        [
            z + time * (z1 + h2 * (z2 + h3 * (z3 + h4 * (z4 + 0.2 * time * z5)))),
            z1 + time * (z2 + h2 * (z3 + h3 * (z4 + h4 * z5))),
            z2 + time * (z3 + h2 * (z4 + h3 * z5)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_is_three_equal_poles() {
        // Step response of rate^3/(s + rate)^3: 1 - e^-x (1 + x + x^2/2).
        // A spacing of 0.06/rate: what the series leave out is 4e-5 of the second derivative.
        let (rate, time) = (15.0, 4e-3);
        let spacing = Spacing::new(rate, time);
        let mut filter = Filter::AT_REST;
        for k in 1..=200 {
            filter.advance(2.0, &spacing);
            let x = rate * time * k as f32;
            let e = libm::expf(-x);
            let expected = [
                2.0 * (1.0 - e * (1.0 + x + 0.5 * x * x)),
                2.0 * rate * e * 0.5 * x * x,
                2.0 * rate * rate * e * (x - 0.5 * x * x),
            ];
            for (j, (found, expected)) in filter.state.iter().zip(expected).enumerate() {
                let size = 2.0 * libm::powf(rate, j as f32);
                assert!(
                    (found - expected).abs() < 1e-4 * size,
                    "{k} {j}: {found} {expected}"
                );
            }
            let third = Filter::highest(filter.state, 2.0, rate);
            let expected = 2.0 * rate * rate * rate * e * (1.0 - 2.0 * x + 0.5 * x * x);
            assert!((third - expected).abs() < 1e-3 * 2.0 * rate * rate * rate);
        }
    }
}
