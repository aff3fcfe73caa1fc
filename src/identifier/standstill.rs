//! Standstill against the model: the axis is blocked, friction holds it, the command stays inside
//! the dead zone.
//!
//! ```text
//! stands      <=>  |y - y_0| <= 6 sigma_y                       y_0: where the band was entered
//! contradicts <=>  |e - e_0| > 12 sigma_y sqrt(1 + phi' P phi)          e: the innovation, e_0 where the band was entered
//!             and  |e - e_0| > 2 q                          q: the digit of the sensor, or more
//! ```
//!
//! An integrating drive that stands where the model moves by more than twice the band does not obey
//! the model, and its rows teach what is wrong; a model that is not known yet (phi' P phi) does not
//! contradict. Nor does the first one, unless it was given, before N/(omega Delta) rows, of which N
//! tell something new: where noise is as large as the motion P takes that of its regressors for
//! motion.
//!
//! From the fifth contradiction in a row on, if it exceeds 10 q, or from as many as 1/bandwidth
//! takes, the estimate is held until the axis leaves the band, and then for four times as long, at
//! most the settling time of the trends: they still carry what was not of the model. Once it has
//! been held for 1/bandwidth the standstill is certain: the trends begin again at rest as often as
//! it contradicts. When it ends they begin again too, but the axis moves already: the initial state
//! becomes uncertain; a structure without one waits until the trends have lost it.
//!
//! Nothing is held for ever on a model that is not known: what contradicts no more for the settling
//! time of the trends, which have lost by then what did, is no standstill. So an estimate that is
//! held goes on being contradicted, by more than its own uncertainty; and before the noise is known
//! nothing contradicts.
//!
//! Where an input states that the velocity is 0, friction is whatever holds the axis, and no size
//! of the innovation shows it: the row is left out, the command is given back (`stuck`), and from
//! half of 1/bandwidth on the trends begin at rest at the mean of y.
//!
//! A sensor of coarse digits shows no noise where it does not step: sigma_y sinks below the digit,
//! and an axis that crosses one slowly stands by the first rule. What it moves by inside of it is
//! less than a digit and moves the innovation by no more than ||h||_1 digits, h being the impulse
//! response of the model over the filter: 2.5 for a model no faster than the filter, 7 for one that
//! is three times as fast. In 1/bandwidth or more it moves at no more than bandwidth digits, and
//! the innovation by 1.4 of them at most for a model no faster than the filter. Hence 10 q and 2 q,
//! if q is never below the digit; and it is the least difference of two measured values that are
//! not equal, over the steps out of the band and the samples in it that nothing but q explains. The
//! noise of a fine sensor brings it to nothing in a few of the latter.
//!
//! A model that is merely wrong is not held up: while the drive moves, it crosses the band in few
//! samples, and the pause is in proportion to them.
//!
//! # What does not hold
//! A block is learnt from as long as digits may explain it: 0.02 % in the median where they are 0.1
//! to 1 % of the way in a tenth of a second, 1.5 % where they are 1 to 10 %. A stick that is over
//! before the trends begin at rest is left out with four times its length. Where the velocity is 0
//! in a wide band the axis moves in it, and what is given back and left out is not all of what
//! friction did: a band of a twentieth of the largest velocity leaves errors of 5 to 7 %, one of a
//! hundredth 1 %. To begin at rest at once is right for a velocity that is exactly 0 and wrong for
//! a measured one, which is 0 while the drive turns.

/// Half width of the band in standard deviations of the noise; the difference of two samples leaves
/// it by chance twice in 10^5 samples.
const BAND: f32 = 6.0;

/// Standard deviations beyond which the innovation contradicts: twice the band, so that no motion
/// inside it does.
const CONTRADICTS: f32 = 2.0 * BAND;

/// What motion inside a digit may do at first, over what it may do in the end.
const SHORT: f32 = 5.0;

/// Contradictions in a row before anything is concluded.
const LEAST: u32 = 5;

/// Least share of the newest sample in the mean of y of an axis that sticks.
const STUCK: f32 = 1.0 / 64.0;

/// Samples of pause per suspicious sample.
const PAUSE: u32 = 4;

/// Evidence of standstill in a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum StandstillEvidence {
    /// Nothing contradicts the model.
    Obeys,
    /// The row is not of the model, or may not be.
    Withheld,
    /// The axis stands for certain: the trends are to begin again at rest.
    Stands,
    /// It has stood, and moves already: the trends are to begin again, from a state that is not
    /// known.
    Freed,
}

/// Memory of the band that y is in.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Standstill {
    /// y_0 and e_0.
    entered: [f32; 2],
    /// (q / 6)^2; infinite until the band has been left once.
    step: f32,
    /// Contradictions in a row.
    against: u32,
    /// Samples since they were enough, and the last of them in a row without a contradiction.
    contradicted: u32,
    quiet: u32,
    /// Samples until the trends are free of what contradicted.
    pause: u32,
    /// Samples in a row whose velocity is given as 0, and the mean of y over them.
    stuck: u32,
    mean: f32,
}

impl Standstill {
    /// Nothing seen yet.
    pub(crate) const fn new() -> Self {
        Self {
            entered: [0.0; 2],
            step: f32::INFINITY,
            against: 0,
            contradicted: 0,
            quiet: 0,
            pause: 0,
            stuck: 0,
            mean: 0.0,
        }
    }

