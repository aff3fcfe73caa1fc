//! What a debugger reads behind the back of the processor: the log.

use trendid_example_support::ring::Ring;
use trendid_example_support::rtt::{Block, Channel};

/// Frames of the log.
pub(crate) static LOG: Ring<1024> = Ring::new();

// SAFETY: the name that debuggers look for; nothing else has it.
#[unsafe(export_name = "_SEGGER_RTT")]
#[used]
pub(crate) static RTT: Block<1, 0> = Block::new([Channel::new(c"defmt", &LOG)], []);
