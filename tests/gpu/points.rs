//! Points that are computed before patches are drawn: by the host or by the device, with the same bits.

use hullform::gpu::Fill;
use hullform::mesh::Model;
use hullform::method::METHODS;

use crate::common::gpu::{Gpu, SPACINGS, bits, capturing, cut, prepare};
use crate::shapes;

/// Every method with points, on built-in shapes cut into triangles: a mesh that is moved on the device is drawn like one that was made where it is now.
#[test]
fn device_and_host_compute_points_with_the_same_bits() {
    let Some(gpu) = Gpu::open() else { return };
    let workarounds = &gpu.device.info().workarounds;
    let at = cut(3.0, SPACINGS[0]);
    let mut compared = 0;
    for (name, model) in shapes::triangular() {
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
            start.move_on_device(&positions);
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
