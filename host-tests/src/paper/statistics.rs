//! Statistics of many trials: the lines of the reproduced Table 1.

use trendid::trends::Scheme;

use crate::paper::table1::Printed;
use crate::paper::transient::Run;
use crate::paper::trial::{Method, Setting, Trial};
use crate::signals::noise::Reading;

/// The columns of the file.
pub const COLUMNS: &str = "vary,w_um,eta_um,eps_um,dt_ms,reading,scheme,filter,estimator,duration_s,seeds,ns_pct,rms_c_pct,rms_omega0_pct,rms_xi_pct,mean_c_pct,mean_omega0_pct,mean_xi_pct,med_c_pct,med_omega0_pct,med_xi_pct,bound_c_pct,bound_omega0_pct,bound_xi_pct,paper_c_pct,paper_omega0_pct,paper_xi_pct,conv,tss_med_ms,tss_p95_ms,diverged,weak";

/// One line: a setting, a method, and what came of all seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Condition and paper.
    pub setting: Setting,
    /// Who estimated.
    pub method: Method,
    /// Length of each record \[s\].
    pub duration_s: f64,
    /// Number of records.
    pub seeds: usize,
    /// Root mean square of the noise to signal ratios \[%\].
    pub ns_pct: f64,
    /// Root mean square errors of C, omega0, xi \[%\]; infinite when a run has no reading.
    pub rms_pct: [f64; 3],
    /// Means of the signed errors \[%\]: the bias.
    pub mean_pct: [f64; 3],
    /// Medians of the absolute errors \[%\].
    pub median_pct: [f64; 3],
    /// Root mean square of the bounds \[%\].
    pub bound_pct: [f64; 3],
    /// Median of CONV.
    pub conv: Option<f64>,
    /// Median of T_ss \[ms\], infinite where more than half of the runs end outside.
    pub settled_median_ms: Option<f64>,
    /// 95th percentile of T_ss \[ms\].
    pub settled_p95_ms: Option<f64>,
    /// Runs with an error above 100 % or without a reading.
    pub diverged: usize,
    /// Runs of [`Method::Instruments`] in which least squares took their place.
    pub weak: usize,
}

impl Line {
    /// The paper's figures to stand beside: of the same scheme, of Tustin beside the opponents.
    pub fn paper(&self) -> Printed {
        match self.method {
            Method::Core { scheme, .. } => self.setting.printed(scheme),
            _ => self.setting.printed(Scheme::Tustin),
        }
    }

    /// The paper's errors of C, omega0, xi \[%\], columns as printed.
    pub fn paper_pct(&self) -> [f64; 3] {
        let p = self.paper();
        [p.c_pct, p.omega0_pct, p.xi_pct]
    }

    /// What the rms errors must not exceed \[%\], infinite where nothing is asked; `None` where no
    /// figure is set.
    ///
    /// ABSOLUTE: a tenth of the paper's Tustin error or 0.1 %, whichever is larger, and
    /// 0.05, 0.08, 0.3 % for white noise of 10, 100, 500 um. RELATIVE: three times the bound in the
    /// rows of white noise; below the paper's Tustin error, where that is above 1 %, in the rows of
    /// drift and resolution.
    pub fn limit_pct(&self) -> Option<[f64; 3]> {
        let paper = self.setting.tustin;
        let paper = [paper.c_pct, paper.omega0_pct, paper.xi_pct];
        let white = matches!(self.setting.vary, "noise" | "white");
        match (self.setting.condition.reading, self.setting.vary) {
            (Reading::Absolute, _) => {
                let ceiling = match self.setting.condition.eta_um {
                    10.0 if white => 0.05,
                    100.0 if white => 0.08,
                    500.0 if white => 0.3,
                    _ => f64::INFINITY,
                };
                Some(paper.map(|p| (0.1 * p).max(0.1).min(ceiling)))
            }
            (Reading::Relative, "noise" | "white") => Some(self.bound_pct.map(|b| 3.0 * b)),
            (Reading::Relative, "drift" | "resolution") => {
                Some(paper.map(|p| if p > 1.0 { p } else { f64::INFINITY }))
            }
            (Reading::Relative, _) => None,
        }
    }

    /// Which of C, omega0, xi exceed their limit.
    pub fn beyond(&self) -> Option<[bool; 3]> {
        let limit = self.limit_pct()?;
        Some([0, 1, 2].map(|i| !(self.rms_pct[i] <= limit[i])))
    }

    /// rms over bound.
    pub fn of_bound(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.rms_pct[i] / self.bound_pct[i])
    }

    /// rms over the paper's figure.
    pub fn of_paper(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.rms_pct[i] / self.paper_pct()[i])
    }

    /// The line as in the file; what does not exist is empty, what is infinite `inf`.
    pub fn csv(&self) -> String {
        let c = &self.setting.condition;
        let mut cells = vec![
            self.setting.vary.to_owned(),
            c.w_um.to_string(),
            c.eta_um.to_string(),
            c.eps_um.to_string(),
            c.dt_ms.to_string(),
            self.setting.reading().to_owned(),
            self.method.scheme().to_owned(),
            self.method.filter().to_owned(),
            self.method.estimator().to_owned(),
            self.duration_s.to_string(),
            self.seeds.to_string(),
            figure(self.ns_pct),
        ];
        for triple in [
            self.rms_pct,
            self.mean_pct,
            self.median_pct,
            self.bound_pct,
            self.paper_pct(),
        ] {
            cells.extend(triple.map(figure));
        }
        for optional in [self.conv, self.settled_median_ms, self.settled_p95_ms] {
            cells.push(optional.map_or(String::new(), figure));
        }
        cells.extend([self.diverged, self.weak].map(|count| count.to_string()));
        cells.join(",")
    }
}

