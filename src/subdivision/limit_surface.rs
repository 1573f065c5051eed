//! The limit surface at any point of any face, by recursive refinement.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::mesh::{ControlMesh, Placement, Scheme};
use crate::subdivision::cell::SchemeCell;
use crate::subdivision::jet::{Jet, Sum, nearest_corner, recentred};
use crate::subdivision::limit::limit_stencil;
use crate::subdivision::masks::Blend;
use crate::subdivision::refine::{Refinement, refine, with_neighbours};
use crate::subdivision::regular::{bspline_jet, bspline_patch};
use crate::subdivision::schemes::rings;
use crate::subdivision::split::refine_all;

/// A point of the limit surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitSample {
    /// Position, in the units of the mesh.
    pub position: DVec3,
    /// Derivative by u. At an extraordinary vertex it has no length of its own: there only the plane of `du` and `dv` counts.
    pub du: DVec3,
    /// Derivative by v.
    pub dv: DVec3,
    pub(super) normal: DVec3,
}

impl LimitSample {
    /// The unit normal, on the side from which the surface's parameters run counter-clockwise: the face's own, unless the surface folds over.
    ///
    /// It is that of `du` and `dv` where they span a plane, beyond what rounding leaves of sums that cancel. Elsewhere, and at cusps, it is the
    /// normal of the surface nearby, see [`LimitSurface`]; zero where there is none either.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }
}

/// The limit surface of a control mesh: the truth that everything else is measured against.
///
/// The scheme is the mesh's own. Catmull-Clark and Loop are exact to rounding, bar a few non-manifold places and interior vertices of two triangles.
/// Of the butterfly, points off the lattice of dyadic numbers are taken between vertices of level 26. By estimate from the schemes' eigenvalues that
/// errs by 1e-14 of the mesh's size in position and 1e-7 in tangents; tangents at boundaries and creases err by 1e-7 everywhere. The same holds of Loop-Stam where triangles meet quads.
///
/// Faces are ptex faces: in file order a quad takes one number and an n-gon n, one a corner; holes keep theirs. A triangle of a scheme for triangles takes one:
/// (0,0) is its first vertex, (1,0) the second and (0,1) the third. Of a quad v0 v1 v2 v3,
/// (0,0) is v0, (1,0) v1, (1,1) v2 and (0,1) v3; of corner i of an n-gon, (0,0) is the corner, (1,0) the middle of the edge that leaves
/// it, (1,1) the face's centre and (0,1) the middle of the edge that arrives.
///
/// A normal is taken of the derivatives where these span a plane. Where they cancel, and at cusps, where each face has a tangent plane of its own
/// ([`is_cusp`](crate::subdivision::is_cusp)), it is taken *nearby*: of the derivatives at (1/64, 1/64) from the corner on the same ptex face. At a cusp that
/// differs from the limit as much as the limit does from the rest of the picture. All this is decided by `normals.rs` beside this file.
#[derive(Clone, Debug)]
pub struct LimitSurface {
    topology: Topology,
    /// A power of two about as large as the mesh: whatever that is, it then gives the same bits, and nothing over- or underflows.
    scale: f64,
    /// Over the scale.
    pub(super) positions: Vec<DVec3>,
    ptex: Vec<(u32, u32)>,
    scheme: Scheme,
    /// Half a unit in the last place of the greatest coordinate over the scale: what the mesh itself may have been rounded by.
    pub(super) grain: f64,
}

/// A face in its surroundings at some level.
struct Cell {
    topology: Topology,
    /// Relative to the origin, which is one of the face's vertices: so rounding stays small beside the face, however deep its level.
    positions: Vec<DVec3>,
    origin: DVec3,
}

/// Refinement halves the distance to an extraordinary vertex; after so many halvings nothing of an f64 is left.
const DEEPEST: i32 = 60;

impl LimitSurface {
    /// The limit of a mesh under its own scheme.
    pub fn new(mesh: &ControlMesh) -> LimitSurface {
        LimitSurface::under(mesh, mesh.options().scheme)
    }

    /// The limit of a mesh under a scheme that may not be its own.
    ///
    /// # Errors
    /// As [`Scheme::check`].
    pub fn of_scheme(mesh: &ControlMesh, scheme: Scheme) -> Result<LimitSurface> {
        scheme.check(mesh)?;
        Ok(LimitSurface::under(mesh, scheme))
    }

    fn under(mesh: &ControlMesh, scheme: Scheme) -> LimitSurface {
        let topology = Topology::under(mesh, scheme);
        let positions = mesh.positions();
        let is_used = |vertex: usize| !topology.vertex_faces(vertex as u32).is_empty();
        let used = (0..positions.len()).filter(|&vertex| is_used(vertex));
        let Placement { scale, .. } = Placement::of(used.map(|vertex| positions[vertex]));
        // A vertex that no face uses may be anywhere, and has no say.
        let scaled = |(vertex, position): (usize, DVec3)| match is_used(vertex) {
            true => position / scale,
            false => DVec3::ZERO,
        };
        let positions = positions.iter().copied().enumerate().map(scaled).collect();
        LimitSurface::of_scaled(topology, scale, positions, scheme)
    }

