//! What the device computes, held to the CPU's twins, to the truth and to the predicted work.
//!
//! Everything runs under core and synchronization validation, which must stay silent to the end.
#![cfg(feature = "host")]

#[path = "../common/mod.rs"]
mod common;

mod backends;
mod cache;
mod canvas;
mod compact;
mod culling;
mod decide;
mod edges;
mod edits;
mod flight;
mod hexagon;
mod instances;
mod lifetimes;
mod macro_faces;
mod memory;
mod misuse;
mod own;
mod points;
mod precision;
mod prepass;
mod recording;
mod ring;
mod scale;
mod shapes;
mod tangents;
mod targets;
mod twins;
mod work;
