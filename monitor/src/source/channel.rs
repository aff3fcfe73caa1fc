//! A source in its thread, and the two queues between it and the hub.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use tokio::sync::mpsc::{Receiver, Sender, channel};

/// What a source says.
#[derive(Debug)]
pub(crate) enum Said {
    /// The line is there; what is at its other end.
    Up(String),
    /// Bytes of the wire.
    Bytes(Vec<u8>),
    /// The line is gone, and why.
    Down(String),
}

/// Portions of bytes that wait in either direction.
const WAITING: usize = 256;

/// A source that runs in a thread of its own.
pub(crate) struct Source {
    /// What it says.
    pub said: Receiver<Said>,
    /// Bytes for it.
    pub asked: Sender<Vec<u8>>,
    end: Arc<AtomicBool>,
    thread: Option<thread::JoinHandle<()>>,
}

/// The end of a source in its thread.
pub(crate) struct Line {
    said: Sender<Said>,
    /// Whether the last that was said of the line is that it is there.
    up: Cell<bool>,
    asked: Receiver<Vec<u8>>,
    end: Arc<AtomicBool>,
}

impl Line {
    /// Whether the program goes on.
    pub(super) fn lives(&self) -> bool {
        !self.end.load(Ordering::Relaxed) && !self.said.is_closed()
    }

    /// Says something and waits until there is room.
    pub(super) fn say(&self, said: Said) {
        match said {
            Said::Up(_) => self.up.set(true),
            Said::Down(_) => self.up.set(false),
            Said::Bytes(_) => {}
        }
        // Nobody listens at the end of the program only.
        let _ = self.said.blocking_send(said);
    }

    /// Whether somebody was told that the line is there, and not yet that it is gone.
    pub(super) fn is_up(&self) -> bool {
        self.up.get()
    }

    /// Whether there is room for bytes now.
    pub(super) fn has_room(&self) -> bool {
        self.said.capacity() > 1
    }

    /// What was asked meanwhile.
    pub(super) fn take(&mut self) -> Option<Vec<u8>> {
        self.asked.try_recv().ok()
    }
}

impl Source {
    /// Runs `act` in a thread.
    pub(super) fn of(act: impl FnOnce(Line) + Send + 'static) -> Self {
        let (said, hears) = channel(WAITING);
        let (asks, asked) = channel(WAITING);
        let end = Arc::new(AtomicBool::new(false));
        let line = Line {
            said,
            up: Cell::new(false),
            asked,
            end: end.clone(),
        };
        let thread = thread::spawn(move || act(line));
        Self {
            said: hears,
            asked: asks,
            end,
            thread: Some(thread),
        }
    }
}

impl Drop for Source {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        self.said.close();
        if let Some(thread) = self.thread.take() {
            // Its panic was printed when it happened.
            let _ = thread.join();
        }
    }
}