/// Four significant digits, plain.
fn figure(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    format!("{value:.*}", digits.clamp(0, 12) as usize)
}

/// The lines of one setting, in the order of `methods`; every trial must have run these methods.
pub fn summary(
    setting: &Setting,
    duration_s: f64,
    methods: &[Method],
    trials: &[Trial],
) -> Vec<Line> {
    let root_mean_square = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|v| v * v).sum::<f64>() / trials.len() as f64).sqrt()
    };
    let ns_pct = root_mean_square(&mut trials.iter().map(|t| t.ns_pct));
    let bound_pct = [0, 1, 2].map(|i| root_mean_square(&mut trials.iter().map(|t| t.bound_pct[i])));
    methods
        .iter()
        .enumerate()
        .map(|(m, &method)| {
            let runs = || trials.iter().map(move |t| &t.runs[m]);
            let optional = |of: fn(&Run) -> Option<f64>, share: f64| {
                runs()
                    .map(of)
                    .collect::<Option<Vec<f64>>>()
                    .map(|values| quantile(values, share))
            };
            Line {
                setting: *setting,
                method,
                duration_s,
                seeds: trials.len(),
                ns_pct,
                rms_pct: [0, 1, 2].map(|i| root_mean_square(&mut runs().map(|r| r.error_pct[i]))),
                mean_pct: [0, 1, 2]
                    .map(|i| runs().map(|r| r.error_pct[i]).sum::<f64>() / trials.len() as f64),
                median_pct: [0, 1, 2]
                    .map(|i| quantile(runs().map(|r| r.error_pct[i].abs()).collect(), 0.5)),
                bound_pct,
                conv: optional(|r| r.conv, 0.5),
                settled_median_ms: optional(|r| r.settled_ms, 0.5),
                settled_p95_ms: optional(|r| r.settled_ms, 0.95),
                diverged: runs().filter(|r| r.diverged()).count(),
                weak: runs().filter(|r| r.weak).count(),
            }
        })
        .collect()
}

/// The smallest value that the share of all values does not exceed; NaN for no values.
pub fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values
        .get(rank.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_occurred() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(quantile(values.clone(), 0.5), 50.0);
        assert_eq!(quantile(values, 0.95), 95.0);
        assert_eq!(quantile(vec![2.0, f64::INFINITY], 0.95), f64::INFINITY);
    }

    #[test]
    fn limits_follow_paper_and_bound() {
        let limit = |reading, index: usize| {
            let setting = Setting::all(reading)[index];
            let trial = Trial {
                ns_pct: 1.0,
                bound_pct: [1.0; 3],
                runs: vec![],
            };
            let mut line = summary(&setting, 1.0, &[], &[trial]);
            assert!(line.is_empty());
            line.push(Line {
                setting,
                method: Method::DEFAULT,
                duration_s: 1.0,
                seeds: 1,
                ns_pct: 1.0,
                rms_pct: [0.2; 3],
                mean_pct: [0.0; 3],
                median_pct: [0.0; 3],
                bound_pct: [1.0; 3],
                conv: None,
                settled_median_ms: None,
                settled_p95_ms: None,
                diverged: 0,
                weak: 0,
            });
            (line[0].limit_pct(), line[0].beyond())
        };
        let (tenth, beyond) = limit(Reading::Absolute, 3); // drift 5 mm: 6.6, 10.4, 3.5 %
        let tenth = tenth.unwrap();
        assert!((tenth[0] - 0.66).abs() < 1e-12 && (tenth[2] - 0.35).abs() < 1e-12);
        assert_eq!(beyond, Some([false; 3]));
        assert_eq!(limit(Reading::Absolute, 5).0, Some([0.05; 3]));
        assert_eq!(limit(Reading::Absolute, 5).1, Some([true; 3]));
        assert_eq!(limit(Reading::Relative, 8).0, Some([3.0; 3]));
        let (below, _) = limit(Reading::Relative, 12); // resolution 50 um: 0.43, 1.16, 0.81 %
        assert_eq!(below, Some([f64::INFINITY, 1.16, f64::INFINITY]));
        assert_eq!(limit(Reading::Relative, 14).0, None);
    }

    #[test]
    fn statistics_of_two_runs() {
        let setting = Setting::all(Reading::Relative)[8];
        let run = |e: f64, settled: f64| Trial {
            ns_pct: 40.0,
            bound_pct: [1.0, 2.0, 3.0],
            runs: vec![Run {
                error_pct: [e, -e, 150.0 * e],
                conv: Some(0.5),
                settled_ms: Some(settled),
                weak: false,
            }],
        };
        let trials = [run(3.0, 100.0), run(-4.0, f64::INFINITY)];
        let line = summary(&setting, 3.0, &[Method::DEFAULT], &trials)[0];
        assert!((line.rms_pct[0] - 12.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!((line.median_pct[1], line.diverged), (3.0, 2));
        assert_eq!(line.settled_p95_ms, Some(f64::INFINITY));
        assert!((line.of_bound()[1] - 12.5_f64.sqrt() / 2.0).abs() < 1e-12);
        assert_eq!(
            line.csv(),
            "noise,100,500,2,1,relative,tustin,default,ls+bias,3,2,40.00,3.536,3.536,530.3,-0.5000,0.5000,-75.00,3.000,3.000,450.0,1.000,2.000,3.000,37.60,72.20,17.60,0.5000,100.0,inf,2,0"
        );
        assert_eq!(line.csv().split(',').count(), COLUMNS.split(',').count());
    }
}
