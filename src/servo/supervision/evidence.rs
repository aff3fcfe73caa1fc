//! What windows of free simulation say together: which model is clearly better than the one in use.

use crate::servo::design::SupervisionDesign;
use crate::servo::model::Model;
use crate::servo::supervision::bank;
use crate::servo::supervision::screening::{Candidate, UNKNOWN};
use crate::servo::supervision::state::Reason;
use crate::servo::supervision::validation::Sums;

/// Part of earlier windows that counts beside a new one: those of some seconds decide, not those of
/// an hour ago.
const KEPT: f32 = 0.6;
/// Windows of a bank, so weighed, that say something: more than one.
const ENOUGH: f32 = 1.5;
/// Windows in which an estimate must be better, and a model that comes from windows before.
const OF_AN_ESTIMATE: u32 = 2;
const OF_THE_BANK: u32 = 1;
/// Parts of the errors of the model in use, and of the movement, below which a challenger is better
/// by far: then it replaces that one after another window, even where it does not explain the
/// movement as it should.
const FAR: [f32; 2] = [0.25, 0.5];

/// A model that would replace the one in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Challenger {
    pub(crate) model: Model,
    /// Variances of a1, a2 and b0.
    pub(crate) variances: [f32; 3],
    needs: u32,
    windows: u32,
    /// Sums of its windows.
    own: f32,
    bank: [f32; bank::SIZE],
    moved: f32,
}

impl Challenger {
    const fn new(model: Model, variances: [f32; 3], needs: u32) -> Self {
        Self {
            model,
            variances,
            needs,
            windows: 0,
            own: 0.0,
            bank: [0.0; bank::SIZE],
            moved: 0.0,
        }
    }
}

/// The evidence of windows about the model in use.
///
/// A window is short, and what moved in it may say little: at the turn of a sine the axis stands,
/// in a slow motion all models of the right gain are equal, and a breakaway is in none of them. So
/// sums of squares are added up over windows, where each counts by what moved in it, and decide
/// together:
///
/// ```text
/// bank         sums of all windows, those before times 0.6; a model of it that is clearly better becomes the challenger
/// challenger   sums of its own windows: clearly better than the model in use in 2 of them together (1 if it comes from the bank)
/// clearly      SSE < 0.7 SSE of the other, and the difference exceeds a tenth of what moved
/// ```
///
/// The models of a bank were there before the samples: none of them fits by chance, and no estimate
/// is needed, which in closed loop may be wrong by more than its deviations say. An estimate may;
/// but what it has from one motion does not help it in the next ones. Of two models that explain a
/// motion the simpler change is right until the other is clearly better: a sine shows two numbers,
/// a slow motion one, and more parameters than a motion shows are wrong in the next one.
///
/// Known as: multiple-model estimation (Li and Bar-Shalom 1996) by sums of squared errors of free
/// simulation in the place of likelihoods; parsimony principle (Ljung 1999, chapter 16).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Evidence {
    sums: [f32; bank::SIZE],
    moved: f32,
    /// Windows, those before times [`KEPT`].
    windows: f32,
    challenger: Option<Challenger>,
}

impl Evidence {
    /// Of no window.
    pub(crate) const NONE: Self = Self {
        sums: [0.0; bank::SIZE],
        moved: 0.0,
        windows: 0.0,
        challenger: None,
    };

    /// Begins anew, with another model in use.
    pub(crate) fn forget(&mut self) {
        self.sums = [0.0; bank::SIZE];
        self.moved = 0.0;
        self.windows = 0.0;
        self.challenger = None;
    }

    /// The model that runs beside the bank.
    pub(crate) fn challenger(&self) -> Option<Model> {
        self.challenger.map(|challenger| challenger.model)
    }

    /// An estimate becomes the challenger, if there is none.
    pub(crate) fn propose(&mut self, candidate: &Candidate) {
        let Candidate {
            model, variances, ..
        } = *candidate;
        self.challenger
            .get_or_insert(Challenger::new(model, variances, OF_AN_ESTIMATE));
    }

    /// A model that was verified before becomes the challenger.
    pub(crate) const fn reconsider(&mut self, model: Model) {
        self.challenger = Some(Challenger::new(model, UNKNOWN, OF_THE_BANK));
    }

    /// Adds a window. Cost: about 100 instructions.
    pub(crate) fn add(&mut self, window: &Sums) {
        self.windows = KEPT * self.windows + 1.0;
        self.moved = KEPT * self.moved + window.moved;
        for (sum, sse) in self.sums.iter_mut().zip(window.bank) {
            *sum = KEPT * *sum + sse;
        }
        let (Some(challenger), Some(sse)) = (&mut self.challenger, window.challenger) else {
            return;
        };
        challenger.windows += 1;
        challenger.own += sse;
        challenger.moved += window.moved;
        for (sum, sse) in challenger.bank.iter_mut().zip(window.bank) {
            *sum += sse;
        }
    }

    /// The model that replaces the one in use; why the challenger is none.
    pub(crate) fn verdict(
        &mut self,
        design: &SupervisionDesign,
        used: &Model,
    ) -> Result<Option<Challenger>, Reason> {
        let verdict = match &self.challenger {
            Some(challenger) => challenger.verdict(design, used),
            None => Ok(None),
        };
        if verdict != Ok(None) {
            self.challenger = None;
        }
        if self.challenger.is_none() && self.windows > ENOUGH {
            let (model, sum) = bank::best(used, &self.sums);
            if design.is_better(sum, self.sums[bank::USED], self.moved) {
                let variances = bank::variances(&model);
                self.challenger = Some(Challenger::new(model, variances, OF_THE_BANK));
            }
        }
        verdict
    }
}

impl Challenger {
    /// Itself or the simpler change in its place, once it has won; why it has lost.
    fn verdict(&self, design: &SupervisionDesign, used: &Model) -> Result<Option<Self>, Reason> {
        let incumbent = self.bank[bank::USED];
        if !design.is_better(self.own, incumbent, self.moved) {
            return Err(Reason::NotBetter);
        }
        let fits = self.own < (1.0 - design.min_r_squared_adapting) * self.moved;
        let [of_errors, of_movement] = FAR;
        let far = self.own < of_errors * incumbent && self.own < of_movement * self.moved;
        if !fits && !far {
            return Err(Reason::PoorFit);
        }
        if self.windows < self.needs + u32::from(!fits) {
            return Ok(None);
        }
        let (model, sum) = bank::best(used, &self.bank);
        if design.is_better(self.own, sum, self.moved) {
            return Ok(Some(*self));
        }
        Ok(Some(Self {
            model,
            variances: bank::variances(&model),
            ..*self
        }))
    }
}

#[cfg(test)]
mod tests;
