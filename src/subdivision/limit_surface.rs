//! The limit surface at any point of any face, by recursive refinement.

use glam::{DVec2, DVec3};

use crate::mesh::topology::Topology;
use crate::mesh::{ControlMesh, Placement, Scheme, power_of_two_in};
use crate::patch::bspline;
use crate::subdivision::cell::SchemeCell;
use crate::subdivision::limit::{LimitStencil, limit_stencil};
use crate::subdivision::masks::Blend;
use crate::subdivision::refine::{Refinement, refine, with_neighbours};
use crate::subdivision::regular::bspline_patch;
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
}

impl LimitSample {
    /// The unit normal, on the side from which the face runs counter-clockwise; zero where the tangents are parallel.
    pub fn normal(&self) -> DVec3 {
        unit(unit(self.du).cross(unit(self.dv)))
    }
}

/// Unit length, or zero where there is no direction. Scaled by a power of two first: no square leaves the range of f64, and vectors of every such
/// scale have the same bits.
fn unit(v: DVec3) -> DVec3 {
    let greatest = v.abs().max_element();
    if greatest > 0.0 && greatest.is_finite() {
        (v / power_of_two_in(greatest)).normalize()
    } else {
        DVec3::ZERO
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
#[derive(Clone, Debug)]
pub struct LimitSurface {
    topology: Topology,
    /// A power of two about as large as the mesh: whatever that is, it then gives the same bits, and nothing over- or underflows.
    scale: f64,
    /// Over the scale.
    positions: Vec<DVec3>,
    ptex: Vec<(u32, u32)>,
    scheme: Scheme,
}

/// A face in its surroundings at some level.
struct Cell {
    topology: Topology,
    positions: Vec<DVec3>,
}

/// Refinement halves the distance to an extraordinary vertex; after so many halvings nothing of an f64 is left.
const DEEPEST: u32 = 60;

impl LimitSurface {
    /// The limit of a mesh under its own scheme.
    pub fn new(mesh: &ControlMesh) -> LimitSurface {
        LimitSurface::of_scheme(mesh, mesh.options().scheme)
    }

    /// The limit of a mesh under a scheme that may not be its own.
    pub fn of_scheme(mesh: &ControlMesh, scheme: Scheme) -> LimitSurface {
        let topology = Topology::under(mesh, scheme);
        LimitSurface::of_topology(topology, mesh.positions().to_vec(), scheme)
    }

    /// The limit of a topology, such as one that was refined, with a position for each of its vertices.
    pub fn of_topology(topology: Topology, positions: Vec<DVec3>, scheme: Scheme) -> LimitSurface {
        let is_used = |vertex: usize| !topology.vertex_faces(vertex as u32).is_empty();
        let used = (0..positions.len()).filter(|&vertex| is_used(vertex));
        let Placement { scale, .. } = Placement::of(used.map(|vertex| positions[vertex]));
        // A vertex that no face uses may be anywhere, and has no say.
        let scaled = |(vertex, position): (usize, DVec3)| match is_used(vertex) {
            true => position / scale,
            false => DVec3::ZERO,
        };
        let positions = positions.into_iter().enumerate().map(scaled).collect();
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
            let arity = topology.face(face).len();
            let corners = if scheme.is_whole(arity) { 1 } else { arity };
            (0..corners).map(move |corner| (face, corner as u32))
        });
        LimitSurface {
            ptex: ptex.collect(),
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

    /// The position of a vertex of the mesh, which is not its limit; the origin for one that no face uses.
    pub fn position(&self, vertex: u32) -> DVec3 {
        self.scale * self.positions[vertex as usize]
    }

    /// The topology with its final sharpness.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The number of ptex faces.
    pub fn ptex_count(&self) -> usize {
        self.ptex.len()
    }

    /// The face of a ptex number and its corner there (0 for quads).
    ///
    /// # Panics
    /// Where there is no such ptex face.
    pub fn face_corner(&self, ptex: usize) -> (u32, u32) {
        self.ptex[ptex]
    }

    /// The limit at (u, v) of a ptex face; what lies outside of 0..=1 is moved to its end. None in a hole, where there is no such face, and where u
    /// or v is no number.
    pub fn evaluate(&self, ptex: usize, u: f64, v: f64) -> Option<LimitSample> {
        let &(face, corner) = self.ptex.get(ptex)?;
        if self.topology.is_hole(face) || u.is_nan() || v.is_nan() {
            return None;
        }
        let uv = DVec2::new(u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
        let sample = match self.scheme {
            Scheme::CatmullClark => self.catmull_clark(face, corner, uv),
            Scheme::Bilinear => self.bilinear(face, corner, uv),
            Scheme::Loop | Scheme::Butterfly | Scheme::LoopStam => self.by_rules(face, corner, uv),
        };
        Some(LimitSample {
            position: self.scale * sample.position,
            du: self.scale * sample.du,
            dv: self.scale * sample.dv,
        })
    }

    fn catmull_clark(&self, face: u32, corner: u32, mut uv: DVec2) -> LimitSample {
        let mut cell = self.surroundings(face);
        if cell.topology.face(0).len() != 4 {
            cell = cell.child(corner);
        }
        let mut scale = 1.0;
        for depth in 0.. {
            if let Some(corner) =
                corner_at(uv).or_else(|| (depth == DEEPEST).then(|| nearest_corner(uv)))
            {
                return scaled(cell.limit(corner), scale);
            }
            if let Some(sample) = cell.regular(uv) {
                return scaled(sample, scale);
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
    fn by_rules(&self, face: u32, corner: u32, uv: DVec2) -> LimitSample {
        let triangle = self.topology.face(face).len() == 3;
        let uv = if triangle {
            DVec2::new(uv.x, uv.y.min(1.0 - uv.x))
        } else {
            uv
        };
        let mut faces = vec![face];
        for _ in 0..rings(self.scheme) {
            faces = with_neighbours(&self.topology, &faces);
        }
        let (topology, vertices) = self.topology.excerpt(&faces);
        let position = |&vertex: &u32| self.positions[vertex as usize];
        let cell = SchemeCell {
            topology,
            positions: vertices.iter().map(position).collect(),
            scheme: self.scheme,
        };
        cell.evaluate(corner, uv)
    }

    fn bilinear(&self, face: u32, corner: u32, uv: DVec2) -> LimitSample {
        let points: Vec<DVec3> = self
            .topology
            .face(face)
            .iter()
            .map(|&v| self.positions[v as usize])
            .collect();
        let (n, i) = (points.len(), corner as usize);
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
        LimitSample {
            position: a.lerp(b, uv.x).lerp(d.lerp(c, uv.x), uv.y),
            du: (b - a).lerp(c - d, uv.y),
            dv: (d - a).lerp(c - b, uv.x),
        }
    }

    /// A face with all that touches it, as a mesh of its own whose face 0 it is.
    fn surroundings(&self, face: u32) -> Cell {
        let (topology, vertices) = self
            .topology
            .excerpt(&with_neighbours(&self.topology, &[face]));
        Cell {
            topology,
            positions: vertices
                .iter()
                .map(|&v| self.positions[v as usize])
                .collect(),
        }
    }
}

impl Cell {
    /// The child at a corner.
    fn child(&self, corner: u32) -> Cell {
        let refined = refine(&self.topology, &[(0, corner)]);
        let positions = refined
            .masks
            .iter()
            .map(|mask| DVec3::blend(mask, &self.positions))
            .collect();
        Cell {
            topology: refined.topology,
            positions,
        }
    }

    /// The limit at a corner, after as many refinements as its sharpness and its faces' arities ask for.
    fn limit(&self, corner: u32) -> LimitSample {
        match limit_stencil(&self.topology, 0, corner) {
            Some(LimitStencil { position, du, dv }) => LimitSample {
                position: DVec3::blend(&position, &self.positions),
                du: DVec3::blend(&du, &self.positions),
                dv: DVec3::blend(&dv, &self.positions),
            },
            None => scaled(self.child(corner).limit(corner), 2.0),
        }
    }

    /// The B-spline at (u, v), when the face is one without semi-sharp creases.
    fn regular(&self, uv: DVec2) -> Option<LimitSample> {
        let patch = bspline_patch(&self.topology, 0).filter(|patch| patch.crease.is_none())?;
        let (u, v) = (bspline::basis(uv.x), bspline::basis(uv.y));
        let mut sample = LimitSample {
            position: DVec3::ZERO,
            du: DVec3::ZERO,
            dv: DVec3::ZERO,
        };
        for (i, point) in patch.points.iter().enumerate() {
            let point = DVec3::blend(&point.mask(), &self.positions);
            sample.position += point * u.value[i % 4] * v.value[i / 4];
            sample.du += point * u.derivative[i % 4] * v.value[i / 4];
            sample.dv += point * u.value[i % 4] * v.derivative[i / 4];
        }
        Some(sample)
    }
}

pub(super) fn scaled(sample: LimitSample, scale: f64) -> LimitSample {
    LimitSample {
        du: sample.du * scale,
        dv: sample.dv * scale,
        ..sample
    }
}

fn corner_at(uv: DVec2) -> Option<u32> {
    let exact = |x: f64| x == 0.0 || x == 1.0;
    (exact(uv.x) && exact(uv.y)).then(|| nearest_corner(uv))
}

pub(super) fn nearest_corner(uv: DVec2) -> u32 {
    match (uv.x < 0.5, uv.y < 0.5) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    }
}
