//! Which normal a sample of the limit has where its own derivatives do not tell, or tell what holds at a single point and nowhere around it.

use glam::{DVec2, DVec3};

use crate::mesh::Scheme;
use crate::mesh::topology::Fan;
use crate::subdivision::Mask;
use crate::subdivision::deep::{deep_limit, orthonormal_masks};
use crate::subdivision::jet::nearest_corner;
use crate::subdivision::jet::{CLEAR, Jet, Sum};
use crate::subdivision::limit::{TangentPlane, closing_tangents, is_unpromised, tangent_plane};
use crate::subdivision::limit_surface::LimitSurface;

/// How far from a corner its surroundings are asked, in ptex coordinates: as near as tess level 64 ever comes, the greatest that Vulkan asks for.
const NEARBY: f64 = 1.0 / 64.0;

/// The limit's own plane is taken if two tangents of orthonormal rows of weights ([`orthonormal_masks`]) span at least this beside the mean of their squares,
/// as much as tangents of one length do that are 3.6 degrees from parallel, so that rounding does not turn it; and if
/// the square of its normal's distance from that nearby is below this: 4 sin^2 (5 / 2 degrees) and a little less. What turns faster is seen as a dark spot
/// (`FASTER` in `conformance/witness/corners.rs`).
const FIRM: f64 = 1.0 / 16.0;
const NEAR: f64 = 0.0076;

/// Shorter sums of unit normals have cancelled, and are rounding.
const CANCELLED: f64 = 1.0 / 16.0;

impl LimitSurface {
    /// The normal at (u, v) of the ptex face of a corner, whose derivatives there are known.
    pub(super) fn normal(&self, face: u32, corner: u32, uv: DVec2, jet: &Jet) -> DVec3 {
        let found = match self.vertex_corner(face, corner, uv) {
            Some(at) if self.scheme() != Scheme::Bilinear => self.at_vertex(face, at, jet),
            _ => jet.normal().or_else(|| {
                let inwards = self.towards_middle(face, uv);
                let nearby = self.jet(face, corner, inwards).normal();
                nearby.or_else(|| self.of_faces(&[face]))
            }),
        };
        found.unwrap_or(DVec3::ZERO)
    }

    /// At a corner of the face, that is at a vertex of the mesh.
    fn at_vertex(&self, face: u32, corner: u32, jet: &Jet) -> Option<DVec3> {
        let topology = self.topology();
        let fan = topology.fan(face, corner);
        let cusp = matches!(tangent_plane(topology, face, corner), TangentPlane::Face(_));
        let own = || self.nearby(face, corner);
        let found = match &fan.faces[..] {
            [_] => self.checked(&fan, jet, own()),
            _ if cusp => own().or_else(|| jet.normal()),
            _ if is_unpromised(topology, self.scheme(), face, corner) => {
                self.checked(&fan, jet, self.around(&fan))
            }
            _ => jet
                .normal()
                .or_else(|| self.closing(face, corner))
                .or_else(|| self.around(&fan)),
        };
        let asking = if cusp { &[face][..] } else { &fan.faces[..] };
        found.or_else(|| self.of_faces(asking))
    }

    /// Of a sector whose crease comes back to where it came from.
    fn closing(&self, face: u32, corner: u32) -> Option<DVec3> {
        let topology = self.topology();
        let [a, b] = closing_tangents(topology, face, corner)?;
        let centre = self.positions[topology.face(face)[corner as usize] as usize];
        self.about(centre, &a, &b).normal()
    }

    /// Tangents over positions about a point, each of which errs by its own rounding.
    fn about(&self, centre: DVec3, du: &Mask, dv: &Mask) -> Jet {
        let of = |mask: &Mask| {
            let ends = mask
                .iter()
                .map(|&(v, _)| self.positions[v as usize] - centre);
            let weights: Mask = (0..).zip(mask).map(|(i, &(_, w))| (i, w)).collect();
            Sum::of(&weights, &ends.collect::<Vec<_>>())
        };
        let jet = Jet {
            position: centre,
            du: of(du),
            dv: of(dv),
        };
        jet.blurred(8.0 * self.grain)
    }

