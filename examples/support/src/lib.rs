//! What the firmware examples share. Each uses a part of it.
#![no_std]

pub mod button;
pub mod drive;
pub mod hash;
pub mod machine;
pub mod record;
pub mod reset;
pub mod rows;
pub mod survivor;

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod stack;
