//! Passes over one another: whatever the fragment shader, positions are the same, so depths may be compared with EQUAL.

use ash::vk;
use hullform::gpu::{Backend, Fill, Shading, SurfaceOptions};
use hullform::method::{Displacement, METHODS};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, SPACINGS, cut, prepare};
use crate::shapes;

/// A pre-pass without a fragment shader, or with one, then the picture with EQUAL: no pixel differs from the picture alone. Somewhat
/// displaced, nothing is left of it.
fn check(gpu: &Gpu, method: &str, backend: Backend, spacing: Spacing) {
    let row = hullform::method::method(method).expect("it is one of the table");
    let shape = shapes::built_in("ngons");
    let model = shapes::under(shape.mesh(), row.schemes[0]).expect("the scheme knows its tags");
    if row.check_model(&model).is_err() {
        return;
    }
    let prepared = prepare(&model, method);
    let cut = cut(7.0, spacing);
    let options = SurfaceOptions {
        backend,
        rounds: 2,
        greatest_level: cut.level,
        ..SurfaceOptions::default()
    };
    let workarounds = &gpu.device.info().workarounds;
    let build = |fill, compare| {
        gpu.build(
            &prepared,
            (backend, options.residence),
            spacing,
            fill,
            compare,
        )
    };
    let plain = build(Fill::Solid(Shading::Patch), vk::CompareOp::LESS_OR_EQUAL);
    let equal = build(Fill::Solid(Shading::Patch), vk::CompareOp::EQUAL);
    let depth = build(Fill::Depth, vk::CompareOp::LESS_OR_EQUAL);
    let mut loaded = match gpu.load(&model, prepared.clone(), workarounds, options) {
        Ok(loaded) => loaded,
        Err(_) => panic!("{method} {backend:?} was chosen among those that can"),
    };
    let list = loaded.draw_list(cut).expect("it can be cut");
    let none = Displacement::default();
    let some = Displacement {
        height: 1e-3,
        frequency: 20.0,
    };
    let what = format!("{method} {backend:?} {spacing:?}");
    let picture = loaded.draw_over(&list, &[(&plain, none)]);
    let covered = |picture: &[u8]| picture.chunks(4).filter(|pixel| pixel[3] != 0).count();
    assert!(covered(&picture) > 300, "{what}: {}", covered(&picture));
    for first in [&depth, &plain] {
        let passes = loaded.draw_over(&list, &[(first, none), (&equal, none)]);
        assert!(passes == picture, "{what}: pixels differ");
    }
    let missed = loaded.draw_over(&list, &[(&depth, some), (&equal, none)]);
    assert!(
        2 * covered(&missed) < covered(&picture),
        "{what}: EQUAL compares nothing"
    );
}

#[test]
fn a_picture_after_a_pre_pass_is_the_picture() {
    let Some(gpu) = Gpu::open() else { return };
    for method in METHODS {
        check(&gpu, method.name, Backend::Tessellator, SPACINGS[0]);
    }
    check(&gpu, METHODS[0].name, Backend::Tessellator, SPACINGS[1]);
    let geometry = gpu.device.info().support.optional.geometry_shader;
    let without_ring = METHODS.last().expect("there are methods");
    for backend in [Backend::Pattern, Backend::Geometry] {
        if backend != Backend::Geometry || geometry {
            check(&gpu, without_ring.name, backend, SPACINGS[0]);
        }
    }
    gpu.finish();
}
