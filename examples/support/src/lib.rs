//! What the firmware examples share. Each uses a part of it.
#![no_std]

pub mod brown_out;
pub mod bus;
pub mod button;
pub mod drive;
pub mod guard;
pub mod hash;
pub mod machine;
pub mod pulse;
pub mod random;
pub mod record;
pub mod registers;
pub mod request;
pub mod reset;
pub mod ring;
pub mod rows;
pub mod rtt;
pub mod safe_output;
pub mod slots;
pub mod survivor;
pub mod watchdog;

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod clock;
// The log is that of this core alone.
#[cfg(all(target_os = "none", target_abi = "eabihf"))]
pub mod frames;
#[cfg(target_os = "none")]
pub mod stack;
