//! A run on its way: samples, requests, commissioning, and what steps and sines show.

use trendid::servo::State;

use crate::servo::figures::Figures;
use crate::servo::rig::{Instant, Request, Rig};
use crate::servo::shadow::Shadow;

/// Sees every sample of a run.
pub type Watcher<'a> = &'a mut dyn FnMut(&Instant, &Rig);

/// A run on its way: the rig, its figures and who watches.
pub(super) struct Run<'a> {
    pub(super) rig: Rig,
    pub(super) figures: Figures,
    pub(super) watcher: Watcher<'a>,
    /// Has the plant when it is there.
    pub(super) shadow: Option<&'a mut dyn Shadow>,
}

/// Everything in a run gives `None` when the shadow ends it.
impl Run<'_> {
    pub(super) fn step(&mut self) -> Option<Instant> {
        let code = self.rig.plant.code();
        let reading = match &mut self.shadow {
            Some(shadow) => shadow.reading(code),
            None => Some(code),
        };
        let instant = self.rig.sample(reading);
        let command = match &mut self.shadow {
            Some(shadow) => shadow.update(reading, &instant.report, &self.rig)?,
            None => instant.report.command,
        };
        self.rig.drive(command);
        (self.watcher)(&instant, &self.rig);
        Some(instant)
    }

    pub(super) fn request(&mut self, request: Request) {
        self.rig.request(request);
        if let Some(shadow) = &mut self.shadow {
            shadow.request(request);
        }
    }

    pub(super) fn pass(&mut self, seconds: f64) -> Option<()> {
        for _ in 0..(1e3 * seconds) as u32 {
            let _ = self.step()?;
        }
        Some(())
    }

    /// Commissions; whether there is a model.
    pub(super) fn commission(&mut self) -> Option<bool> {
        self.request(Request::Commission);
        for k in 1..=7000 {
            let state = self.step()?.report.state;
            if state == State::Verified {
                self.figures.verified_at_s = Some(1e-3 * f64::from(k));
                return Some(true);
            }
            if !state.is_commissioning() {
                return Some(false);
            }
        }
        Some(false)
    }

    pub(super) fn move_to(&mut self, target: f64, seconds: f64) -> Option<()> {
        self.request(Request::MoveTo(target as f32));
        self.pass(seconds)
    }

    /// Steps of 60 mm there and back; the worse of both counts.
    pub(super) fn steps(&mut self) -> Option<()> {
        self.move_to(170.0, 2.0)?;
        let (mut steady, mut rise, mut over) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (from, to) in [(170.0, 230.0), (230.0, 170.0)] {
            self.request(Request::MoveTo(to as f32));
            let share = |x: f64| (x - from) / (to - from);
            let (mut at_10, mut at_90) = (None, None);
            for k in 0..2000 {
                let x = self.step()?.position_mm;
                let s = share(x);
                if s >= 0.1 && at_10.is_none() {
                    at_10 = Some(k);
                }
                if s >= 0.9 && at_90.is_none() {
                    at_90 = Some(k);
                }
                over = over.max(100.0 * (s - 1.0));
                if k >= 1500 {
                    steady = steady.max((x - to).abs());
                }
            }
            rise = rise.max(match (at_10, at_90) {
                (Some(a), Some(b)) => f64::from(b - a),
                _ => f64::INFINITY,
            });
        }
        self.figures.steady_state_mm = Some(steady);
        self.figures.rise_ms = Some(rise);
        self.figures.overshoot_pct = Some(over);
        Some(())
    }

    /// A sine about the present reference.
    pub(super) fn oscillate(&mut self, amplitude: f32, frequency: f32) {
        self.request(Request::Oscillate {
            amplitude,
            frequency,
        });
    }

    /// Largest error over `periods` of a sine about 200 mm, after one to begin.
    pub(super) fn sine(&mut self, hz: f64, periods: f64) -> Option<f64> {
        self.move_to(200.0, 1.5)?;
        self.oscillate(60.0, hz as f32);
        self.pass(1.0 / hz)?;
        let mut worst = 0.0_f64;
        for _ in 0..(1e3 * periods / hz) as u32 {
            worst = worst.max(error(&self.step()?).abs());
        }
        Some(worst)
    }

    pub(super) fn performance(&mut self) -> Option<()> {
        self.steps()?;
        self.figures.tracking_0p5hz_mm = Some(self.sine(0.5, 2.0)?);
        self.figures.tracking_1hz_mm = Some(self.sine(1.0, 3.0)?);
        Some(())
    }
}

/// Reference minus true position \[mm\].
pub(super) fn error(instant: &Instant) -> f64 {
    f64::from(instant.report.setpoint.position) - instant.position_mm
}
