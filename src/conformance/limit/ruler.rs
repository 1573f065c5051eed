//! What captured vertices are held to: the truth, the CPU's twin, or one of them on a lattice and the other off it.

use glam::{DVec3, Vec2, Vec3};

use crate::abi::{self, Captured};
use crate::conformance::capture::Frame;
use crate::conformance::meshes::with_positions;
use crate::conformance::{Check, Context};
use crate::error::Result;
use crate::mesh::{ControlMesh, Model, Scheme};
use crate::method::{
    Controls, Method, MethodOptions, Pass, Prepared, Reproduces, TableNormals, is_on_hexagon,
    node_kind, to_ptex,
};
use crate::subdivision::{LimitSurface, is_cusp, is_unpromised, vertex_limit};

/// What a vertex is evaluated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A node of the patch's own plan, of an `abi::NODE_...` kind.
    Node(u32),
    /// The plan of an edge.
    Edge,
    /// The stencils of a vertex.
    Corner,
}

/// How far off a method may be.
fn within(method: &Method) -> f64 {
    match method.contract.reproduces {
        Reproduces::Limit(most)
        | Reproduces::LimitOnLattice(most)
        | Reproduces::LimitBesideCaps(most)
        | Reproduces::LimitOnHexagon(most)
        | Reproduces::Faces(most) => most,
        Reproduces::Itself => 1e-6,
    }
}

/// What is right.
enum Right {
    /// A surface in f64.
    Truth(Box<LimitSurface>),
    /// The method's own, on the CPU.
    Twin(Controls),
    /// The surface in f64 beside end caps. At their corners its positions, the method's own elsewhere; their normals are its own everywhere.
    Caps(Box<LimitSurface>, Controls),
    /// Positions of the surface in f64 on the pass' lattice, the method's own off it; normals are its own everywhere.
    Lattice(Box<LimitSurface>, Controls),
    /// The same, and on the lattice the surface's normals as well.
    LatticeNormals(Box<LimitSurface>, Controls),
    /// The surface in f64 at six places of each triangle, normals too where they are sure; the method's own elsewhere. The second surface is the
    /// first, refined.
    Hexagon([Box<LimitSurface>; 2], Controls),
}

/// The truth of a method's contract: the limit, everywhere or on a lattice, or linear faces. A method with a surface of its own, and plain
/// triangles, are held to the CPU's twin.
fn right(
    context: &Context,
    model: &Model,
    method: &Method,
    prepared: &Prepared,
    options: MethodOptions,
) -> Result<Right> {
    let own = model.mesh().options().scheme;
    let moved = if context.is_wrong() { 1e-3 } else { 0.0 };
    let twin = || twin(model, prepared, moved);
    Ok(match method.contract.reproduces {
        Reproduces::Limit(_) => Right::Truth(truth(model.mesh(), own, moved)?),
        Reproduces::LimitOnLattice(_) => {
            let lattice = match options.tables.normals {
                TableNormals::Geometric => Right::LatticeNormals,
                TableNormals::Shading(_) => Right::Lattice,
            };
            lattice(truth(model.mesh(), own, moved)?, twin())
        }
        Reproduces::LimitBesideCaps(_) => Right::Caps(truth(model.mesh(), own, moved)?, twin()),
        Reproduces::LimitOnHexagon(_) => {
            let truth = truth(model.mesh(), own, moved)?;
            let finer = Box::new(truth.refined());
            Right::Hexagon([truth, finer], twin())
        }
        Reproduces::Faces(_) if own == Scheme::CatmullClark => {
            Right::Truth(truth(model.mesh(), Scheme::Bilinear, moved)?)
        }
        Reproduces::Faces(_) | Reproduces::Itself => Right::Twin(twin()),
    })
}

/// The surface in f64, with vertex 0 moved by a part of the diagonal.
fn truth(mesh: &ControlMesh, scheme: Scheme, moved: f64) -> Result<Box<LimitSurface>> {
    let mut positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let (low, high) = mesh.bounds();
    positions[0][2] += moved * low.distance(high);
    let mesh = with_positions(mesh, &positions)?;
    Ok(Box::new(LimitSurface::of_scheme(&mesh, scheme)?))
}

/// The same for the CPU's twin.
fn twin(model: &Model, prepared: &Prepared, moved: f64) -> Controls {
    let mut vertices = model.positions();
    vertices[0].z += (moved * model.diagonal()) as f32;
    prepared.controls(vertices)
}

