//! The delay in words.

use super::report::Report;
use crate::format::{significant, with_sigma};

impl Report<'_> {
    /// `2.03 +- 0.02 samples`, with what speaks against it.
    pub(super) fn delay_text(&self) -> String {
        let found = self.found;
        let delay = match found.delay_sigma() {
            Some(_) if found.delay_untold() => {
                let delay = significant(found.delay, 3);
                format!("{delay} samples, which the record does not tell")
            }
            Some(sigma) => format!("{} samples", with_sigma(found.delay, sigma)),
            None if found.delay == 1.0 => "1 sample".into(),
            None => format!("{} samples", found.delay),
        };
        let at_end = match (found.delay_at_end, found.delay_alike) {
            (true, _) => " (the longest that was tried: give a longer one by --delay)".into(),
            // A neighbour to each side is the resolution of the search.
            (false, Some([shortest, longest])) if longest - shortest > 2 => {
                format!(" (flat: {shortest} to {longest} simulate as well)")
            }
            (false, _) => String::new(),
        };
        delay + &at_end
    }
}
