//! Rigid instances of a pose: views of it, any number in one draw, and each at a level of its own.

use std::ops::Range;

use ash::vk;
use hullform::gpu::{
    Backend, DrawList, Fill, Residence, Shading, Slots, SurfaceOptions, View, Workaround,
};
use hullform::mesh::Model;
use hullform::method::{Displacement, METHODS};
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use crate::common::gpu::{Gpu, Loaded, SPACINGS, cut, prepare};
use crate::shapes;

/// Views beside one another, in as many rows as columns; no two look alike.
pub fn grid(side: u32) -> Vec<View> {
    let cells = (0..side * side).map(|cell| {
        let (x, y) = ((cell % side) as f32, (cell / side) as f32);
        let scale = 0.5 / side as f32;
        let at = |cell: f32| (2.0 * cell + 1.0) / side as f32 - 1.0;
        let turn = glam::Mat4::from_rotation_y(0.3 * cell as f32);
        let place = glam::Mat4::from_cols_array_2d(&[
            [scale, 0.0, 0.0, 0.0],
            [0.0, -scale, 0.0, 0.0],
            [0.0, 0.0, -0.1, 0.0],
            [at(x), at(y), 0.5, 1.0],
        ]);
        View {
            clip_from_model: (place * turn).to_cols_array_2d(),
            eye: turn
                .transpose()
                .transform_point3(glam::Vec3::Z * 20.0)
                .into(),
            displacement: Displacement::default(),
        }
    });
    cells.collect()
}

/// What is drawn: lists with the views of each draw.
type Draws<'a> = Vec<(&'a DrawList, Range<u32>)>;

/// A picture of draws in one submission.
fn picture(
    gpu: &Gpu,
    loaded: &Loaded<'_>,
    views: &[View],
    draws: &Draws<'_>,
    spacing: Spacing,
    shading: Shading,
) -> Vec<u8> {
    let options = loaded.surface().options();
    let makers = (options.backend, options.residence);
    let compare = vk::CompareOp::LESS_OR_EQUAL;
    let fill = Fill::Solid(shading);
    let pipelines = gpu.build(loaded.prepared(), makers, spacing, fill, compare);
    let device = gpu.device.raw();
    // SAFETY: recording on the device that made everything, in the order that `cmd_draw` asks for.
    let drawn = gpu.device.submit(|cmd| unsafe {
        let surface = loaded.surface();
        surface.cmd_prepare(device, cmd, views)?;
        gpu.target().begin(cmd, [0.0; 4]);
        for (list, views) in draws {
            for batch in list.batches() {
                surface.cmd_draw(device, cmd, gpu.layout(), &pipelines, views.clone(), batch)?;
            }
        }
        gpu.target().end(cmd);
        gpu.target().cmd_copy_to_host(cmd);
        Ok(())
    });
    drawn.expect("it is executed");
    loaded.pixels()
}

fn covered(picture: &[u8]) -> usize {
    picture.chunks(4).filter(|pixel| pixel[3] != 0).count()
}

fn load<'a>(
    gpu: &'a Gpu,
    model: &Model,
    method: &str,
    workarounds: &[&'static Workaround],
    options: SurfaceOptions,
) -> Loaded<'a> {
    let loaded = gpu.load(model, prepare(model, method), workarounds, options);
    loaded.unwrap_or_else(|error| panic!("{method} {options:?}: {error}"))
}

/// A draw a view.
fn each(list: &DrawList) -> Draws<'_> {
    (0..100).map(|view| (list, view..view + 1)).collect()
}

/// A hundred views in one draw a batch, with and without the driver's bound on an instance: no pixel differs from those of a draw each.
#[test]
fn one_draw_of_many_views_makes_the_picture_of_a_draw_each() {
    let Some(gpu) = Gpu::open() else { return };
    let views = grid(10);
    let [first, last] = [METHODS[0].name, METHODS[METHODS.len() - 1].name];
    let geometry = gpu.device.info().support.optional.geometry_shader;
    for (method, backend, residence) in [
        (first, Backend::Tessellator, Residence::Cache),
        (first, Backend::Pattern, Residence::Cache),
        (first, Backend::Geometry, Residence::Cache),
        (last, Backend::Tessellator, Residence::Ring),
        (last, Backend::Pattern, Residence::Ring),
        (last, Backend::Geometry, Residence::Ring),
    ] {
        if backend == Backend::Geometry && !geometry {
            continue;
        }
        let options = SurfaceOptions {
            backend,
            residence,
            greatest_level: 5.0,
            views: 100,
            ..SurfaceOptions::default()
        };
        let model = shapes::built_in("ngons");
        for workarounds in [&gpu.device.info().workarounds[..], &[]] {
            let mut loaded = load(&gpu, &model, method, workarounds, options);
            for (spacing, shading) in SPACINGS.into_iter().zip([Shading::Lit, Shading::Patch]) {
                if backend != Backend::Tessellator && spacing != Spacing::Equal {
                    continue;
                }
                let list = loaded.draw_list(cut(5.0, spacing)).expect("a cut");
                let together = vec![(&list, 0..100)];
                let one = picture(&gpu, &loaded, &views, &together, spacing, shading);
                let many = picture(&gpu, &loaded, &views, &each(&list), spacing, shading);
                assert!(covered(&many) > 600, "{}", covered(&many));
                assert!(one == many, "{method} {backend:?} {shading:?}");
                // And in parts, the last of which begins in the middle of nothing.
                let parts = vec![(&list, 0..37), (&list, 37..37), (&list, 37..100)];
                let parts = picture(&gpu, &loaded, &views, &parts, spacing, shading);
                assert!(parts == many, "{method} {backend:?} {shading:?}, in parts");
            }
        }
    }
    gpu.finish();
}

