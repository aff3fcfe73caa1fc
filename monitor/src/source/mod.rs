//! Where the telemetry comes from: bytes of the wire, whatever is at its other end.

pub(crate) mod axis;
mod call;
mod channel;
mod emulator;
mod gdb;
mod line;
pub(crate) mod replay;
mod rtt;
pub(crate) mod simulated;

#[cfg(test)]
mod tests;

use crate::args::Args;
use channel::Line;
pub(crate) use channel::{Said, Source};

impl Source {
    /// Starts what the arguments name.
    pub(crate) fn start(args: &Args) -> Self {
        let args = args.clone();
        Self::of(move |line| run(&args, line))
    }
}

fn run(args: &Args, line: Line) {
    if let Some(seed) = args.axis {
        axis::run(args, seed, line);
    } else if let Some(file) = &args.replay {
        replay::run(file, line);
    } else if let Some(device) = &args.port {
        line::over_port(device, args.baud, line);
    } else if let Some(address) = &args.tcp {
        line::over_tcp(address, line);
    } else if let Some(address) = &args.gdb {
        gdb::run(address, line);
    } else if args.emulator {
        emulator::run(args, line);
    }
}
