//! One pass over a record: products of instruments and regressors, summed block by block.

use crate::error::Error;
use crate::instruments::lanes::Design;
use crate::instruments::layout::{Layout, Setting};
use crate::instruments::pass::Pass;
use crate::problem::Problem;

/// Blocks of equal length that a record is divided into.
pub(crate) const BLOCKS: usize = 16;

/// The sums of a pass, in blocks.
///
/// Rows: the twice filtered inputs, then the regressors themselves. Columns: the regressors, then
/// the left-hand side.
pub(crate) struct Sums {
    pub(super) layout: Layout,
    pub(super) design: Box<dyn Design>,
    /// What is subtracted from the output: positions are large against their increments, so their
    /// reference goes before f32. Only an integrator or a constant takes it up.
    pub(super) reference: f64,
    /// Row after row, one matrix for each block.
    pub(super) blocks: Vec<Vec<f64>>,
}

impl Sums {
    /// The sums of a record.
    ///
    /// # Errors
    /// The core's refusal of the filter.
    pub(super) fn of(problem: &Problem, setting: &Setting) -> Result<Self, Error> {
        let mut pass = Pass::of(problem, setting)?;
        let layout = pass.layout.clone();
        let columns = layout.columns();
        let mut blocks =
            vec![vec![0.0; (layout.auxiliary_rows() + columns) * (columns + 1)]; BLOCKS];
        let samples = problem.samples();
        pass.run(problem, |k, z, phi| {
            let rows = blocks[k * BLOCKS / samples].chunks_exact_mut(columns + 1);
            for (row, weight) in rows.zip(z.iter().chain(&phi[..columns])) {
                for (sum, value) in row.iter_mut().zip(phi) {
                    *sum += weight * value;
                }
            }
        });
        Ok(Self {
            layout,
            design: pass.design,
            reference: pass.reference,
            blocks,
        })
    }
}
