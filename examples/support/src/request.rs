//! What a machine is asked to do, and from which sample on; as a value and as a line of text.

use core::fmt;

/// What the machine is asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// To find its model, and to control from then on.
    Commission,
    /// To move to this place in mm; ignored outside of control.
    MoveTo(f32),
    /// To let the valve go to zero.
    Abort,
}

/// An action and the sample in which it is due, so that it does not matter when the request is
/// heard before that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// The sample, counted from 1; what is due in the past is done at once.
    pub tick: u64,
    /// What is due then.
    pub action: Action,
}

impl Request {
    /// Whether it is to stop at once.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        self.tick == 0 && self.action == Action::Abort
    }

    /// The request of a line: `[SAMPLE] run`, `[SAMPLE] stop` or `[SAMPLE] move MM`; without a
    /// sample it is due at once.
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let mut words = line.split_ascii_whitespace();
        let first = words.next()?;
        let (tick, verb) = match first.parse() {
            Ok(tick) => (tick, words.next()?),
            Err(_) => (0, first),
        };
        let action = match verb {
            "run" => Action::Commission,
            "stop" => Action::Abort,
            "move" => {
                let target: f32 = words.next()?.parse().ok()?;
                target.is_finite().then_some(Action::MoveTo(target))?
            }
            _ => return None,
        };
        words.next().is_none().then_some(Self { tick, action })
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ", self.tick)?;
        match self.action {
            Action::Commission => f.write_str("run"),
            Action::Abort => f.write_str("stop"),
            Action::MoveTo(target) => write!(f, "move {target}"),
        }
    }
}

/// What waits for its sample: one request at a time, in the order in which they came.
#[derive(Clone, Copy, Debug, Default)]
pub struct Desk(Option<Request>);

impl Desk {
    /// What is due in sample `tick`; `more` gives the request behind the one that waits. With
    /// `stops` it is to stop, and what waits is given up: a stop waits for nothing.
    pub fn due(
        &mut self,
        tick: u64,
        stops: bool,
        more: impl FnOnce() -> Option<Request>,
    ) -> Option<Action> {
        if stops {
            self.0 = None;
            return Some(Action::Abort);
        }
        self.0 = self.0.or_else(more);
        let due = self.0.take_if(|request| request.tick <= tick)?;
        Some(due.action)
    }
}

/// Bytes of a line that are kept.
pub const LONGEST: usize = 24;

/// A line that comes byte by byte.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line {
    bytes: [u8; LONGEST],
    /// Bytes of the line, those that found no room too.
    length: usize,
}

impl Line {
    /// Takes a byte; at the end of a line that is not empty its request, if it is one. A line that
    /// is too long is none, whatever its begin says.
    pub fn push(&mut self, byte: u8) -> Option<Option<Request>> {
        match byte {
            b'\n' | b'\r' if self.length == 0 => None,
            b'\n' | b'\r' => {
                let whole = self.length <= LONGEST;
                Some(whole.then(|| Request::parse(self.text())).flatten())
            }
            other => {
                if let Some(place) = self.bytes.get_mut(self.length) {
                    // A letter of no word and no number: a byte that is damaged is none of another.
                    *place = if other.is_ascii() { other } else { b'?' };
                }
                self.length = self.length.saturating_add(1);
                None
            }
        }
    }

    /// A byte was lost or damaged: the line that it was in is no request. It may have been the
    /// first one of the next line, so between two lines that is spoiled.
    pub fn spoil(&mut self) {
        self.length = self.length.max(LONGEST).saturating_add(1);
    }

    /// The line, or its begin.
    #[must_use]
    pub fn text(&self) -> &str {
        let kept = self.bytes.get(..self.length).unwrap_or(&self.bytes);
        // Each is one letter.
        core::str::from_utf8(kept).unwrap_or_default()
    }

