//! `trendid pil`: the controller on a processor, emulated or real, against the simulated servo, bit for bit.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use trendid_host_tests::reference::REFERENCE;
use trendid_pil_link::{
    Bytes, Controller, Counters, Exchange, ExchangeError, Reply, SAMPLE_TIME, flags,
};

use crate::output::{self, Refusal};

/// How long the emulator may take to open its line.
const START: Duration = Duration::from_secs(10);

/// How often a sample is sent before the target is given up.
const ATTEMPTS: u32 = 20;

#[derive(clap::Args)]
#[command(after_help = "Examples:
  cargo xtask pil                      builds the image and runs it in the emulator
  trendid pil --samples 2000 --faults 20
  trendid pil --port /dev/ttyUSB0      a board with the image (not tried on hardware)")]
pub struct PilArgs {
    /// Image for the emulator, built by `cargo xtask pil`
    #[arg(
        long,
        default_value = "target/thumbv7em-none-eabihf/firmware/examples/pil"
    )]
    image: PathBuf,
    /// Serial port of a board that runs the image, instead of the emulator
    #[arg(long, conflicts_with = "image")]
    port: Option<String>,
    /// Samples of 1 ms
    #[arg(long, default_value_t = 5000)]
    samples: u32,
    /// Disturbs one frame in N in each direction: a wrong bit, a lost byte, a lost frame, a frame that comes twice
    #[arg(long, value_name = "N")]
    faults: Option<u32>,
    /// Seed of noise and faults
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Prints the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the plant against the target and compares every number with the same controller here.
pub fn run(args: &PilArgs) -> Result<(), Refusal> {
    if args.samples == 0 || args.faults == Some(0) {
        return Err(Refusal::new("--samples and --faults must be at least 1"));
    }
    let mut emulator = None;
    let (line, name): (Box<dyn Line>, _) = match &args.port {
        Some(port) => (serial(port)?, port.clone()),
        None => {
            // Only a disturbed line loses frames; a busy machine alone must not look like one.
            let patience = Duration::from_millis(if args.faults.is_some() { 50 } else { 1000 });
            let (guard, stream) = emulated(&args.image, patience)?;
            emulator = Some(guard);
            (Box::new(stream), "qemu-system-arm netduinoplus2".to_owned())
        }
    };
    let mut line = Disturbed {
        line,
        dice: Dice(args.seed),
        one_in: args.faults,
        injected: 0,
        frame: Vec::new(),
        inbox: VecDeque::new(),
    };
    let result = compare(args, &mut line)?;
    drop(emulator);
    report(args, &name, &result, line.injected);
    match result.different {
        None => Ok(()),
        Some(difference) => Err(Refusal::new(difference)),
    }
}

/// What came out of a run.
struct Outcome {
    samples: u32,
    numbers: u64,
    different: Option<String>,
    last: Option<Reply>,
    host: Counters,
}

/// The lockstep: plant, target and the controller here, sample by sample.
fn compare(args: &PilArgs, line: &mut Disturbed) -> Result<Outcome, Refusal> {
    let mut beside = Controller::try_new()?;
    let mut plant = REFERENCE.plant(f64::from(SAMPLE_TIME));
    let mut noise = Dice(args.seed ^ 0x9E37_79B9_7F4A_7C15);
    // Two runs against the same board need different first numbers.
    let first = std::time::SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(1, |t| t.as_millis() as u32);
    let mut exchange = Exchange::new(first, ATTEMPTS);
    let bar = output::progress(u64::from(args.samples), "samples");
    let mut outcome = Outcome {
        samples: 0,
        numbers: 0,
        different: None,
        last: None,
        host: Counters::default(),
    };
    for k in 0..args.samples {
        // White noise of +-10 um on a position in mm; every 997th measurement is marked as bad.
        let y = (plant.output() + 0.02 * (noise.unit() - 0.5)) as f32;
        let reset = if k == 0 { flags::RESET } else { 0 };
        let invalid = if k % 997 == 996 { flags::INVALID } else { 0 };
        let reply = exchange
            .exchange(line, y, reset | invalid)
            .map_err(|error| match error {
                ExchangeError::Line(error) => {
                    Refusal::new(format!("the line to the target failed: {error}"))
                }
                ExchangeError::NoReply(_) => Refusal::new(format!(
                    "the target did not answer sample {k} in {ATTEMPTS} attempts"
                )),
            })?;
        let expected = beside.update(y, reset | invalid);
        outcome.samples += 1;
        outcome.numbers += 2 + expected.parameters.len() as u64;
        if !same(&reply, &expected) {
            outcome.different = Some(format!(
                "sample {k} differs: target {reply:?}, host {expected:?}"
            ));
            break;
        }
        plant.step(&[f64::from(reply.u)]);
        outcome.last = Some(reply);
        bar.inc(1);
    }
    bar.finish_and_clear();
    outcome.host = exchange.counters();
    Ok(outcome)
}

