//! Points that are computed before patches are drawn: by the host or by the device, with the same bits.

use glam::Vec3;
use hullform::gpu::Fill;
use hullform::mesh::{Model, Scheme, builtin};
use hullform::method::METHODS;

use crate::common::gpu::{Gpu, SPACINGS, bits, capturing, cut, prepare};
use crate::shapes;

/// Every method with points, on built-in shapes cut into triangles, and on a hub: a mesh that is moved on the device is drawn like one that was made where it is now.
#[test]
fn device_and_host_compute_points_with_the_same_bits() {
    let Some(gpu) = Gpu::open() else { return };
    let workarounds = &gpu.device.info().workarounds;
    let at = cut(3.0, SPACINGS[0]);
    let mut compared = 0;
    let hub = ("builtin pole-66".to_owned(), shapes::built_in("pole-66"));
    for (name, model) in shapes::triangular().into_iter().chain([hub]) {
        // The shared shapes would show nothing more.
        let small = name.starts_with("builtin") && model.mesh().vertex_count() < 500;
        for method in METHODS
            .iter()
            .filter(|method| small && method.check_model(&model).is_ok())
        {
            let prepared = prepare(&model, method.name);
            if prepared.points.count == 0 {
                continue;
            }
            let moved = Model::new(shapes::moved(model.mesh(), 0.37, [0.0; 3]));
            let options = capturing(&prepared, &[at]);
            let start = gpu.load(&model, prepared, workarounds, options);
            let mut start = start.expect("nothing needs the ring");
            let positions: Vec<[f32; 3]> = moved.positions().iter().map(|p| p.to_array()).collect();
            start.move_on_device(&positions, at);
            let by_device = start.capture(at, Fill::Discard).expect("it is drawn");
            let made = gpu.load(&moved, prepare(&moved, method.name), workarounds, options);
            let by_host = made.expect("as before").capture(at, Fill::Discard);
            let by_host = by_host.expect("it is drawn");
            let [by_device, by_host]: [Vec<[u32; 9]>; 2] =
                [by_device, by_host].map(|frame| frame.passes.iter().flatten().map(bits).collect());
            assert_eq!(by_device, by_host, "{name} {}", method.name);
            compared += by_host.len();
        }
    }
    assert!(compared > 10_000, "{compared} vertices");
    gpu.finish();
}

/// An engine may write positions of any size: normals stay, to the bit, and positions follow.
#[test]
fn normals_know_no_size_of_what_an_engine_writes() {
    let Some(gpu) = Gpu::open() else { return };
    let workarounds = &gpu.device.info().workarounds;
    let at = cut(2.0, SPACINGS[0]);
    let mesh = builtin("cube").expect("it is built in");
    let mut compared = 0;
    for model in [Scheme::Loop, Scheme::CatmullClark].map(|scheme| shapes::under(&mesh, scheme)) {
        let model = model.expect("a cube has no tags");
        for method in METHODS.iter().filter(|m| m.check_model(&model).is_ok()) {
            let prepared = prepare(&model, method.name);
            if prepared.points.count == 0 {
                continue;
            }
            let options = capturing(&prepared, &[at]);
            let loaded = gpu.load(&model, prepared, workarounds, options);
            let mut loaded = loaded.expect("nothing needs the ring");
            let mut drawn = |exponent: i32| {
                let grown = |p: Vec3| (p * 2f32.powi(exponent)).to_array();
                let positions: Vec<[f32; 3]> = model.positions().into_iter().map(grown).collect();
                loaded.move_on_device(&positions, at);
                let frame = loaded.capture(at, Fill::Discard).expect("it is drawn");
                frame.passes.concat()
            };
            let one = drawn(0);
            for exponent in [-90, -70, 70, 120] {
                for (own, right) in drawn(exponent).iter().zip(&one) {
                    let name = method.name;
                    let grown = right.position.map(|x| x * 2f32.powi(exponent));
                    assert_eq!(own.position, grown, "{name} 2^{exponent}");
                    assert_eq!(own.normal, right.normal, "{name} 2^{exponent}");
                    compared += usize::from(right.normal != [0.0; 3]);
                }
            }
        }
    }
    assert!(compared > 1_000, "{compared} vertices");
    gpu.finish();
}
