//! What the device computes, held to the CPU's twins, to the truth and to the predicted work.
//!
//! Everything runs under core and synchronization validation, which must stay silent to the end.
#![cfg(feature = "host")]

#[path = "../common/mod.rs"]
mod common;

mod backends;
mod cache;
mod edges;
mod flight;
mod hexagon;
mod lifetimes;
mod misuse;
mod points;
mod precision;
mod prepass;
mod ring;
mod scale;
mod shapes;
mod twins;
mod work;
