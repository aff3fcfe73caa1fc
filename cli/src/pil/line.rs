//! The line to the target: a socket of the emulator or a serial port, and faults on purpose.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use trendid_link::Bytes;

use crate::output::Refusal;

/// How long the emulator may take to open its line, and the image to be heard on it.
const START: Duration = Duration::from_secs(10);

/// A byte stream that gives up reading after its timeout.
pub(super) trait Line: Read + Write {}
impl<T: Read + Write> Line for T {}

/// A line that disturbs frames on purpose.
pub(super) struct Disturbed {
    line: Box<dyn Line>,
    dice: Dice,
    one_in: Option<u32>,
    /// Faults so far.
    pub injected: u32,
    /// The frame that is coming in.
    frame: Vec<u8>,
    /// Bytes of complete frames that were not taken yet.
    inbox: VecDeque<u8>,
}

impl Disturbed {
    /// Disturbs one frame in `one_in`, or none, with dice of this seed.
    pub(super) fn new(line: Box<dyn Line>, one_in: Option<u32>, seed: u64) -> Self {
        Self {
            line,
            dice: Dice(seed),
            one_in,
            injected: 0,
            frame: Vec::new(),
            inbox: VecDeque::new(),
        }
    }

    fn disturb(&mut self, frame: &mut Vec<u8>) {
        let Some(one_in) = self.one_in else { return };
        if frame.is_empty() || self.dice.roll(one_in) != 0 {
            return;
        }
        self.injected += 1;
        let at = self.dice.roll(frame.len() as u32) as usize;
        match self.dice.roll(4) {
            0 => frame[at] ^= 1 << self.dice.roll(8),
            1 => drop(frame.remove(at)),
            2 => frame.clear(),
            _ => frame.extend_from_within(..),
        }
    }
}

impl Bytes for Disturbed {
    type Error = std::io::Error;

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        let mut frame = bytes.to_vec();
        self.disturb(&mut frame);
        self.line.write_all(&frame)?;
        self.line.flush()
    }

    fn receive(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        // The line gives single bytes; faults are counted in frames, so a frame is collected first.
        while self.inbox.is_empty() {
            let mut piece = [0; 64];
            let count = match self.line.read(&mut piece) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => count,
                Err(error) => match error.kind() {
                    ErrorKind::WouldBlock | ErrorKind::TimedOut => return Ok(0),
                    ErrorKind::Interrupted => 0,
                    _ => return Err(error),
                },
            };
            for byte in &piece[..count] {
                self.frame.push(*byte);
                if *byte == 0 && self.frame.len() > 1 {
                    let mut frame = std::mem::take(&mut self.frame);
                    self.disturb(&mut frame);
                    self.inbox.extend(frame);
                }
            }
        }
        let count = bytes.len().min(self.inbox.len());
        for (place, byte) in bytes.iter_mut().zip(self.inbox.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}

/// Numbers for the faults (a congruential generator of 64 bits).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as u32
    }

    fn roll(&mut self, sides: u32) -> u32 {
        self.next() % sides
    }
}

/// The emulator, ended with the run.
pub(super) struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts the image in the emulator with its USART1 on a socket, and waits until the image is
/// heard.
///
/// `patience` is the timeout of a read after that.
pub(super) fn emulated(image: &Path, patience: Duration) -> Result<(Emulator, TcpStream), Refusal> {
    if !image.exists() {
        return Err(Refusal::new(format!(
            "there is no image {}; `cargo xtask pil` builds it, or: cargo build -p trendid --profile firmware \
             --target thumbv7em-none-eabihf --example pil",
            image.display()
        )));
    }
    let listener = TcpListener::bind("127.0.0.1:0").map_err(no_socket)?;
    let address = listener.local_addr().map_err(no_socket)?;
    let child = Command::new("qemu-system-arm")
        .args([
            "-machine",
            "netduinoplus2",
            "-display",
            "none",
            "-monitor",
            "none",
        ])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(["-serial", &format!("tcp:{address},nodelay=on"), "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .spawn()
        .map_err(|error| {
            Refusal::new(format!(
                "qemu-system-arm does not start ({error}); `cargo xtask setup` says how to get it"
            ))
        })?;
    let mut emulator = Emulator(child);
    listener.set_nonblocking(true).map_err(no_socket)?;
    let end = Instant::now() + START;
    loop {
        match listener.accept() {
            Ok((stream, _)) => return Ok((emulator, heard(stream, patience)?)),
            Err(_) if Instant::now() > end => {
                return Err(Refusal::new(
                    "the emulator did not open its serial line within 10 s",
                ));
            }
            Err(_) => std::thread::sleep(Duration::from_millis(10)),
        }
        if let Ok(Some(status)) = emulator.0.try_wait() {
            return Err(Refusal::new(format!("qemu-system-arm ended with {status}")));
        }
    }
}

/// The line when the image is heard on it; a read then gives up after `patience`.
fn heard(mut stream: TcpStream, patience: Duration) -> Result<TcpStream, Refusal> {
    stream.set_nonblocking(false).map_err(no_socket)?;
    stream.set_nodelay(true).map_err(no_socket)?;
    stream.set_read_timeout(Some(START)).map_err(no_socket)?;
    // What comes before the image listens is lost; its first byte says that it does.
    stream.read_exact(&mut [0]).map_err(|error| {
        Refusal::new(format!(
            "nothing was heard of the image in the emulator: {error}"
        ))
    })?;
    stream.set_read_timeout(Some(patience)).map_err(no_socket)?;
    Ok(stream)
}

fn no_socket(error: std::io::Error) -> Refusal {
    Refusal::new(format!("no socket for the emulator: {error}"))
}

/// A board on a serial port.
pub(super) fn serial(port: &str) -> Result<Box<dyn Line>, Refusal> {
    let port = serialport::new(port, 115_200)
        .timeout(Duration::from_millis(200))
        .open()
        .map_err(|error| Refusal::new(format!("{port}: {error}")))?;
    Ok(Box::new(port))
}