/// Whether the numbers are the same to the last bit; the counters belong to the link.
fn same(target: &Reply, host: &Reply) -> bool {
    let bits = |reply: &Reply| -> Vec<u32> {
        let numbers = [reply.u, reply.innovation];
        numbers
            .iter()
            .chain(&reply.parameters)
            .map(|number| number.to_bits())
            .collect()
    };
    bits(target) == bits(host) && target.status == host.status
}

fn report(args: &PilArgs, name: &str, outcome: &Outcome, injected: u32) {
    let target = outcome
        .last
        .as_ref()
        .map(|reply| reply.counters)
        .unwrap_or_default();
    let theta: Vec<f32> = outcome
        .last
        .iter()
        .flat_map(|reply| reply.parameters.iter().copied())
        .collect();
    let identical = outcome.different.is_none();
    if args.json {
        let counters = |c: &Counters| serde_json::json!({"corrupt": c.corrupt, "lost": c.lost, "repeated": c.repeated});
        output::emit_json(&serde_json::json!({
            "target": name,
            "samples": outcome.samples,
            "numbers": outcome.numbers,
            "identical": identical,
            "parameters": theta.iter().map(|value| output::number32(*value)).collect::<Vec<_>>(),
            "injected": injected,
            "seen_by_target": counters(&target),
            "seen_by_host": counters(&outcome.host),
        }));
        return;
    }
    let mut text = format!(
        "{} samples on {name}: {} numbers {}\n",
        outcome.samples,
        outcome.numbers,
        if identical {
            "bit-identical to the host"
        } else {
            "compared, then a difference"
        },
    );
    if let [a1, a2, b0] = theta[..] {
        let [_, t1, t2] = REFERENCE.a();
        text += &format!("target's estimate  a1 {a1:.2}  a2 {a2:.3}  b0 {b0:.0}\n");
        text += &format!(
            "truth              a1 {t1:.2}  a2 {t2:.3}  b0 {:.0}\n",
            REFERENCE.b0()
        );
    }
    let row = |who: &str, c: &Counters| {
        format!(
            "{who}: {} corrupt, {} lost, {} repeated\n",
            c.corrupt, c.lost, c.repeated
        )
    };
    text += &format!("faults injected: {injected}; ");
    text += &row("seen by the target", &target);
    text += &row("seen by the host", &outcome.host);
    output::emit(&text);
}

/// A byte stream that gives up reading after its timeout.
trait Line: Read + Write {}
impl<T: Read + Write> Line for T {}

/// A line that disturbs frames on purpose.
struct Disturbed {
    line: Box<dyn Line>,
    dice: Dice,
    one_in: Option<u32>,
    injected: u32,
    /// The frame that is coming in.
    frame: Vec<u8>,
    /// Bytes of complete frames that nobody has taken yet.
    inbox: VecDeque<u8>,
}

impl Disturbed {
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

/// Numbers for noise and faults (a congruential generator of 64 bits).
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

    /// Uniform in 0..1.
    fn unit(&mut self) -> f64 {
        f64::from(self.next()) / f64::from(1u32 << 31)
    }
}

/// The emulator, ended with the run.
struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts the image in the emulator with its USART1 on a socket.
fn emulated(image: &Path, patience: Duration) -> Result<(Emulator, TcpStream), Refusal> {
    if !image.exists() {
        return Err(Refusal::new(format!(
            "there is no image {}; `cargo xtask pil` builds it, or: cargo build -p trendid --profile firmware \
             --target thumbv7em-none-eabihf --example pil",
            image.display()
        )));
    }
    let failed =
        |error: std::io::Error| Refusal::new(format!("no socket for the emulator: {error}"));
    let listener = TcpListener::bind("127.0.0.1:0").map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
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
    listener.set_nonblocking(true).map_err(failed)?;
    let end = Instant::now() + START;
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false).map_err(failed)?;
                stream.set_nodelay(true).map_err(failed)?;
                stream.set_read_timeout(Some(patience)).map_err(failed)?;
                return Ok((emulator, stream));
            }
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

/// A board on a serial port.
fn serial(port: &str) -> Result<Box<dyn Line>, Refusal> {
    let port = serialport::new(port, 115_200)
        .timeout(Duration::from_millis(200))
        .open()
        .map_err(|error| Refusal::new(format!("{port}: {error}")))?;
    Ok(Box::new(port))
}
