//! What leaves the program: text on standard output, progress and one-sentence
//! refusals on standard error.

use std::io::{ErrorKind, IsTerminal, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use thiserror::Error;
use trendid_identify::side_by_side;

/// Why a command cannot do what it was asked, as one sentence.
#[derive(Debug, Error)]
#[error("{0}")]
pub(crate) struct Refusal(String);

impl Refusal {
    pub(crate) fn new(sentence: impl Into<String>) -> Self {
        Self(sentence.into())
    }
}

impl From<String> for Refusal {
    fn from(sentence: String) -> Self {
        Self(sentence)
    }
}

impl From<crate::record::RecordError> for Refusal {
    fn from(error: crate::record::RecordError) -> Self {
        Self(error.to_string())
    }
}

impl From<trendid_identify::Error> for Refusal {
    fn from(error: trendid_identify::Error) -> Self {
        Self(error.to_string())
    }
}

impl From<trendid::ConfigError> for Refusal {
    fn from(error: trendid::ConfigError) -> Self {
        Self(error.to_string())
    }
}

/// Writes to standard output; a reader that has gone away is no error.
///
/// # Errors
///
/// What the system says of a write that failed.
pub(crate) fn emit(text: &str) -> Result<(), Refusal> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Refusal::new(format!(
            "cannot write to standard output: {error}"
        ))),
        _ => Ok(()),
    }
}

/// Writes a JSON value on one line.
///
/// # Errors
///
/// As [`emit`].
pub(crate) fn emit_json(value: &serde_json::Value) -> Result<(), Refusal> {
    emit(&format!("{value}\n"))
}

/// A number for JSON; what is not finite becomes null.
pub(crate) fn number(value: f64) -> serde_json::Value {
    serde_json::Number::from_f64(value).map_or(serde_json::Value::Null, Into::into)
}

/// The shortest decimal figure that is this f32, for JSON.
pub(crate) fn number32(value: f32) -> serde_json::Value {
    number(value.to_string().parse().unwrap_or(f64::NAN))
}

/// A progress bar over `steps`, drawn only when standard error is a terminal.
pub(crate) fn progress(steps: u64, what: &'static str) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let bar = ProgressBar::with_draw_target(Some(steps), target).with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:32} {pos}/{len} {elapsed}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// What `one` makes of each of `items`, on all processors and in their order, each a step of the
/// bar.
pub(crate) fn under<I: Sync, T: Send>(
    bar: &ProgressBar,
    items: &[I],
    one: impl Fn(&I) -> T + Sync,
) -> Vec<T> {
    side_by_side(items, |item| {
        let made = one(item);
        bar.inc(1);
        made
    })
}

/// The progress of a search.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    pub(crate) fn new(what: &'static str) -> Self {
        Self(progress(0, what))
    }

    pub(crate) fn finish(self) {
        self.0.finish_and_clear();
    }
}

impl trendid_identify::Progress for Bar {
    fn begin(&self, steps: usize) {
        self.0.set_position(0);
        self.0.set_length(steps as u64);
    }

    fn step(&self) {
        self.0.inc(1);
    }
}
