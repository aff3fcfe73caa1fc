//! What pages say to the hub, and what it has counted.

use tokio::sync::mpsc::Sender;
use tokio::sync::oneshot;

/// A page and what it says.
pub(crate) enum FromPage {
    /// It has come; messages for it go there.
    Came(u64, Sender<String>),
    /// Its message.
    Message(u64, String),
    /// It has gone.
    Gone(u64),
    /// The report, as a page.
    Report(oneshot::Sender<String>),
}

/// What came in since the start.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub samples: u64,
    /// Samples whose number never came while the line was there.
    pub missing: u64,
    /// The same that the target says it has dropped because the line was full.
    pub dropped: u32,
    pub events: u64,
    pub starts: u32,
}
