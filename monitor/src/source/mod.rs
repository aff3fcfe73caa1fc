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
use crate::record;
use channel::Line;
pub(crate) use channel::{Said, Source};

impl Source {
    /// Starts what the arguments name.
    ///
    /// # Errors
    /// A file that is not there or is no record.
    pub(crate) fn start(args: &Args) -> Result<Self, String> {
        let args = args.clone();
        if let Some(image) = args.image.as_ref().filter(|image| !image.is_file()) {
            return Err(format!("{}: no such file", image.display()));
        }
        if let Some(file) = &args.replay {
            let rows = record::read(file)?;
            let name = file.display().to_string();
            return Ok(Self::of(move |line| replay::run(&rows, &name, line)));
        }
        Ok(Self::of(move |line| run(&args, line)))
    }
}

fn run(args: &Args, line: Line) {
    if let Some(seed) = args.axis {
        axis::run(args, seed, line);
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