    /// From positions over a scale.
    fn of_scaled(
        topology: Topology,
        scale: f64,
        positions: Vec<DVec3>,
        scheme: Scheme,
    ) -> LimitSurface {
        let faces = 0..topology.face_count() as u32;
        let ptex = faces.flat_map(|face| {
            let parts = scheme.ptex_faces(topology.shared_faces().corners(face as usize));
            (0..parts).map(move |corner| (face, corner as u32))
        });
        let greatest = positions.iter().map(|p| p.abs().max_element());
        LimitSurface {
            ptex: ptex.collect(),
            grain: greatest.fold(0.0, f64::max) * 0.5 * f64::EPSILON,
            topology,
            scale,
            positions,
            scheme,
        }
    }

    /// The same surface with its mesh refined once; [`refine_all`] tells the order of vertices and faces.
    pub fn refined(&self) -> LimitSurface {
        let Refinement {
            topology, masks, ..
        } = refine_all(&self.topology, self.scheme);
        let blend = |mask| DVec3::blend(mask, &self.positions);
        let positions = masks.iter().map(|mask| blend(mask)).collect();
        LimitSurface::of_scaled(topology, self.scale, positions, self.scheme)
    }

    /// The position of a vertex of the mesh, which is not its limit; the origin for one that no face uses, and where there is none.
    pub fn position(&self, vertex: u32) -> DVec3 {
        let position = self.positions.get(vertex as usize);
        self.scale * position.copied().unwrap_or_default()
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// The topology with its final sharpness.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The number of ptex faces.
    pub fn ptex_count(&self) -> usize {
        self.ptex.len()
    }

    /// The face of a ptex number and its corner there (0 for quads); None where there is no such ptex face.
    pub fn face_corner(&self, ptex: usize) -> Option<(u32, u32)> {
        self.ptex.get(ptex).copied()
    }

    /// The limit at (u, v) of a ptex face; what lies outside of 0..=1 is moved to its end. None in a hole, where there is no such face, and where u
    /// or v is no number.
    pub fn evaluate(&self, ptex: usize, u: f64, v: f64) -> Option<LimitSample> {
        let &(face, corner) = self.ptex.get(ptex)?;
        if self.topology.is_hole(face) || u.is_nan() || v.is_nan() {
            return None;
        }
        // Nearer to an edge than this, nothing of an f64 is left.
        let snapped = |x: f64| {
            if x < 0.5f64.powi(DEEPEST) {
                0.0
            } else {
                x.min(1.0)
            }
        };
        let mut uv = DVec2::new(snapped(u), snapped(v));
        if self.topology.face(face).len() == 3 && self.scheme.is_whole(3) {
            uv.y = uv.y.min(1.0 - uv.x);
        }
        let jet = self.jet(face, corner, uv);
        Some(LimitSample {
            position: self.scale * jet.position,
            du: self.scale * jet.du.value,
            dv: self.scale * jet.dv.value,
            normal: self.normal(face, corner, uv, &jet),
        })
    }

    /// The limit at many places, each a ptex face and (u, v), as [`evaluate`](Self::evaluate) has it: positions, derivatives and normals, in parallel in
    /// rayon's current pool.
    pub fn evaluate_all(&self, places: &[(usize, [f64; 2])]) -> Vec<Option<LimitSample>> {
        let places = places.par_iter().with_min_len(64);
        let evaluate = |&(ptex, [u, v]): &(usize, [f64; 2])| self.evaluate(ptex, u, v);
        places.map(evaluate).collect()
    }

    /// Position and derivatives at (u, v) of the ptex face of a corner.
    pub(super) fn jet(&self, face: u32, corner: u32, uv: DVec2) -> Jet {
        let jet = match self.scheme {
            Scheme::CatmullClark => self.catmull_clark(face, corner, uv),
            Scheme::Bilinear => self.bilinear(face, corner, uv),
            Scheme::Loop | Scheme::Butterfly | Scheme::LoopStam => self.by_rules(face, corner, uv),
        };
        // The weights of a derivative over the mesh's own vertices sum to a few units.
        jet.blurred(8.0 * self.grain)
    }

    fn catmull_clark(&self, face: u32, corner: u32, mut uv: DVec2) -> Jet {
        let mut cell = self.surroundings(face, self.nearest_vertex(face, corner, uv));
        if cell.topology.face(0).len() != 4 {
            cell = cell.child(corner);
        }
        let mut scale = 1.0;
        for depth in 0.. {
            if let Some(corner) =
                corner_at(uv).or_else(|| (depth == DEEPEST).then(|| nearest_corner(uv)))
            {
                return cell.limit(corner).scaled(scale);
            }
            if let Some(jet) = cell.regular(uv) {
                return jet.scaled(scale);
            }
            let corner = nearest_corner(uv);
            cell = cell.child(corner);
            uv = 2.0 * uv
                - DVec2::from([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)][corner as usize]);
            scale *= 2.0;
        }
        unreachable!("the walk ends at DEEPEST")
    }