    /// Where a single face lies between two sharp edges, and where no tangent plane is promised: the limit's own normal, if its tangents are firm and the
    /// surroundings have one like it. Derivatives that are nearly parallel are left for masks, which are not: their rows are orthonormal.
    fn checked(&self, fan: &Fan, jet: &Jet, nearby: Option<DVec3>) -> Option<DVec3> {
        let masks = self.limit_tangents(fan);
        let limit = match jet.spread() >= FIRM {
            true => jet.normal(),
            false => masks.normal(),
        };
        let firm = limit.filter(|_| masks.spread() >= FIRM);
        match (firm, nearby) {
            (Some(limit), Some(nearby)) if limit.distance_squared(nearby) < NEAR => Some(limit),
            (_, Some(nearby)) => Some(nearby),
            (_, None) => limit,
        }
    }

    /// The limit's tangents: how much they span does not depend on the pair of them that is at hand, nor on who asks. Where none are promised each face's
    /// may be as many refinements from parallel as were made, hence the lowest's for all.
    fn limit_tangents(&self, fan: &Fan) -> Jet {
        let topology = self.topology();
        let lowest = fan.faces.iter().min();
        let face = *lowest.expect("a fan has faces");
        let corner = self.corner_of(face, fan.vertex);
        let limit = deep_limit(topology, self.scheme(), face, corner);
        let limit = limit.expect("the face has this corner");
        let [du, dv] = orthonormal_masks(&limit.du, &limit.dv);
        let centre = self.positions[topology.face(face)[corner as usize] as usize];
        self.about(centre, &du, &dv)
    }

    /// The mean of the normals nearby on all faces of a fan.
    fn around(&self, fan: &Fan) -> Option<DVec3> {
        let nearby = fan.faces.iter().filter_map(|&face| {
            let corner = self.corner_of(face, fan.vertex);
            self.nearby(face, corner)
        });
        let sum: DVec3 = nearby.sum();
        (sum.length() > CANCELLED).then(|| sum.normalize())
    }

    /// Of the derivatives next to a corner.
    fn nearby(&self, face: u32, corner: u32) -> Option<DVec3> {
        let (part, uv) = match self.topology().face(face).len() {
            3 if self.scheme().is_whole(3) => {
                (0, [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][corner as usize])
            }
            4 => (
                0,
                [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)][corner as usize],
            ),
            _ => (corner, (0.0, 0.0)),
        };
        let uv = self.towards_middle(face, DVec2::from(uv));
        self.jet(face, part, uv).normal()
    }

    /// A point moved towards the middle of its ptex face: a corner goes to (1/64, 1/64) from itself.
    fn towards_middle(&self, face: u32, uv: DVec2) -> DVec2 {
        let middle = match self.topology().face(face).len() {
            3 if self.scheme().is_whole(3) => 1.0 / 3.0,
            _ => 0.5,
        };
        uv + (DVec2::splat(middle) - uv) * (NEARBY / middle)
    }

    /// Of the faces of the mesh themselves, by their areas (Newell).
    fn of_faces(&self, faces: &[u32]) -> Option<DVec3> {
        let topology = self.topology();
        let (mut area, mut error) = (DVec3::ZERO, 0.0);
        for &face in faces {
            let vertices = topology.face(face);
            let first = self.positions[vertices[0] as usize];
            let spoke = |i: usize| self.positions[vertices[i] as usize] - first;
            for i in 1..vertices.len() - 1 {
                let [a, b] = [spoke(i), spoke(i + 1)];
                area += a.cross(b);
                error +=
                    self.grain * (a.length() + b.length()) + f64::EPSILON * a.length() * b.length();
            }
        }
        (area.length() > CLEAR * error).then(|| area.normalize())
    }

    /// The corner of the face at (u, v) of a ptex face, if a vertex of the mesh is there.
    fn vertex_corner(&self, face: u32, corner: u32, uv: DVec2) -> Option<u32> {
        let n = self.topology().face(face).len();
        if n == 3 && self.scheme().is_whole(3) {
            let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
            return (0..).zip(corners).find(|&(_, at)| at == uv).map(|(i, _)| i);
        }
        let at_corner = uv.to_array().iter().all(|x| x.fract() == 0.0);
        match n {
            _ if !at_corner => None,
            4 => Some(nearest_corner(uv)),
            _ => (uv == DVec2::ZERO).then_some(corner),
        }
    }

    /// The corner of a face at which it has a vertex.
    fn corner_of(&self, face: u32, vertex: u32) -> u32 {
        let mut vertices = self.topology().face(face).iter();
        let corner = vertices.position(|&v| v == vertex);
        corner.expect("the faces of a fan have its vertex") as u32
    }
}