/// The captured vertices with their passes, all or those in nodes of a kind.
pub(super) fn samples<'a>(
    prepared: &'a Prepared,
    frame: &'a Frame,
    kind: Option<Kind>,
) -> Vec<(&'a Pass, &'a Captured)> {
    let passes = prepared.passes.iter().zip(&frame.passes);
    passes
        .flat_map(|(pass, vertices)| vertices.iter().map(move |vertex| (pass, vertex)))
        .filter(|(pass, vertex)| kind.is_none_or(|kind| kind_of(pass, vertex) == kind))
        .collect()
}

/// What a captured vertex was evaluated by. A patch without a plan is a regular node as a whole.
fn kind_of(pass: &Pass, vertex: &Captured) -> Kind {
    let at_border = vertex.uv.map(|x| x <= 0.0 || x >= 1.0);
    match at_border {
        [true, true] => return Kind::Corner,
        [true, false] | [false, true] => return Kind::Edge,
        [false, false] => {}
    }
    let kind = node_kind(pass, vertex.patch_number as usize, vertex.uv.into());
    Kind::Node(kind.unwrap_or(abi::NODE_REGULAR))
}

/// Whether one of the six places of a triangle has one normal in closed form for all its faces: not at a cusp, and not where the truth too only
/// refines. `finer` is the truth refined once.
fn has_sure_normal(finer: &LimitSurface, scheme: Scheme, face: u32, uv: [f32; 2]) -> bool {
    // The children at the corners, each with that corner as its own, and then the middle one.
    let (child, corner) = match uv {
        [0.0, 0.0] => (0, 0),
        [1.0, 0.0] => (1, 1),
        [0.0, 1.0] => (2, 2),
        [_, 0.0] => (3, 2),
        [0.0, _] => (3, 1),
        _ => (3, 0),
    };
    let (topology, child) = (finer.topology(), 4 * face + child);
    !is_cusp(topology, child, corner) && vertex_limit(topology, scheme, child, corner).is_some()
}

