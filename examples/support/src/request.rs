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
}
