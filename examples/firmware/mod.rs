//! What the firmware examples share. Each uses a part of it.
#![allow(dead_code, reason = "every example takes what it needs")]

pub mod hash;
pub mod record;
pub mod rows;

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod stack;
