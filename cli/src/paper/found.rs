//! Table 2 as printed, and what is found beside it.

use trendid::trends::Scheme;

/// One structure of the table: m without the integrator, M parameters.
#[derive(Clone, Copy)]
pub(super) struct Size {
    pub m: usize,
    pub numerators: usize,
    /// a3, a1, a0, b2, b1, b0 and IQ as printed, per scheme; what the structure lacks is NaN.
    pub goodwin: [f64; 7],
    pub tustin: [f64; 7],
}

/// Missing part of a structure.
pub(super) const NO: f64 = f64::NAN;

/// Table 2 of the paper in the order of print.
pub(super) const SIZES: [Size; 5] = [
    Size {
        m: 1,
        numerators: 1,
        goodwin: [NO, 1.0, -3.888, NO, NO, 0.125, 324.8],
        tustin: [NO, 1.0, -4.011, NO, NO, 0.116, 340.5],
    },
    Size {
        m: 2,
        numerators: 1,
        goodwin: [NO, 21.24, 400.6, NO, NO, 0.9937, 0.1042],
        tustin: [NO, 19.95, 400.4, NO, NO, 0.9941, 0.1033],
    },
    Size {
        m: 2,
        numerators: 2,
        goodwin: [NO, 20.29, 395.7, NO, 0.00051, 0.9861, 0.1033],
        tustin: [NO, 19.95, 400.1, NO, 0.000035, 0.9935, 0.1033],
    },
    Size {
        m: 3,
        numerators: 2,
        goodwin: [0.00133, 22.25, 392.9, NO, 0.00087, 0.9761, 0.0995],
        tustin: [0.00102, 19.61, 396.7, NO, 0.000072, 0.9821, 0.1045],
    },
    Size {
        m: 3,
        numerators: 3,
        goodwin: [0.00136, 20.92, 385.8, 0.65, 0.00171, 0.9639, 0.0995],
        tustin: [0.00105, 19.58, 396.2, 0.13, 0.00031, 0.9822, 0.1054],
    },
];

/// Medians of one structure, scheme and kind of trends.
pub(super) struct Found {
    pub size: Size,
    pub scheme: Scheme,
    pub filtered: bool,
    /// As in [`Size`], then IQ by (10), then IQ of the simulated velocity.
    pub median: [f64; 8],
    /// Half the distance of the quartiles.
    pub spread: [f64; 8],
}

impl Found {
    pub(super) fn paper(&self) -> [f64; 7] {
        match self.scheme {
            Scheme::Goodwin => self.size.goodwin,
            Scheme::Tustin => self.size.tustin,
        }
    }

    pub(super) fn kind(&self) -> &'static str {
        if self.filtered { "filtered" } else { "raw" }
    }

    pub(super) fn scheme(&self) -> &'static str {
        match self.scheme {
            Scheme::Goodwin => "goodwin",
            Scheme::Tustin => "tustin",
        }
    }
}
