//! The arguments.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, ToSocketAddrs};
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Parser};
use trendid_host_tests::servo::population::family::Family;

/// A live page of a servo loop: what it does, what it has learned, and a button for every request
#[derive(Clone, Debug, Parser)]
#[command(
    name = "trendid-monitor",
    version,
    about,
    group = ArgGroup::new("source").required(true),
    after_help = "Examples:\n  trendid-monitor --axis 7\n  trendid-monitor --emulator\n  trendid-monitor --port /dev/ttyUSB0\n  trendid-monitor --replay out/record-1.csv"
)]
pub(crate) struct Args {
    /// A simulated axis of the population, with the loop on this computer: its seed
    #[arg(long, value_name = "SEED", group = "source")]
    pub axis: Option<u64>,
    /// A board on a serial port
    #[arg(long, value_name = "DEVICE", group = "source")]
    pub port: Option<String>,
    /// The firmware of the servo example in QEMU, with its simulated drive: built and started
    #[arg(long, group = "source")]
    pub emulator: bool,
    /// A target behind a TCP socket, e.g. an emulator that runs already
    #[arg(long, value_name = "HOST:PORT", group = "source")]
    pub tcp: Option<String>,
    /// A debugger's stub, e.g. of QEMU, and RTT in the memory of its target, which is stopped for
    /// every look: not for a machine
    #[arg(long, value_name = "HOST:PORT", group = "source")]
    pub gdb: Option<String>,
    /// A record that this monitor has written, in its own time
    #[arg(long, value_name = "FILE", group = "source")]
    pub replay: Option<PathBuf>,

    /// With --axis: its family
    #[arg(long, default_value = "pneumatic", value_parser = family())]
    pub family: Family,
    /// With --axis: draw from the whole range of the population and not from usual machines
    #[arg(long)]
    pub rare: bool,
    /// With --emulator: an image that is built already
    #[arg(long, value_name = "FILE", requires = "emulator", conflicts_with_all = ["axis", "port", "tcp", "gdb", "replay"])]
    pub image: Option<PathBuf>,
    /// With --emulator: over RTT in its memory in the place of its serial line
    #[arg(long, requires = "emulator", conflicts_with_all = ["axis", "port", "tcp", "gdb", "replay"])]
    pub rtt: bool,
    /// With --axis: how many times as fast as real time; 0 as fast as it is received
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = speed)]
    pub speed: f64,
    /// With --port: baud rate
    #[arg(long, default_value_t = 921_600)]
    pub baud: u32,
    /// Ms without a word from this program after which the target stops; 0 for never
    #[arg(long, default_value_t = 1000)]
    pub watchdog: u16,

    /// Port of the page; 0 for any
    #[arg(long, default_value_t = 8765)]
    pub http: u16,
    /// Serves other computers too, without encryption; needs --token
    #[arg(long, value_name = "ADDRESS", requires = "token")]
    pub listen: Option<IpAddr>,
    /// The token of the address, at least 16 letters or digits; default a random one
    #[arg(long, value_parser = token)]
    pub token: Option<String>,
    /// Folder of records and reports
    #[arg(long, default_value = "out")]
    pub out: PathBuf,

    #[command(flatten)]
    pub outputs: OutputArgs,
    /// Ends after so many seconds and prints what was received and lost
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub seconds: Option<f64>,
}

/// Where the samples go beside the page.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct OutputArgs {
    /// Records to this file from the first sample on
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Writes every sample to this file as MCAP, for Foxglove
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "FILE")]
    pub mcap: Option<PathBuf>,
    /// Sends every sample to Teleplot over UDP
    #[arg(long, value_name = "HOST:PORT", value_parser = endpoint)]
    pub teleplot: Option<SocketAddr>,
    /// Sends every sample as JSON over UDP, for PlotJuggler
    #[arg(long, value_name = "HOST:PORT", value_parser = endpoint)]
    pub plotjuggler: Option<SocketAddr>,
}

impl Args {
    /// Where the page is served.
    pub(crate) fn address(&self) -> SocketAddr {
        let ip = self.listen.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
        SocketAddr::new(ip, self.http)
    }
}

/// Where a name leads to.
fn endpoint(name: &str) -> Result<SocketAddr, String> {
    let found = name.to_socket_addrs().map_err(|error| error.to_string())?;
    let found: Vec<_> = found.collect();
    // A tool that listens at a name does so at that of IPv4, if at one only.
    let four = found.iter().find(|address| address.is_ipv4());
    four.or(found.first())
        .copied()
        .ok_or_else(|| "that name has no address".into())
}

fn family() -> impl TypedValueParser<Value = Family> {
    PossibleValuesParser::new(Family::ALL.map(Family::name))
        .try_map(|name| Family::from_name(&name).ok_or("there is no such family"))
}

fn speed(factor: &str) -> Result<f64, String> {
    let expected = || "expected a number from 0 to 100".to_owned();
    let factor: f64 = factor.parse().map_err(|_| expected())?;
    if (0.0..=100.0).contains(&factor) {
        Ok(factor)
    } else {
        Err(expected())
    }
}

/// Longest session that is asked for \[s\]: three years.
const LONGEST: f64 = 1e8;

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= LONGEST => Ok(seconds),
        _ => Err(format!("expected a number above 0 and up to {LONGEST}")),
    }
}

/// Shortest token that is taken.
const TOKEN: usize = 16;

fn token(token: &str) -> Result<String, String> {
    if token.len() >= TOKEN && token.bytes().all(|b| b.is_ascii_alphanumeric()) {
        Ok(token.to_owned())
    } else {
        Err(format!("expected at least {TOKEN} letters or digits"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_computers_are_served_with_a_token_of_the_user_only() {
        let parse = |words: &str| Args::try_parse_from(words.split(' '));
        assert!(parse("m --axis 1").is_ok_and(|a| a.address().ip().is_loopback()));
        assert!(parse("m --axis 1 --listen 0.0.0.0").is_err());
        assert!(parse("m --axis 1 --listen 0.0.0.0 --token short").is_err());
        let open = parse("m --axis 1 --listen 0.0.0.0 --token abcdefgh12345678").unwrap();
        assert!(!open.address().ip().is_loopback());
        assert!(parse("m").is_err() && parse("m --axis 1 --tcp 127.0.0.1:1").is_err());
        assert!(parse("m --axis 1 --family steam").is_err());
        assert!(parse("m --axis 1 --rtt").is_err() && parse("m --emulator --rtt").is_ok());
        assert!(parse("m --axis 1 --image x").is_err() && parse("m --emulator --image x").is_ok());
        for tool in ["teleplot", "plotjuggler"] {
            let sent = |to: &str| parse(&format!("m --axis 1 --{tool} {to}"));
            assert!(sent("127.0.0.1:47269").is_ok() && sent("localhost:47269").is_ok());
            assert!(sent("localhost").is_err() && sent("localhost:x").is_err());
        }
        for seconds in ["nan", "inf", "1e9999", "0", "-1", "x"] {
            assert!(parse(&format!("m --axis 1 --seconds={seconds}")).is_err());
        }
        assert!(parse("m --axis 1 --seconds 0.5").is_ok());
        assert!(
            parse("m --axis 1 --speed -1").is_err() && parse("m --axis 1 --speed nan").is_err()
        );
    }
}