    /// The innovation from that at y_0, and the distance from there, each squared and in units of
    /// what contradicts and of the band, while the axis is in it; `noise` is the variance of y,
    /// infinite while it is not known.
    ///
    /// Outside of the band the step out of it is kept, if none was less.
    #[inline(always)]
    pub(crate) fn unexplained(&mut self, y: f32, innovation: f32, noise: f32) -> Option<[f32; 2]> {
        let [y_0, e_0] = self.entered;
        let far = (y - y_0) * (1.0 / BAND);
        let size = (innovation - e_0) * (1.0 / CONTRADICTS);
        let far = far * far;
        if far <= noise {
            return Some([size * size, far]);
        }
        if far < self.step {
            self.step = far;
        }
        None
    }

    /// Whether motion inside a digit does not explain a sample in the band, of the size and at the
    /// distance of [`unexplained`](Self::unexplained), that exceeds noise and model.
    #[inline(always)]
    pub(crate) fn exceeds_digits(&mut self, [size, far]: [f32; 2]) -> bool {
        self.exceeds(1.0, [size, far])
    }

    /// As [`exceeds_digits`](Self::exceeds_digits), however short the motion is.
    #[inline(never)]
    fn exceeds_any_motion(&mut self, sample: [f32; 2]) -> bool {
        self.exceeds(SHORT * SHORT, sample)
    }

    /// Whether a size exceeds `steps` times (2 q)^2; if not, and the sample is nearer than q, q
    /// becomes that. Everything does as long as q is not known.
    #[inline(always)]
    fn exceeds(&mut self, steps: f32, [size, far]: [f32; 2]) -> bool {
        if !(size <= self.step * steps) {
            return true;
        }
        if far > 0.0 && far < self.step {
            self.step = far;
        }
        self.step == f32::INFINITY
    }

    /// Classifies a sample by y and its innovation; `certain` and `settling` in samples; in the
    /// band [`unexplained`](Self::unexplained), and whether noise, model and digits leave it so.
    ///
    /// Cost: 20 instructions in motion.
    #[inline(always)]
    pub(crate) fn classify(
        &mut self,
        y: f32,
        innovation: f32,
        [certain, settling]: [u32; 2],
        unexplained: Option<([f32; 2], bool)>,
    ) -> StandstillEvidence {
        self.stuck = 0;
        if let Some((sample, contradicts)) = unexplained {
            self.against = match contradicts {
                true => self.against.wrapping_add(1),
                false => 0,
            };
            if self.contradicted > 0
                || self.against >= certain
                || self.against >= LEAST && self.exceeds_any_motion(sample)
            {
                self.contradicted = self.contradicted.saturating_add(1);
                self.quiet = if contradicts { 0 } else { self.quiet + 1 };
                if self.quiet >= settling {
                    (self.contradicted, self.quiet) = (0, 0);
                    self.entered = [y, innovation];
                    return StandstillEvidence::Obeys;
                }
                if !(contradicts && self.contradicted >= certain) {
                    return StandstillEvidence::Withheld;
                }
                let [_, e_0] = &mut self.entered;
                *e_0 = 0.0;
                return StandstillEvidence::Stands;
            }
        } else {
            self.entered = [y, innovation];
            self.against = 0;
            if self.contradicted | self.pause == 0 {
                return StandstillEvidence::Obeys;
            }
            if self.contradicted > 0 {
                self.pause(self.contradicted.saturating_mul(PAUSE).min(settling));
                let stood = self.contradicted >= certain;
                (self.contradicted, self.quiet) = (0, 0);
                if stood {
                    self.entered = [y, 0.0];
                    return StandstillEvidence::Freed;
                }
            }
        }
        if self.pause > 0 {
            self.pause -= 1;
            return StandstillEvidence::Withheld;
        }
        StandstillEvidence::Obeys
    }

    /// Takes a sample whose velocity is given as 0: friction may be anything that holds the axis.
    ///
    /// Gives where it stands, once it has stood for `least` samples: a measured velocity is 0 now
    /// and then while it turns.
    pub(crate) fn sticks(&mut self, y: f32, least: u32) -> Option<f32> {
        let stuck = self.stuck.saturating_add(1);
        let share = (1.0 / stuck as f32).max(STUCK);
        let mean = match stuck {
            1 => y,
            _ => self.mean + share * (y - self.mean),
        };
        *self = Self {
            entered: [y, 0.0],
            stuck,
            mean,
            step: self.step,
            // Until the trends begin at rest they carry a friction that no input stated.
            pause: match stuck >= least {
                true => 0,
                false => self.pause.max(PAUSE.saturating_mul(stuck)),
            },
            ..Self::new()
        };
        (stuck >= least).then_some(mean)
    }

    /// Whether `y`, that of the newest sample, was outside of the band.
    pub(crate) fn has_left(&self, y: f32) -> bool {
        let [entered, _] = self.entered;
        y == entered
    }

    /// Holds the estimate for `samples` at least.
    pub(crate) fn pause(&mut self, samples: u32) {
        self.pause = self.pause.max(samples);
    }
}

#[cfg(test)]
mod tests;
