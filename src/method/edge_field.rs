//! The normal on an edge between two patches, from what belongs to the edge alone: its tangent and its field, see `spokes.rs`. Twin of
//! `glsl/lib/edge_field.glsl`.

use glam::Vec3;

use crate::method::Pass;
use crate::method::surface::{Controls, Surface, SurfacePoint};

/// The control points of a patch as `Spokes::of` numbers them: so many corners, then so many points an edge.
pub struct Numbers<'a> {
    controls: &'a [u32],
    given: &'a Controls,
    corners: usize,
    per_edge: usize,
}

impl<'a> Numbers<'a> {
    pub fn new(
        pass: &'a Pass,
        given: &'a Controls,
        patch: usize,
        [corners, per_edge]: [usize; 2],
    ) -> Numbers<'a> {
        let controls = &pass.controls[pass.patches[patch].controls as usize..];
        Numbers {
            controls,
            given,
            corners,
            per_edge,
        }
    }

    /// Control point `number`.
    pub fn point(&self, number: usize) -> Vec3 {
        self.given.points[self.controls[number] as usize]
            .position
            .into()
    }

    /// The limit's normal at a corner.
    pub fn normal(&self, corner: usize) -> Vec3 {
        self.given.points[self.controls[corner] as usize]
            .normal
            .into()
    }

    fn first(&self, edge: usize) -> usize {
        self.corners + self.per_edge * edge
    }

    /// Point `i` of an edge.
    pub fn edge_point(&self, edge: usize, i: usize) -> Vec3 {
        self.point(self.first(edge) + i)
    }

    /// 1 where the patch runs along an edge as the edge's points do, -1 where it runs against it.
    pub fn direction_of(&self, edge: usize) -> f32 {
        let first = self.first(edge);
        let along = self.controls[first] < self.controls[first + self.per_edge - 1];
        if along { 1.0 } else { -1.0 }
    }

    /// The point on an edge with its normal, from the three vectors of its tangent and where along it the point is. The field's four begin with point
    /// `field` of the edge.
    pub fn on_edge(
        &self,
        position: Vec3,
        [edge, field]: [usize; 2],
        tangent: [Vec3; 3],
        along: [f32; 2],
    ) -> SurfacePoint {
        let x = [0, 1, 2, 3].map(|i| self.edge_point(edge, field + i));
        let surface = Surface {
            position,
            du: quadratic(tangent, along),
            dv: self.direction_of(edge) * cubic(x, along),
        };
        surface.point()
    }
}

/// Both read the same from either end.
fn quadratic(points: [Vec3; 3], [s, t]: [f32; 2]) -> Vec3 {
    ((s * s) * points[0] + (t * t) * points[2]) + (2.0 * (s * t)) * points[1]
}

fn cubic(points: [Vec3; 4], [s, t]: [f32; 2]) -> Vec3 {
    (((s * s) * s) * points[0] + ((t * t) * t) * points[3])
        + (3.0 * (s * t)) * (s * points[1] + t * points[2])
}