/// Whether a scheme promises a tangent plane at (u, v) of a ptex face. Where it promises none the truth asks the surroundings if the limit's tangents turn
/// too fast or are nearly parallel; tables have the limit's own.
fn has_promised_normal(truth: &LimitSurface, ptex: u32, uv: [f32; 2]) -> bool {
    let Some((face, part)) = truth.face_corner(ptex as usize) else {
        return false;
    };
    let (topology, scheme) = (truth.topology(), truth.scheme());
    let (at, corners): (u32, &[[f32; 2]]) = match topology.face(face).len() {
        3 if scheme.is_whole(3) => (0, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
        4 => (0, &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        _ => (part, &[[0.0, 0.0]]),
    };
    let corner = corners.iter().position(|&corner| corner == uv);
    corner.is_none_or(|corner| !is_unpromised(topology, scheme, face, at + corner as u32))
}

/// Tables' own normals where a scheme promises none are not dark spots: within so many degrees of the truth's, as the witness wants of corners.
const UNPROMISED: f64 = 5.0;

/// What captured vertices are measured with.
pub(super) struct Ruler<'a> {
    model: &'a Model,
    right: Right,
    /// A unit in the model's local ones.
    unit: f64,
    most: f64,
    most_degrees: f64,
}

impl<'a> Ruler<'a> {
    /// What a method's contract promises of a model. A seeded fault moves a control vertex first.
    pub fn new(
        context: &Context,
        model: &'a Model,
        method: &Method,
        prepared: &Prepared,
        options: MethodOptions,
    ) -> Result<Ruler<'a>> {
        Ok(Ruler {
            model,
            right: right(context, model, method, prepared, options)?,
            unit: model.diagonal() * 0.5f64.powi(23),
            most: within(method) * 2f64.powi(23),
            most_degrees: method.contract.normals.unwrap_or(0.1),
        })
    }

    /// Measures a vertex: units and degrees.
    pub fn hold(&self, check: &mut Check, pass: &Pass, vertex: &Captured) -> [f64; 2] {
        let number = vertex.patch_number as usize;
        let ptex = pass.patches[number].ptex;
        let uv = to_ptex(&pass.patches[number], vertex.uv);
        let right = match &self.right {
            Right::Truth(truth) => self.of_truth(truth, ptex, uv),
            Right::Twin(controls) => Some(self.of_twin(controls, pass, vertex)),
            Right::Caps(truth, _) if !pass.caps => self.of_truth(truth, ptex, uv),
            Right::Caps(truth, controls) => {
                let twin = self.of_twin(controls, pass, vertex);
                let is_corner = vertex.uv.iter().all(|x| x.fract() == 0.0);
                match self.of_truth(truth, ptex, uv).filter(|_| is_corner) {
                    Some((position, _)) => Some((position, twin.1)),
                    None => Some(twin),
                }
            }
            Right::Lattice(truth, controls) => {
                let twin = self.of_twin(controls, pass, vertex);
                match pass.is_on_lattice(vertex.uv) {
                    true => self
                        .of_truth(truth, ptex, uv)
                        .map(|(position, _)| (position, twin.1)),
                    false => Some(twin),
                }
            }
            Right::LatticeNormals(truth, controls) => match pass.is_on_lattice(vertex.uv) {
                true if has_promised_normal(truth, ptex, uv) => self.of_truth(truth, ptex, uv),
                true => {
                    // By the twin to the method's own bound, and that near the truth.
                    let twin = self.of_twin(controls, pass, vertex);
                    let right = self.of_truth(truth, ptex, uv);
                    let normals = right.and_then(|(_, right)| twin.1.zip(right));
                    let apart = normals.map_or(0.0, |(own, right)| {
                        own.cross(right).length().atan2(own.dot(right)).to_degrees()
                    });
                    check.hold(apart <= UNPROMISED, || {
                        format!("{apart:.2} degrees off the truth at {uv:?} of ptex face {ptex}")
                    });
                    right.map(|(position, _)| (position, twin.1))
                }
                false => Some(self.of_twin(controls, pass, vertex)),
            },
            Right::Hexagon([truth, finer], controls) => {
                let twin = self.of_twin(controls, pass, vertex);
                let (face, _) = truth
                    .face_corner(ptex as usize)
                    .expect("patches are of ptex faces");
                let scheme = self.model.mesh().options().scheme;
                match is_on_hexagon(uv) {
                    true if has_sure_normal(finer, scheme, face, uv) => {
                        self.of_truth(truth, ptex, uv)
                    }
                    true => self
                        .of_truth(truth, ptex, uv)
                        .map(|(position, _)| (position, twin.1)),
                    false => Some(twin),
                }
            }
        };
        let Some((position, normal)) = right else {
            check.hold(false, || format!("ptex face {ptex} is a hole"));
            return [0.0; 2];
        };
        let captured = Vec3::from(vertex.position).as_dvec3();
        let units = captured.distance(position) / self.unit;
        let degrees = normal.map_or(0.0, |normal| {
            let captured = Vec3::from(vertex.normal).as_dvec3();
            captured
                .cross(normal)
                .length()
                .atan2(captured.dot(normal))
                .to_degrees()
        });
        // NaN must not pass.
        check.hold(units <= self.most && degrees <= self.most_degrees, || {
            format!("{units:.2} units and {degrees:.4} degrees off at {uv:?} of ptex face {ptex}")
        });
        [units, degrees]
    }

    /// Position and normal of the CPU's twin.
    fn of_twin(
        &self,
        controls: &Controls,
        pass: &Pass,
        vertex: &Captured,
    ) -> (DVec3, Option<DVec3>) {
        let number = vertex.patch_number as usize;
        let twin = pass.evaluate(controls, number, Vec2::from(vertex.uv));
        (twin.position.as_dvec3(), Some(twin.normal.as_dvec3()))
    }

    /// Position and normal of the truth; no normal where the surface folds or stands still: there f32 has none.
    fn of_truth(
        &self,
        truth: &LimitSurface,
        ptex: u32,
        uv: [f32; 2],
    ) -> Option<(DVec3, Option<DVec3>)> {
        let [u, v] = uv.map(f64::from);
        let right = truth.evaluate(ptex as usize, u, v)?;
        let placement = self.model.placement();
        let [du, dv] = [right.du, right.dv].map(|tangent| tangent / placement.scale);
        let shortest = du.length().min(dv.length()) / self.model.diagonal();
        let (du, dv) = (du.normalize_or_zero(), dv.normalize_or_zero());
        let firm = du.cross(dv).length() * shortest > 0.01;
        let position = placement.local(right.position);
        Some((position, firm.then(|| right.normal())))
    }
}
