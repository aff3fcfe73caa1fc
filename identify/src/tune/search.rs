//! The bandwidth of a loop: the one that is given, or the largest robust one.

use super::model::Model;
use super::plant::SampledPlant;
use super::state_feedback::IDLE;
use super::tuned_loop::{FASTEST, Gains, KINDS, SENSITIVITY, SLOWEST, TunedLoop};
use super::{margins, shaping, state_feedback};

/// Bandwidths that are tried between the slowest and the fastest, at least in all and in a decade,
/// and steps that sharpen the choice.
const TRIED: usize = 24;
const IN_A_DECADE: f64 = 5.0;
const SHARPENED: usize = 5;

/// The slowest bandwidth that is tried is this share of the rate of the plant, at most.
const BELOW: f64 = 1e-3;

/// Why a bandwidth has no gains.
const UNSTABLE: &str = "the loop would be unstable at this bandwidth";
const UNSHAPED: &str = "no gain at this bandwidth";

/// Plants of gain one.
pub(super) struct Search<'a> {
    pub(super) model: &'a Model,
    /// The model, sampled.
    pub(super) plant: SampledPlant,
    /// Within what is known of it.
    pub(super) others: Vec<SampledPlant>,
}

impl Search<'_> {
    /// A loop of a kind at a bandwidth \[rad/s\] with its margins.
    ///
    /// # Errors
    /// Why there is none: it is unstable, or the sensitivity with a plant exceeds `limit`.
    pub(super) fn at(&self, kind: &str, bandwidth: f64, limit: f64) -> Result<TunedLoop, String> {
        let Self {
            model,
            plant,
            others,
        } = self;
        let (gains, controller) = if kind == KINDS[0] {
            if model.a[0] != 0.0 {
                return Err("the plant does not integrate: its output is no position".into());
            }
            let cascade = shaping::cascade(plant, bandwidth).ok_or(UNSHAPED)?;
            (Gains::Cascade(cascade), cascade.controller(plant.dt))
        } else if kind == KINDS[1] {
            let pid = shaping::pid(plant, bandwidth).ok_or(UNSHAPED)?;
            (Gains::Pid(pid), pid.controller(plant.dt))
        } else {
            let (gains, controller) = state_feedback::design(plant, model, bandwidth)?;
            (Gains::StateFeedback(gains), controller)
        };
        let [nominal, worst] = margins::with_others(plant, others, &controller, (bandwidth, limit))
            .ok_or_else(|| match limit.is_finite() {
                true => format!("no bandwidth keeps the sensitivity below {limit}"),
                false => UNSHAPED.into(),
            })?;
        if !nominal.stable {
            return Err(UNSTABLE.into());
        }
        Ok(TunedLoop {
            gains,
            bandwidth,
            controller,
            margins: nominal,
            worst: (!others.is_empty()).then_some(worst),
        })
    }

    /// The loop with the largest bandwidth that is stable and whose sensitivity stays below its
    /// limit, of those that may be asked for.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn fastest_robust(&self, kind: &str) -> Result<TunedLoop, String> {
        let robust = |bandwidth: f64| -> Result<TunedLoop, String> {
            let found = self.at(kind, bandwidth, SENSITIVITY)?;
            let stable = found.worst.is_none_or(|worst| worst.stable);
            stable.then_some(found).ok_or_else(|| UNSTABLE.into())
        };
        let (dt, rate) = (self.plant.dt, self.plant.rate);
        let fastest = FASTEST / dt;
        let slowest = (BELOW * rate.min(fastest)).max(SLOWEST / dt);
        let decades = (fastest / slowest).log10();
        let tried = TRIED.max((IN_A_DECADE * decades).ceil() as usize);
        let ratio = (fastest / slowest).powf(1.0 / (tried - 1) as f64);
        let mut reason = String::new();
        for k in 0..tried {
            let bandwidth = fastest / ratio.powi(k as i32);
            match robust(bandwidth) {
                Ok(best) if k == 0 => return Ok(best),
                Ok(mut best) => {
                    let (mut low, mut high) = (bandwidth, bandwidth * ratio);
                    for _ in 0..SHARPENED {
                        let middle = (low * high).sqrt();
                        match robust(middle) {
                            Ok(found) => (best, low) = (found, middle),
                            Err(_) => high = middle,
                        }
                    }
                    return Ok(best);
                }
                Err(why) if why == IDLE && !reason.is_empty() && reason != IDLE => {
                    return Err(format!("{reason} and is above a pole of the plant"));
                }
                Err(why) if why == UNSTABLE => {
                    reason = format!(
                        "no bandwidth leaves the loop stable with a sensitivity below {SENSITIVITY}"
                    );
                }
                Err(why) => reason = why,
            }
        }
        Err(reason)
    }
}
