//! What the firmware examples share. Each uses a part of it.
#![no_std]

pub mod drive;
pub mod hash;
pub mod record;
pub mod rows;

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod stack;