    /// Any scheme, with its rules alone. Slower than [`LimitSurface::catmull_clark`], which refines no more than it needs.
    fn by_rules(&self, face: u32, corner: u32, uv: DVec2) -> Jet {
        let mut faces = vec![face];
        for _ in 0..rings(self.scheme) {
            faces = with_neighbours(&self.topology, &faces);
        }
        let (topology, vertices) = self.topology.excerpt(&faces);
        let origin = self.positions[self.nearest_vertex(face, corner, uv)];
        let position = |&vertex: &u32| self.positions[vertex as usize] - origin;
        let cell = SchemeCell {
            topology,
            positions: vertices.iter().map(position).collect(),
            origin,
            scheme: self.scheme,
        };
        cell.evaluate(corner, uv)
    }

    fn bilinear(&self, face: u32, corner: u32, uv: DVec2) -> Jet {
        let vertices = self.topology.face(face);
        let (n, i) = (vertices.len(), corner as usize);
        let origin = self.positions[vertices[i] as usize];
        let points: Vec<DVec3> = vertices
            .iter()
            .map(|&v| self.positions[v as usize] - origin)
            .collect();
        let [a, b, c, d] = if n == 4 {
            [points[0], points[1], points[2], points[3]]
        } else {
            let centre = points.iter().sum::<DVec3>() / n as f64;
            [
                points[i],
                (points[i] + points[(i + 1) % n]) / 2.0,
                centre,
                (points[i] + points[(i + n - 1) % n]) / 2.0,
            ]
        };
        Jet {
            position: origin + a.lerp(b, uv.x).lerp(d.lerp(c, uv.x), uv.y),
            du: Sum::between(a, b) * (1.0 - uv.y) + Sum::between(d, c) * uv.y,
            dv: Sum::between(a, d) * (1.0 - uv.x) + Sum::between(b, c) * uv.x,
        }
    }

    /// The vertex of a face that is nearest to (u, v) of the ptex face of a corner.
    fn nearest_vertex(&self, face: u32, corner: u32, uv: DVec2) -> usize {
        let vertices = self.topology.face(face);
        let nearest = match vertices.len() {
            3 if self.scheme.is_whole(3) => u32::from(uv.x >= 0.5) + 2 * u32::from(uv.y >= 0.5),
            4 => nearest_corner(uv),
            _ => corner,
        };
        vertices[nearest.min(vertices.len() as u32 - 1) as usize] as usize
    }

    /// A face with all that touches it, as a mesh of its own whose face 0 it is.
    fn surroundings(&self, face: u32, vertex: usize) -> Cell {
        let (topology, vertices) = self
            .topology
            .excerpt(&with_neighbours(&self.topology, &[face]));
        let origin = self.positions[vertex];
        Cell {
            topology,
            positions: vertices
                .iter()
                .map(|&v| self.positions[v as usize] - origin)
                .collect(),
            origin,
        }
    }
}

impl Cell {
    /// The child at a corner.
    fn child(&self, corner: u32) -> Cell {
        let refined = refine(&self.topology, &[(0, corner)]);
        let mut positions: Vec<DVec3> = refined
            .masks
            .iter()
            .map(|mask| DVec3::blend(mask, &self.positions))
            .collect();
        // An n-gon's child begins at the corner.
        let corner = if self.topology.face(0).len() == 4 {
            corner
        } else {
            0
        };
        let mut origin = self.origin;
        let vertex = refined.topology.face(0)[corner as usize];
        recentred(&mut positions, &mut origin, vertex);
        Cell {
            topology: refined.topology,
            positions,
            origin,
        }
    }

    /// The limit at a corner, after as many refinements as its sharpness and its faces' arities ask for.
    fn limit(&self, corner: u32) -> Jet {
        match limit_stencil(&self.topology, 0, corner) {
            Some(stencil) => Jet::of(&stencil, &self.positions).moved(self.origin),
            None => self.child(corner).limit(corner).scaled(2.0),
        }
    }

    /// The B-spline at (u, v), when the face is one without semi-sharp creases.
    fn regular(&self, uv: DVec2) -> Option<Jet> {
        let patch = bspline_patch(&self.topology, 0).filter(|patch| patch.crease.is_none())?;
        Some(bspline_jet(&patch, &self.positions, uv).moved(self.origin))
    }
}

fn corner_at(uv: DVec2) -> Option<u32> {
    let exact = |x: f64| x == 0.0 || x == 1.0;
    (exact(uv.x) && exact(uv.y)).then(|| nearest_corner(uv))
}
