//! What the device would produce, evaluated on the CPU.

use hullform::frame::{DrawList, SurfaceOptions};
use hullform::gpu::Residence;
use hullform::mesh::Model;
use hullform::method::to_ptex;
use hullform::{Error, Result};
use rayon::prelude::*;

use crate::drawing;
use crate::options::{Chosen, Cutting};
use crate::output::{Point, Surface};

/// Tessellates `model` by the twin of the evaluation shader, on all cores.
pub fn evaluate(model: &Model, chosen: Chosen, cutting: Cutting) -> Result<Surface> {
    if cutting.adaptive.is_some() {
        return Err(Error::Option {
            option: "--adaptive",
            problem: "depth tags go by a picture, which a device frames".into(),
            remedy: "leave it out, or choose --on device".into(),
        });
    }
    let prepared = drawing::prepare(model, chosen)?;
    let options = SurfaceOptions {
        backend: cutting.backend,
        residence: Residence::Cache,
        ring_bytes: u64::MAX,
        greatest_level: cutting.cut.level,
        ..Default::default()
    };
    let list = DrawList::new(&prepared, &options, None, cutting.cut, None)?;
    let tessellated = list.tessellate(&prepared, &prepared.controls(model.positions()))?;
    let placement = model.placement();
    let points = tessellated.points.par_iter().map(|point| {
        let pass = &prepared.passes[point.pass as usize];
        let (slot, uv) = pass.face_at(point.patch as usize, point.uv);
        let patch = &pass.patches[slot];
        Point {
            face: patch.ptex,
            uv: to_ptex(patch, uv),
            position: placement
                .position(point.surface.position.as_dvec3())
                .to_array(),
            normal: point.surface.normal.to_array(),
            texture: pass.texture_coordinates(point.patch as usize, point.uv),
        }
    });
    Ok(Surface {
        points: points.collect(),
        triangles: tessellated.triangles,
    })
}
