//! The structure of a model, as options.

use clap::Args;
use trendid_identify::Structure;

use crate::identify::parse::whole;

#[derive(Debug, Args)]
pub(crate) struct StructureArgs {
    /// Order of the model, 1 to 4, the integrator included
    #[arg(long, value_name = "M", value_parser = whole(1, 4), allow_negative_numbers = true)]
    order: usize,
    /// The plant integrates: a0 = 0
    #[arg(long)]
    integrator: bool,
    /// Number of zeros: b0 .. bK of each input are estimated
    #[arg(
        long,
        value_name = "K",
        default_value_t = 0,
        value_parser = whole(0, 3),
        allow_negative_numbers = true
    )]
    zeros: usize,
}

impl StructureArgs {
    /// The structure, with a constant input or without.
    pub(crate) const fn with(&self, constant: bool) -> Structure {
        Structure {
            order: self.order,
            integrator: self.integrator,
            zeros: self.zeros,
            constant,
        }
    }
}
