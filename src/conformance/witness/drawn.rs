//! What a method drew, in the order in which one can compare neighbours.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::Subject;
use crate::abi::Captured;
use crate::conformance::capture::{captured, cut, vertices};
use crate::conformance::{Context, models};
use crate::error::Result;
use crate::gpu::Fill;
use crate::mesh::Model;
use crate::method::Pass;
use crate::tessellation::{Domain, Spacing};

/// The vertices of a patch as they were captured.
pub struct Patch<'a> {
    /// Its pass.
    pub pass: &'a Pass,
    /// Its number there.
    pub number: usize,
    /// Its vertices.
    pub vertices: &'a [Captured],
}

impl Patch<'_> {
    /// The ptex face that it belongs to.
    pub fn ptex(&self) -> u32 {
        self.pass.patches[self.number].ptex
    }

    /// The vertices by where they are on a grid of so many segments; others are not there.
    pub fn grid(&self, segments: u32) -> HashMap<[u32; 2], &Captured> {
        let scale = segments as f32;
        let placed = self.vertices.iter().filter_map(|vertex| {
            let place = vertex.uv.map(|x| x * scale);
            let whole = place.iter().all(|x| x.fract() == 0.0);
            whole.then(|| (place.map(|x| x as u32), vertex))
        });
        placed.collect()
    }

    /// The vertices by their distance from a corner of the domain.
    pub fn at_corner(&self, corner: usize) -> Vec<&Captured> {
        let [x, y] = match self.pass.domain {
            Domain::Quads => [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][corner],
            Domain::Triangles => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][corner],
        };
        let off = |vertex: &Captured| {
            let [u, v] = [vertex.uv[0] - x, vertex.uv[1] - y];
            match self.pass.domain {
                Domain::Quads => u * u + v * v,
                // As long as in an equilateral triangle.
                Domain::Triangles => u * u + v * v + u * v,
            }
        };
        let mut sorted: Vec<&Captured> = self.vertices.iter().collect();
        sorted.sort_by(|a, b| off(a).total_cmp(&off(b)));
        sorted
    }

    /// Whether a vertex lies on no edge of the domain.
    pub fn is_inside(&self, vertex: &Captured) -> bool {
        let [u, v] = vertex.uv;
        let last = match self.pass.domain {
            Domain::Quads => u < 1.0 && v < 1.0,
            Domain::Triangles => u + v < 1.0 - 1e-5,
        };
        u > 0.0 && v > 0.0 && last
    }
}

/// The most vertices that are looked at. Of larger models every other patch is drawn, or every third, and so on.
const MOST_VERTICES: u32 = 200_000;

/// Draws a subject at a level, spoils what came by `spoil` where a fault is seeded, and shows each patch.
pub fn each_patch(
    context: &Context,
    subject: &Subject<'_>,
    level: f32,
    spoil: fn(&mut Captured),
    mut show: impl FnMut(&Patch<'_>) -> Result<()>,
) -> Result<()> {
    let cut = cut(level, Spacing::Equal);
    let step = vertices(&subject.prepared, cut).div_ceil(MOST_VERTICES) as usize;
    let prepared = match step {
        0 | 1 => subject.prepared.clone(),
        step => models::chosen(&subject.prepared, |_, number| number % step == 0),
    };
    let passes = prepared.passes.clone();
    let mut frame = captured(context, subject.model, prepared, cut, Fill::Discard)?;
    if context.is_wrong() {
        frame.passes.iter_mut().flatten().for_each(spoil);
    }
    for (pass, vertices) in passes.iter().zip(&frame.passes) {
        for vertices in vertices.chunk_by(|a, b| a.patch_number == b.patch_number) {
            show(&Patch {
                pass,
                number: vertices[0].patch_number as usize,
                vertices,
            })?;
        }
    }
    Ok(())
}

/// Of each ptex face its face.
pub fn faces_of_ptex(model: &Model) -> Vec<u32> {
    let scheme = model.mesh().options().scheme;
    let faces = (0..).zip(model.mesh().faces());
    let parts = faces.flat_map(|(face, vertices)| {
        let whole = scheme.is_whole(vertices.len());
        std::iter::repeat_n(face, if whole { 1 } else { vertices.len() })
    });
    parts.collect()
}

/// The box around some vertices, in local units.
pub fn box_of<'a>(model: &Model, vertices: impl Iterator<Item = &'a u32>) -> (DVec3, DVec3) {
    let (placement, positions) = (model.placement(), model.mesh().positions());
    let all = vertices.map(|&vertex| placement.local(positions[vertex as usize]));
    all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    })
}

/// The box around the vertices that faces use, counted here and not by the mesh.
pub fn used_box(model: &Model) -> (DVec3, DVec3) {
    box_of(model, model.mesh().faces().flatten())
}

/// Its diagonal.
pub fn diagonal(model: &Model) -> f64 {
    let (low, high) = used_box(model);
    low.distance(high)
}

/// A captured position, in local units.
pub fn position(vertex: &Captured) -> DVec3 {
    Vec3::from(vertex.position).as_dvec3()
}

/// A captured normal.
pub fn normal(vertex: &Captured) -> DVec3 {
    Vec3::from(vertex.normal).as_dvec3()
}

/// The angle between two directions, in degrees; NaN for what is none.
pub fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// A normal out of rounding noise at every corner of a patch: a direction that depends on nothing but a vertex's last bits.
pub fn noise_at_corners(vertex: &mut Captured) {
    if vertex.uv.iter().all(|&x| x == 0.0 || x == 1.0) {
        let bits = vertex
            .position
            .map(|x| f64::from(x.to_bits() & 0xff) - 127.5);
        vertex.normal = DVec3::from(bits).normalize().as_vec3().to_array();
    }
}

/// A normal at every corner of a patch that is at right angles to the one of the surface.
pub fn turned_at_corners(vertex: &mut Captured) {
    if vertex.uv.iter().all(|&x| x == 0.0 || x == 1.0) {
        let own = normal(vertex);
        vertex.normal = own
            .any_orthogonal_vector()
            .normalize_or_zero()
            .as_vec3()
            .to_array();
    }
}