    /// Begins the next one.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn what_is_written_is_read() {
        for action in [Action::Commission, Action::Abort, Action::MoveTo(-0.125)] {
            let request = Request { tick: 501, action };
            assert_eq!(Request::parse(&request.to_string()), Some(request));
        }
        let now = Request::parse("  move 280\r").unwrap();
        assert_eq!((now.tick, now.action), (0, Action::MoveTo(280.0)));
    }

    #[test]
    fn what_is_no_request_is_none() {
        for line in [
            "",
            "7",
            "go",
            "-1 run",
            "run 1",
            "move",
            "move x",
            "move NaN",
            "1 move inf",
            "1 move 2 3",
        ] {
            assert_eq!(Request::parse(line), None, "{line}");
        }
    }

    /// What is heard of these bytes.
    fn heard(bytes: &[u8]) -> std::vec::Vec<Option<Request>> {
        let mut line = Line::default();
        let mut found = std::vec::Vec::new();
        for &byte in bytes {
            if let Some(request) = line.push(byte) {
                found.push(request);
                line.clear();
            }
        }
        found
    }

    #[test]
    fn lines_are_requests_one_by_one() {
        let found = heard(b"\r\n501 run\r\n\n1500 move 280\nnever\nstop\rru");
        let ticks: std::vec::Vec<_> = found
            .iter()
            .map(|request| request.map(|request| request.tick))
            .collect();
        assert_eq!(ticks, [Some(501), Some(1500), None, Some(0)]);
    }

    #[test]
    fn a_byte_that_is_no_letter_makes_no_request() {
        // Without their eighth bit these are `move 280` and `run`.
        for bytes in [b"move 2\xB80\n".as_slice(), b"\xF2un\n", b"move 28\xB0\r"] {
            assert_eq!(heard(bytes), [None]);
        }
    }

    #[test]
    fn a_stop_waits_for_nothing_and_nothing_is_left_behind_it() {
        let request = |line| Request::parse(line).unwrap();
        let mut queue = std::vec![request("9 run"), request("20 move 5"), request("3 move 7")];
        queue.reverse();
        let mut desk = Desk::default();
        assert_eq!(desk.due(1, false, || queue.pop()), None);
        assert_eq!(desk.due(9, false, || queue.pop()), Some(Action::Commission));
        // In the order in which they came: the third, whose time has passed, waits for the second.
        assert_eq!(desk.due(10, false, || queue.pop()), None);
        assert_eq!(desk.due(11, true, || queue.pop()), Some(Action::Abort));
        assert_eq!(queue.len(), 1);
        assert_eq!(desk.due(20, false, || None), None);
        assert!(request("stop").is_stop() && request("0 stop").is_stop());
        assert!(!request("7 stop").is_stop() && !request("run").is_stop());
    }

    #[test]
    fn a_line_that_has_lost_a_byte_is_no_request_and_the_next_one_is_heard() {
        let bytes = b"1501 move 280\nstop\n";
        for lost in 0..bytes.len() {
            let mut line = Line::default();
            let mut found = std::vec::Vec::new();
            for (place, &byte) in bytes.iter().enumerate() {
                if place == lost {
                    line.spoil();
                } else if let Some(request) = line.push(byte) {
                    found.push(request.map(|request| request.is_stop()));
                    line.clear();
                }
            }
            let expected: &[_] = match lost {
                0..13 => &[None, Some(true)],
                // The end of the first line: both are one.
                13 => &[None],
                14..18 => &[Some(false), None],
                _ => &[Some(false)],
            };
            assert_eq!(found, expected, "{lost}");
        }
    }

    #[test]
    fn a_line_that_is_too_long_is_no_request_whatever_its_begin_says() {
        let line = b"move 280.000000000000000";
        assert_eq!(line.len(), LONGEST);
        let action = Action::MoveTo(280.0);
        assert_eq!(
            heard(&[line.as_slice(), b"\n"].concat()),
            [Some(Request { tick: 0, action })]
        );
        for rest in ["0", "e-5", "1", " 7", " "] {
            let bytes = [line.as_slice(), rest.as_bytes(), b"\nstop\n"].concat();
            let stop = Request {
                tick: 0,
                action: Action::Abort,
            };
            assert_eq!(heard(&bytes), [None, Some(stop)], "{rest}");
        }
    }
}
