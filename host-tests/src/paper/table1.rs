//! The 19 conditions of the paper's Table 1 with the figures printed there.
//!
//! Source: K. Janiszowski, "Identification of low-order continuous-time models via discrete-time
//! trends of measurements", Table 1, parts I and II. Table 2 of the same paper suggests that the
//! heads of the columns C and xi are swapped in print; the printed order is kept here.

use crate::signals::noise::{Condition, Reading};

/// Printed figures of one scheme in one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// Error under the head "C" \[%\].
    pub c_pct: f64,
    /// Error under the head "omega0" \[%\].
    pub omega0_pct: f64,
    /// Error under the head "xi" \[%\].
    pub xi_pct: f64,
    /// CONV, as defined by the paper (its definition is lost).
    pub conv: f64,
    /// Settling time `T_ss` \[ms\].
    pub tss_ms: f64,
}

/// What a row varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Varied {
    /// Drift `w`.
    Drift,
    /// White noise `eta`.
    Noise,
    /// Resolution `eps`.
    Resolution,
    /// Sampling interval.
    Sampling,
}

impl Varied {
    /// Name in tables: drift, noise, resolution or sampling.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drift => "drift",
            Self::Noise => "noise",
            Self::Resolution => "resolution",
            Self::Sampling => "sampling",
        }
    }
}

/// One row of Table 1: a condition and the two schemes' printed figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What the block of this row varies.
    pub varied: Varied,
    w_um: f64,
    eta_um: f64,
    eps_um: f64,
    dt_ms: f64,
    /// Printed noise to signal \[%\].
    pub ns_pct: f64,
    /// Printed figures of Goodwin's scheme.
    pub goodwin: Printed,
    /// Printed figures of the modified Tustin scheme.
    pub tustin: Printed,
}

impl Row {
    /// The condition of the row in a reading.
    pub fn condition(&self, reading: Reading) -> Condition {
        Condition {
            w_um: self.w_um,
            eta_um: self.eta_um,
            eps_um: self.eps_um,
            dt_ms: self.dt_ms,
            ns_pct: self.ns_pct,
            reading,
        }
    }
}

const fn row(varied: Varied, widths: [f64; 5], goodwin: [f64; 5], tustin: [f64; 5]) -> Row {
    Row {
        varied,
        w_um: widths[0],
        eta_um: widths[1],
        eps_um: widths[2],
        dt_ms: widths[3],
        ns_pct: widths[4],
        goodwin: printed(goodwin),
        tustin: printed(tustin),
    }
}

const fn printed(p: [f64; 5]) -> Printed {
    Printed {
        c_pct: p[0],
        omega0_pct: p[1],
        xi_pct: p[2],
        conv: p[3] * 1e-3,
        tss_ms: p[4],
    }
}