/// Lists of several uniform cuts need nothing of the host, so one slot draws them all in a frame, from the points of the deepest.
#[test]
fn instances_have_a_level_each_and_one_slot() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let views = grid(3);
    let ranges = [0..4, 4..6, 6..9];
    let levels = [8.0, 3.0, 1.0];
    let options = SurfaceOptions {
        residence: Residence::Cache,
        greatest_level: 8.0,
        views: 9,
        ..SurfaceOptions::default()
    };
    let spacing = Spacing::FractionalEven;
    let workarounds = &gpu.device.info().workarounds;
    let (method, shading) = (METHODS[0].name, Shading::Normal);
    let mut loaded = load(&gpu, &model, method, workarounds, options);
    let lists = levels.map(|level| loaded.draw_list(cut(level, spacing)).expect("a cut"));
    assert!(lists.iter().all(|list| !list.has_decisions()));
    let draws = lists.iter().zip(ranges.clone()).collect();
    let together = picture(&gpu, &loaded, &views, &draws, spacing, shading);
    // Each alone, with no more in its cache than its level needs.
    let mut apart = vec![0; together.len()];
    for (level, range) in levels.into_iter().zip(ranges) {
        let mut alone = load(&gpu, &model, method, workarounds, options);
        let list = alone.draw_list(cut(level, spacing)).expect("a cut");
        let draws = vec![(&list, range)];
        let picture = picture(&gpu, &alone, &views, &draws, spacing, shading);
        assert!(covered(&picture) > 40, "{}", covered(&picture));
        for (all, own) in apart.chunks_mut(4).zip(picture.chunks(4)) {
            if own[3] != 0 {
                all.copy_from_slice(own);
            }
        }
    }
    assert!(together == apart, "an instance differs from itself alone");
    drop(loaded);
    gpu.finish();
}

/// In the ring each view's points are computed anew: several in one draw would share slots. Where no patch uses it there is nothing to share.
#[test]
fn several_views_in_one_draw_are_refused_where_points_are_in_the_ring() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let at = cut(4.0, Spacing::Equal);
    for slots in [Slots::Counter, Slots::Host] {
        let options = SurfaceOptions {
            slots,
            greatest_level: 4.0,
            ..SurfaceOptions::default()
        };
        let mut loaded = load(&gpu, &model, METHODS[0].name, &[], options);
        let list = loaded.draw_list(at).expect("a cut");
        let makers = (Backend::Tessellator, Residence::Ring);
        let compare = vk::CompareOp::LESS_OR_EQUAL;
        let prepared = loaded.prepared();
        let pipelines = gpu.build(prepared, makers, at.spacing, Fill::Discard, compare);
        let device = gpu.device.raw();
        let (mut refused, mut drawn) = (0, 0);
        for batch in list.batches() {
            // SAFETY: recording on the device that made everything; what is refused records nothing.
            let result = gpu.device.submit(|cmd| unsafe {
                let surface = loaded.surface();
                surface.cmd_prepare(device, cmd, &grid(2))?;
                gpu.target().begin(cmd, [0.0; 4]);
                let (layout, views) = (gpu.layout(), 1..3);
                let drawn = surface.cmd_draw(device, cmd, layout, &pipelines, views, batch);
                gpu.target().end(cmd);
                drawn
            });
            match result {
                Ok(()) => drawn += 1,
                Err(Error::Misuse(misuse)) => {
                    assert_eq!(misuse, Misuse::ViewsInRing);
                    assert!(batch.points() > 0);
                    refused += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
        assert!(refused > 0 && drawn > 0, "{refused} {drawn}");
        drop(loaded);
    }
    gpu.finish();
}
