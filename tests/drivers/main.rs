//! Drivers that fail: every call in turn, and draws that get lost, by a layer of our own in `tests/layer`.
#![cfg(all(feature = "cli", target_os = "linux"))]

#[path = "../common/mod.rs"]
mod common;

mod failures;
mod losses;
mod trial;
mod waits;
mod way;
