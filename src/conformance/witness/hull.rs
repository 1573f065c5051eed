//! Points lie among the vertices that they are made of.

use glam::DVec3;

use super::drawn::{box_of, diagonal, each_patch, faces_of_ptex, position, used_box};
use super::{Looked, Rule, Subject, every, usual};
use crate::abi::Captured;
use crate::conformance::{Check, Context};
use crate::error::Result;
use crate::mesh::{Model, Scheme};
use crate::method::Reproduces;

pub(super) const RULE: Rule = Rule {
    name: "hull",
    rule: "positions are finite and lie in the box of the vertices that they are made of; normals have length 1 or 0",
    source: "Catmull, Clark 1978; Loop 1987: weights are not negative and sum to 1",
    concerns: every,
    options: usual,
    look,
};

/// Odd and not a power of two: most vertices lie on no lattice.
const LEVEL: f32 = 5.0;

/// A box.
type Bounds = (DVec3, DVec3);

fn look(context: &Context, subject: &Subject<'_>, check: &mut Check) -> Result<Looked> {
    let Subject { model, method, .. } = *subject;
    let faces = faces_of_ptex(model);
    let diagonal = diagonal(model);
    // What the contract of every method allows.
    let rounding = 1e-6 * diagonal;
    let mut looked = Looked::default();
    each_patch(context, subject, LEVEL, far_off, |patch| {
        let face = faces[patch.ptex() as usize];
        let (low, high) = grown(around(model, face), model, subject);
        for vertex in patch.vertices {
            let at = position(vertex);
            let off = (low - at).max(at - high).max_element();
            // NaN must not pass.
            check.hold(off <= rounding && at.is_finite(), || {
                format!("{}, face {face}: {at} is {off:.3e} outside", method.name)
            });
            let length = f64::from(vertex.normal.iter().map(|x| x * x).sum::<f32>());
            check.hold(length == 0.0 || (length - 1.0).abs() < 1e-4, || {
                format!(
                    "{}, face {face}: a normal of {:?}",
                    method.name, vertex.normal
                )
            });
            looked.at(off.max(0.0) / diagonal);
        }
        Ok(())
    })?;
    Ok(looked)
}

/// The box of all faces that touch a face: its 1-ring.
fn around(model: &Model, face: u32) -> Bounds {
    let topology = model.topology();
    let corners = topology.face(face).iter();
    let faces = corners.flat_map(|&vertex| topology.vertex_faces(vertex));
    box_of(model, faces.flat_map(|corner| topology.face(corner.face)))
}

/// The box that a method stays in under a scheme. Where no weight is negative that is the 1-ring's own. Surfaces that go through points, or bend
/// towards tangent planes, leave it by no more than its size; the butterfly takes vertices from farther away.
fn grown(ring: Bounds, model: &Model, subject: &Subject<'_>) -> Bounds {
    let scheme = model.mesh().options().scheme;
    let refines = !matches!(scheme, Scheme::Butterfly | Scheme::LoopStam);
    let (low, high) = match scheme {
        Scheme::Butterfly => used_box(model),
        _ => ring,
    };
    match subject.method.contract.reproduces {
        Reproduces::Faces(_) => ring,
        Reproduces::Limit(_) | Reproduces::LimitOnLattice(_) if refines => ring,
        _ => {
            let more = DVec3::splat(low.distance(high));
            (low - more, high + more)
        }
    }
}

/// A position as if it were made of other vertices.
fn far_off(vertex: &mut Captured) {
    vertex.position = vertex.position.map(|x| 5.0 * x);
}
