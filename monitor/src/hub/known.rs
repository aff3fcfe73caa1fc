//! What is known of the target.

use trendid_link::telemetry::settings::SETTINGS;
use trendid_link::telemetry::{Identity, Request};

/// What is known of the target.
pub(super) struct Known {
    /// What the line leads to, while it is there; why it is not.
    pub(super) up: Option<String>,
    pub(super) why: String,
    /// The start of the target that speaks.
    pub(super) started: Option<u16>,
    /// Of the target, or of the one before it that has not said yet who it is.
    pub(super) identity: Option<Identity>,
    /// Whether this one has said it.
    pub(super) introduced: bool,
    pub(super) values: [Option<f32>; SETTINGS.len()],
}

impl Known {
    /// Before the line is there.
    pub(super) fn nothing() -> Self {
        Self {
            up: None,
            started: None,
            why: "waits for the source".into(),
            identity: None,
            introduced: false,
            values: [None; SETTINGS.len()],
        }
    }

    /// What says that somebody is there; while it is not known who the target is, the question: its
    /// answer may be lost on the line.
    pub(super) const fn alive(&self) -> Request {
        if self.introduced {
            Request::Alive
        } else {
            Request::Hello
        }
    }
}
