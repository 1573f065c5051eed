//! Drivers that fail: every call in turn, and draws that get lost, by a layer of our own in `tests/layer`.
#![cfg(all(feature = "cli", target_os = "linux"))]

#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "view")]
#[allow(dead_code, reason = "nobody presses keys here")]
#[path = "../view/display.rs"]
mod display;
mod failures;
mod losses;
#[cfg(feature = "view")]
mod swapchain;
mod trial;
mod waits;
mod way;
