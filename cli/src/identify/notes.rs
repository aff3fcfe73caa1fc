//! What is said of a record file: what was taken for granted, moved, filled, or stands alone.

use serde_json::{Value, json};

use crate::format::{counted, significant};
use crate::output::number;
use crate::record::{Alone, Notes};

impl Notes {
    /// In lines.
    pub(crate) fn text(&self) -> String {
        let granted = self.granted.as_ref();
        let mut text = granted.map_or(String::new(), |granted| format!("{granted}\n"));
        if let Some(clock) = self.clock {
            let clock = significant(clock, 4);
            text +=
                &format!("time stamps are rounded to {clock} s: rows taken as equally spaced\n");
        }
        if let Some(jitter) = self.resampling.jitter {
            let percent = significant(100.0 * jitter, 2);
            text += &format!("time steps vary by up to {percent} %: moved to equal intervals\n");
        }
        if self.resampling.filled > 0 {
            let filled = counted(self.resampling.filled, "sample");
            text += &format!("{filled} missing: filled from the samples around\n");
        }
        for alone in &self.alone {
            text += &format!("WARNING: {}\n", sentence(alone));
        }
        text
    }

    /// A refusal of the record with the numbers that may be its cause.
    pub(crate) fn with_cause(&self, refusal: &str) -> String {
        let causes = self
            .alone
            .iter()
            .map(|alone| format!("; {}", sentence(alone)));
        refusal.to_owned() + &causes.collect::<String>()
    }

    /// The numbers that stand alone, for machines.
    pub(crate) fn alone_json(&self) -> Value {
        let each = self.alone.iter().map(|a| {
            json!({"line": a.line, "column": a.column, "value": number(a.value), "expected": number(a.expected)})
        });
        each.collect()
    }
}

fn sentence(alone: &Alone) -> String {
    format!(
        "line {}, column `{}`: {} stands alone (expected about {}, as in the lines around): a wrong number?",
        alone.line,
        alone.column,
        significant(alone.value, 4),
        significant(alone.expected, 4)
    )
}
