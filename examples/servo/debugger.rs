//! What a debugger reads and writes behind the back of the processor: the log, and the wire where
//! it runs over RTT.
//!
//! Telemetry has the same number in both directions, since servers of debuggers offer a number as
//! one socket, e.g. OpenOCD's `rtt server start 9090 1`; the number 0 from the debugger is that of
//! keyboards and not used.

use trendid_example_support::ring::Ring;
use trendid_example_support::rtt::{Block, Channel};

/// Frames of the log.
pub(crate) static LOG: Ring<1024> = Ring::new();

/// The wire to the debugger: more than 0.1 s of every sample, since a debugger looks when it has
/// time; and from it.
pub(crate) static TELEMETRY: Ring<8192> = Ring::new();
pub(crate) static REQUESTS: Ring<512> = Ring::new();

/// The number of the wire in both directions.
pub(crate) const WIRE: usize = 1;

// SAFETY: the name that debuggers look for; nothing else has it.
#[unsafe(export_name = "_SEGGER_RTT")]
#[used]
pub(crate) static RTT: Block<2, 2> = Block::new(
    [
        Channel::new(c"defmt", &LOG),
        Channel::new(c"telemetry", &TELEMETRY),
    ],
    [Channel::absent(), Channel::new(c"telemetry", &REQUESTS)],
);
