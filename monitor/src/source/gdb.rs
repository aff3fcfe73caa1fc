//! A debugger's stub that speaks the remote protocol of GDB (its manual, appendix E), e.g. that of
//! QEMU: telemetry over the rings of RTT in the memory of its target.
//!
//! A stub answers while its target stands still, so the target is stopped for each look and goes on
//! after it. To an emulator that is time that does not pass; a machine must not be looked at in
//! this way. The servers of debuggers that read the memory of a board while it runs (OpenOCD,
//! J-Link) offer the channels as sockets, for `--tcp`.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use crate::source::channel::{Line, Said};
use crate::source::line::again;
use crate::source::rtt::{Memory, Rtt};

/// Name of the channels.
const NAME: &str = "telemetry";

/// Where a Cortex-M has its memory, and how much of it is searched.
const RAM: u32 = 0x2000_0000;
const LENGTH: u32 = 1 << 20;

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// Time between two searches for the control block, which a program writes as it begins.
const SEARCH: Duration = Duration::from_millis(200);

/// Time in which a stub must answer.
const ANSWER: Duration = Duration::from_secs(3);

/// Bytes that are read or written in a packet: stubs take 1024 of text at least.
const PART: usize = 480;

/// Bytes that are taken in a look, so that a target cannot hold it for ever.
const MOST: usize = 1 << 16;

/// A stub and its target.
pub(super) struct Gdb {
    stream: TcpStream,
    received: Vec<u8>,
}

pub(super) fn run(address: &str, mut line: Line) {
    again(&mut line, |line| {
        let stream = TcpStream::connect(address).map_err(|error| format!("{address}: {error}"))?;
        carry(Gdb::new(stream)?, address, line)
    });
}

/// Carries bytes in both directions until the line is lost.
pub(super) fn carry(mut gdb: Gdb, name: &str, line: &mut Line) -> Result<(), String> {
    let mut found = None;
    let mut asked: Vec<u8> = Vec::new();
    while line.lives() {
        gdb.stop()?;
        let rtt = match found {
            Some(rtt) => rtt,
            None => match Rtt::find(&mut gdb, RAM, LENGTH, NAME)? {
                Some(rtt) => {
                    // What was asked before had no line.
                    while line.take().is_some() {}
                    line.say(Said::Up(format!("{name}, RTT")));
                    *found.insert(rtt)
                }
                None => {
                    gdb.go_on()?;
                    thread::sleep(SEARCH);
                    continue;
                }
            },
        };
        let mut said = Vec::new();
        while let Some(more) = line.take() {
            asked.extend(more);
        }
        rtt.take(&mut gdb, MOST, &mut said)?;
        let given = rtt.give(&mut gdb, &asked)?;
        asked.drain(..given);
        gdb.go_on()?;
        if !said.is_empty() {
            line.say(Said::Bytes(said));
        }
        thread::sleep(LOOK);
    }
    Ok(())
}

impl Gdb {
    /// A stub, whose target goes on.
    pub(super) fn new(stream: TcpStream) -> Result<Self, String> {
        let failed = |error: std::io::Error| error.to_string();
        stream.set_nodelay(true).map_err(failed)?;
        stream.set_read_timeout(Some(ANSWER)).map_err(failed)?;
        let mut gdb = Self {
            stream,
            received: Vec::new(),
        };
        // Some stubs stop the target when somebody calls, some do not, and some say so: after this
        // it stands still, and what was said of it is heard.
        gdb.send(b"\x03")?;
        gdb.send(&packet("?"))?;
        gdb.answer(is_stop)?;
        gdb.ask("qC")?;
        gdb.go_on()?;
        Ok(gdb)
    }

    /// Stops the target.
    fn stop(&mut self) -> Result<(), String> {
        self.send(b"\x03")?;
        self.answer(is_stop).map(drop)
    }

    /// The target runs; the stub says no more than that it has heard.
    fn go_on(&mut self) -> Result<(), String> {
        self.send(&packet("c"))
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.stream
            .write_all(bytes)
            .map_err(|error| format!("the debugger: {error}"))
    }

    fn ask(&mut self, what: &str) -> Result<Vec<u8>, String> {
        self.send(&packet(what))?;
        self.answer(|said| !is_stop(said) && !is_output(said))
    }

