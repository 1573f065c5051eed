//! A surface that lives long: thousands of frames take no more memory than the first ones did.
#![cfg(feature = "host")]

#[path = "common/mod.rs"]
mod common;

use glam::Vec3;
use hullform::gpu::{Cut, Fill, Residence, SurfaceOptions};
use hullform::mesh::{Model, builtin};
use hullform::method::{DepthTags, METHODS};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, prepare};

/// Set to the number of frames: 10000 take some minutes.
const FRAMES: &str = "HULLFORM_FRAMES";

/// Frames when nobody says how many.
const FEW: usize = 240;

/// After so many frames all levels, and tags at all of them, have been drawn.
const CYCLE: usize = 48;

/// What a process may grow by in any number of frames: a megabyte comes once, and then nothing in ten thousand (Mesa 22.3.6).
const GROWTH: u64 = 2 << 20;

fn frames() -> usize {
    let asked = std::env::var(FRAMES).ok();
    asked.map_or(FEW, |asked| asked.parse().expect("a number of frames"))
}

/// Bytes of this process in memory, where the system tells.
fn resident() -> Option<u64> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    let resident = pages.split_whitespace().nth(1)?;
    Some(resident.parse::<u64>().ok()? * 4096)
}

/// A wave through the model.
fn moved(model: &Model, frame: usize) -> Vec<[f32; 3]> {
    let wave = |p: Vec3| p + 0.1 * Vec3::Y * (3.0 * p.x + 0.1 * frame as f32).sin();
    let positions = model.positions().into_iter();
    positions.map(|p| wave(p).to_array()).collect()
}

/// Another level each frame, every other one by depth tags that move as well.
fn at(model: &Model, frame: usize) -> (Cut, Option<DepthTags>) {
    let spacing = [Spacing::Equal, Spacing::FractionalEven][frame / 8 % 2];
    let level = (1 + frame % 8) as f32;
    let tags = (0..model.mesh().vertex_count()).map(|vertex| ((vertex + frame) % 4) as f32);
    let tagged = frame % 2 == 1;
    (Cut { level, spacing }, tagged.then(|| DepthTags::new(tags)))
}

/// Frames after which the process is told, for those who ask for many.
const TOLD: [usize; 3] = [1_000, 5_000, 10_000];

/// Draws so many frames; the process is looked at if it is told by how much it may grow.
fn animate(gpu: &Gpu, residence: Residence, frames: usize, growth: Option<u64>) {
    let model = Model::new(builtin("cubes-2x2x2").expect("it is built in"));
    let options = SurfaceOptions {
        residence,
        greatest_level: 8.0,
        ..SurfaceOptions::default()
    };
    let workarounds = &gpu.device.info().workarounds;
    let prepared = prepare(&model, METHODS[0].name);
    let loaded = gpu.load(&model, prepared, workarounds, options);
    let mut loaded = loaded.expect("it fits");
    let mut early = (0, 0);
    let mut pieces = 0;
    for frame in 0..frames {
        let (cut, tags) = at(&model, frame);
        loaded.tags = tags;
        let positions = moved(&model, frame);
        loaded.replace_positions(&positions).expect("as many");
        let drawn = loaded.capture(cut, Fill::Discard).expect("it is drawn");
        assert_eq!(drawn.counters.overflows, 0, "frame {frame}");
        let allocated = gpu.device.allocated_bytes();
        let held = gpu.device.allocator().generate_report().allocations.len();
        let resident = resident().unwrap_or(0);
        if TOLD.contains(&(frame + 1)) {
            println!(
                "{residence:?}, {} frames: {resident} bytes resident, {allocated} on the device",
                frame + 1
            );
        }
        if frame < (frames / 4).max(CYCLE) {
            early = (allocated.max(early.0), resident.max(early.1));
            pieces = held.max(pieces);
            continue;
        }
        assert!(allocated <= early.0, "frame {frame}: {allocated} {early:?}");
        assert!(
            held <= pieces,
            "frame {frame}: {held} pieces of memory, {pieces} before"
        );
        let grown = resident.saturating_sub(early.1);
        assert!(
            growth.is_none_or(|most| grown < most),
            "{residence:?}, frame {frame}: {grown} bytes more"
        );
    }
    println!("{residence:?}: {frames} frames, at most {early:?} bytes");
}

/// Under validation no message; without it, since the layer keeps some kilobytes a submission (1.3.239), no memory either.
#[test]
fn frames_leave_nothing_behind() {
    let frames = frames().max(2 * CYCLE);
    // The process is looked at first, while its heap is small.
    for growth in [Some(GROWTH), None] {
        let Some(gpu) = Gpu::open_with(growth.is_none()) else {
            return;
        };
        for residence in Residence::ALL {
            animate(&gpu, residence, frames, growth);
        }
        gpu.finish();
    }
}
