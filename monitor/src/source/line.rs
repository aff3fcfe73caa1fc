//! Serial ports and sockets: bytes in both directions, and again after they were lost.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::Duration;

use crate::source::channel::{Line, Said};

/// Pause before the line is tried again.
const PAUSE: Duration = Duration::from_secs(1);

/// Longest wait for bytes, so that what is asked does not wait longer.
pub(super) const WAIT: Duration = Duration::from_millis(5);

pub(super) fn over_port(device: &str, baud: u32, mut line: Line) {
    again(&mut line, |line| {
        let port = serialport::new(device, baud)
            .timeout(WAIT)
            .open()
            .map_err(|error| format!("{device}: {error}"))?;
        line.say(Said::Up(format!("{device}, {baud} baud")));
        pump(port, line)
    });
}

pub(super) fn over_tcp(address: &str, mut line: Line) {
    again(&mut line, |line| {
        let stream = connect(address)?;
        line.say(Said::Up(address.to_owned()));
        pump(stream, line)
    });
}

fn connect(address: &str) -> Result<TcpStream, String> {
    let named = |error: std::io::Error| format!("{address}: {error}");
    let stream = TcpStream::connect(address).map_err(named)?;
    prompt(&stream).map_err(named)?;
    Ok(stream)
}

/// A socket that sends at once, and waits for bytes only briefly.
pub(super) fn prompt(stream: &TcpStream) -> std::io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(WAIT))
}

/// Uses a line until it is lost, says why, and begins again; the same reason once for as long as
/// there is no line.
pub(super) fn again(line: &mut Line, mut attempt: impl FnMut(&mut Line) -> Result<(), String>) {
    let mut said = None;
    while line.lives() {
        if let Err(why) = attempt(line)
            && (line.is_up() || said.as_ref() != Some(&why))
        {
            line.say(Said::Down(why.clone()));
            said = Some(why);
        }
        // What was asked of a line that is gone moves nothing when it comes back.
        while line.take().is_some() {}
        thread::sleep(PAUSE);
    }
}

/// Carries bytes in both directions until the line is lost.
pub(super) fn pump(mut stream: impl Read + Write, line: &mut Line) -> Result<(), String> {
    let mut buffer = [0; 4096];
    while line.lives() {
        while let Some(asked) = line.take() {
            stream
                .write_all(&asked)
                .map_err(|error| error.to_string())?;
        }
        match stream.read(&mut buffer) {
            Ok(0) => return Err("the other end has closed the line".into()),
            Ok(count) => line.say(Said::Bytes(buffer[..count].to_vec())),
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {}
                _ => return Err(error.to_string()),
            },
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;
    use crate::source::channel::Source;

    #[test]
    fn a_line_that_comes_and_goes_is_told_each_time() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let mut source = Source::of(move |line| over_tcp(&address, line));
        for turn in 0..2 {
            drop(listener.accept().unwrap());
            let up = source.said.blocking_recv();
            assert!(matches!(up, Some(Said::Up(_))), "{turn}: {up:?}");
            let down = source.said.blocking_recv();
            assert!(matches!(down, Some(Said::Down(_))), "{turn}: {down:?}");
        }
        // The reason why there is none is told once.
        drop(listener);
        let down = source.said.blocking_recv();
        assert!(matches!(down, Some(Said::Down(_))), "{down:?}");
        thread::sleep(PAUSE + PAUSE / 2);
        assert!(source.said.try_recv().is_err());
    }
}
