//! A page that is open, and what it was too slow for.

use tokio::sync::mpsc::Sender;

use crate::hub::message;

/// A page that is open.
pub(super) struct Page {
    messages: Sender<String>,
    /// Messages that it was too slow for.
    missed: u64,
}

impl Page {
    pub(super) const fn new(messages: Sender<String>) -> Self {
        Self {
            messages,
            missed: 0,
        }
    }

    /// Gives a message; a page that is too slow misses it and hears how many.
    pub(super) fn tell(&mut self, message: &str) {
        if self.missed > 0 {
            let missed = message::missed(self.missed);
            if self.messages.try_send(missed).is_err() {
                self.missed += 1;
                return;
            }
            self.missed = 0;
        }
        if self.messages.try_send(message.to_owned()).is_err() {
            self.missed += 1;
        }
    }
}