    /// The next packet that is `wanted`; others are older.
    fn answer(&mut self, wanted: impl Fn(&[u8]) -> bool) -> Result<Vec<u8>, String> {
        let begin = Instant::now();
        loop {
            while let Some(said) = self.packet()? {
                self.send(b"+")?;
                if wanted(&said) {
                    return Ok(said);
                }
            }
            let mut buffer = [0; 4096];
            match self.stream.read(&mut buffer) {
                Ok(0) => return Err("the debugger has closed the line".into()),
                Ok(count) => self.received.extend_from_slice(&buffer[..count]),
                Err(error) => match error.kind() {
                    ErrorKind::Interrupted => {}
                    ErrorKind::WouldBlock | ErrorKind::TimedOut => return Err(silent()),
                    _ => return Err(format!("the debugger: {error}")),
                },
            }
            if begin.elapsed() > ANSWER {
                return Err(silent());
            }
        }
    }

    /// The first packet of what was received.
    fn packet(&mut self) -> Result<Option<Vec<u8>>, String> {
        let Some(begin) = self.received.iter().position(|&byte| byte == b'$') else {
            self.received.clear();
            return Ok(None);
        };
        let Some(length) = self.received[begin..].iter().position(|&byte| byte == b'#') else {
            return if self.received.len() > 1 << 16 {
                Err("the debugger sends a packet without an end".into())
            } else {
                Ok(None)
            };
        };
        let end = begin + length;
        let Some(sum) = self.received.get(end + 1..end + 3) else {
            return Ok(None);
        };
        let said = self.received[begin + 1..end].to_vec();
        if bytes_of(sum) != Some(vec![check(&said)]) {
            return Err("the debugger sends a packet with a wrong check sum".into());
        }
        self.received.drain(..end + 3);
        Ok(Some(said))
    }
}

impl Memory for Gdb {
    fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), String> {
        let mut at = address;
        for part in into.chunks_mut(PART) {
            let said = self.ask(&format!("m{at:x},{:x}", part.len()))?;
            match bytes_of(&said) {
                Some(bytes) if bytes.len() == part.len() => part.copy_from_slice(&bytes),
                _ => {
                    let said = String::from_utf8_lossy(&said);
                    return Err(format!("the debugger does not read {at:#x}: `{said}`"));
                }
            }
            at = at.wrapping_add(part.len() as u32);
        }
        Ok(())
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), String> {
        let mut at = address;
        for part in bytes.chunks(PART) {
            let data: String = part.iter().map(|byte| format!("{byte:02x}")).collect();
            let said = self.ask(&format!("M{at:x},{:x}:{data}", part.len()))?;
            if said != b"OK" {
                let said = String::from_utf8_lossy(&said);
                return Err(format!("the debugger does not write {at:#x}: `{said}`"));
            }
            at = at.wrapping_add(part.len() as u32);
        }
        Ok(())
    }
}

fn silent() -> String {
    format!("the debugger does not answer within {} s", ANSWER.as_secs())
}

/// Whether it says that the target has stopped. An answer that is data begins with a digit, an
/// error with `E`.
fn is_stop(said: &[u8]) -> bool {
    matches!(said.first(), Some(b'T' | b'S'))
}

/// Whether it is what the program prints.
fn is_output(said: &[u8]) -> bool {
    said.first() == Some(&b'O') && said != b"OK"
}

fn packet(body: &str) -> Vec<u8> {
    format!("${body}#{:02x}", check(body.as_bytes())).into_bytes()
}

fn check(body: &[u8]) -> u8 {
    body.iter().fold(0, |sum, &byte| sum.wrapping_add(byte))
}

/// The bytes that pairs of digits stand for.
fn bytes_of(digits: &[u8]) -> Option<Vec<u8>> {
    let digit = |digit: u8| char::from(digit).to_digit(16);
    let pairs = digits.chunks(2).map(|pair| match pair {
        [high, low] => Some((16 * digit(*high)? + digit(*low)?) as u8),
        _ => None,
    });
    pairs.collect()
}

#[cfg(test)]
pub(super) mod tests;