/// The rows of Table 1 in the order of print: w, eta, eps \[um\], interval \[ms\], N/S \[%\]; then
/// per scheme the errors of C, omega0, xi \[%\], CONV in thousandths and T_ss \[ms\].
#[rustfmt::skip]
pub const TABLE1: [Row; 19] = [
    row(Varied::Drift, [100.0, 1.0, 2.0, 1.0, 0.63], [5.9, 0.42, 0.75, 0.166, 93.0], [0.23, 0.17, 0.49, 0.100, 89.0]),
    row(Varied::Drift, [1000.0, 1.0, 2.0, 1.0, 4.46], [6.1, 0.42, 0.77, 0.216, 97.0], [0.24, 0.19, 0.51, 0.179, 97.0]),
    row(Varied::Drift, [2000.0, 1.0, 2.0, 1.0, 8.79], [8.1, 0.34, 0.35, 1.47, 132.0], [0.1, 0.59, 0.69, 1.53, 133.0]),
    row(Varied::Drift, [5000.0, 1.0, 2.0, 1.0, 21.75], [59.2, 2.49, 11.1, 6.17, 324.0], [6.6, 10.4, 3.5, 8.16, 308.0]),
    row(Varied::Drift, [10000.0, 1.0, 2.0, 1.0, 43.48], [184.5, 2.55, 39.4, 9.10, 356.0], [22.9, 40.3, 10.7, 18.2, 409.0]),
    row(Varied::Noise, [100.0, 10.0, 2.0, 1.0, 1.04], [6.3, 0.39, 0.70, 0.48, 101.0], [0.19, 0.23, 0.54, 0.47, 106.0]),
    row(Varied::Noise, [100.0, 100.0, 2.0, 1.0, 8.35], [40.1, 4.22, 7.53, 3.95, 228.0], [2.01, 3.27, 1.53, 4.62, 171.0]),
    row(Varied::Noise, [100.0, 200.0, 2.0, 1.0, 16.72], [138.1, 16.3, 30.8, 6.29, 317.0], [8.1, 12.2, 4.11, 9.56, 299.0]),
    row(Varied::Noise, [100.0, 500.0, 2.0, 1.0, 41.78], [591.2, 55.3, 137.7, 12.56, 422.0], [37.6, 72.2, 17.6, 28.46, 466.0]),
    row(Varied::Resolution, [100.0, 10.0, 5.0, 1.0, 1.22], [6.3, 0.39, 0.70, 0.58, 105.0], [0.19, 0.24, 0.54, 0.52, 109.0]),
    row(Varied::Resolution, [100.0, 10.0, 10.0, 1.0, 1.97], [6.6, 0.34, 0.61, 0.64, 107.0], [0.18, 0.25, 0.53, 0.64, 113.0]),
    row(Varied::Resolution, [100.0, 10.0, 20.0, 1.0, 3.49], [7.73, 0.21, 0.34, 1.03, 125.0], [0.12, 0.36, 0.56, 1.06, 127.0]),
    row(Varied::Resolution, [100.0, 10.0, 50.0, 1.0, 8.73], [15.55, 0.88, 1.63, 2.04, 144.0], [0.43, 1.16, 0.81, 2.28, 144.0]),
    row(Varied::Resolution, [100.0, 10.0, 100.0, 1.0, 17.03], [42.2, 4.11, 7.71, 4.02, 234.0], [2.33, 3.83, 1.88, 4.90, 183.0]),
    row(Varied::Sampling, [100.0, 10.0, 10.0, 0.25, 2.06], [110.6, 25.3, 22.1, 15.8, 164.0], [1.88, 3.63, 0.62, 18.9, 172.0]),
    row(Varied::Sampling, [100.0, 10.0, 10.0, 0.5, 2.05], [31.1, 11.3, 7.61, 6.64, 133.0], [0.2, 1.63, 0.25, 6.95, 134.0]),
    row(Varied::Sampling, [100.0, 10.0, 10.0, 1.0, 1.97], [6.62, 0.34, 0.61, 0.64, 107.0], [0.18, 0.25, 0.53, 0.64, 113.0]),
    row(Varied::Sampling, [100.0, 10.0, 10.0, 2.0, 1.98], [10.2, 1.0, 2.53, 1.07, 147.0], [0.36, 0.80, 1.98, 0.67, 144.0]),
    row(Varied::Sampling, [100.0, 10.0, 10.0, 5.0, 1.97], [38.6, 2.90, 12.46, 0.14, 280.0], [15.25, 1.73, 8.65, 0.15, 179.0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_have_their_rows_and_the_shared_condition_agrees() {
        let count = |v| TABLE1.iter().filter(|r| r.varied == v).count();
        assert_eq!(
            [
                Varied::Drift,
                Varied::Noise,
                Varied::Resolution,
                Varied::Sampling
            ]
            .map(count),
            [5, 4, 5, 5]
        );
        // w = 100, eta = 10, eps = 10 um at 1 ms stands in two blocks of the paper.
        let shared: Vec<&Row> = TABLE1
            .iter()
            .filter(|r| (r.w_um, r.eta_um, r.eps_um, r.dt_ms) == (100.0, 10.0, 10.0, 1.0))
            .collect();
        assert_eq!(shared.len(), 2);
        assert_eq!(shared[0].tustin, shared[1].tustin);
    }

    #[test]
    fn a_row_read_in_print() {
        let r = &TABLE1[8];
        assert_eq!(
            (r.varied, r.eta_um, r.ns_pct),
            (Varied::Noise, 500.0, 41.78)
        );
        assert_eq!(
            (r.tustin.c_pct, r.tustin.omega0_pct, r.tustin.xi_pct),
            (37.6, 72.2, 17.6)
        );
        assert_eq!(r.goodwin.tss_ms, 422.0);
        assert_eq!(r.condition(Reading::Relative).ns_pct, 41.78);
    }
}
