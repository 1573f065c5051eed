//! Many patches at high levels, where drivers have their limits: with the known faults worked around, all arrive.

use hullform::gpu::{Cut, Fill, Shading};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, capturing, cut, prepare};
use crate::precision::from_twin;
use crate::shapes;

/// Each patch arrives once with all of its vertices, where its twin has them.
fn assert_complete(gpu: &Gpu, name: &str, method: &str, cut: Cut) {
    let model = shapes::built_in(name);
    let prepared = prepare(&model, method);
    let options = capturing(&prepared, &[cut]);
    let workarounds = &gpu.device.info().workarounds;
    let loaded = gpu.load(&model, prepared, workarounds, options);
    let mut loaded = loaded.expect("the ring holds a patch");
    let frame = loaded
        .capture(cut, Fill::Solid(Shading::Patch))
        .expect("it is drawn");
    assert_eq!(frame.counters.overflows, 0);
    for (pass, vertices) in loaded.prepared().passes.iter().zip(&frame.passes) {
        let mut patches = vertices.chunk_by(|a, b| a.patch_number == b.patch_number);
        for patch in 0..pass.patches.len() {
            let there = patches.next().expect("a patch is missing");
            assert_eq!(there[0].patch_number as usize, patch);
            assert_eq!(there.len(), cut.vertices(pass, patch) as usize);
        }
    }
    let worst = from_twin(&model, loaded.prepared(), &frame, 97);
    assert!(worst.position <= 1e-6 && worst.normal <= 0.1, "{worst:?}");
}

#[test]
fn a_thousand_patches_at_level_8_all_arrive() {
    let Some(gpu) = Gpu::open() else { return };
    for method in ["quadtree", "flat"] {
        assert_complete(&gpu, "cubes-8x6x4", method, cut(8.0, Spacing::Equal));
    }
    gpu.finish();
}

#[test]
fn sixty_four_patches_at_level_64_all_arrive() {
    let Some(gpu) = Gpu::open() else { return };
    for spacing in [Spacing::Equal, Spacing::FractionalEven] {
        assert_complete(&gpu, "cubes-11x1x1", "quadtree", cut(64.0, spacing));
    }
    gpu.finish();
}
