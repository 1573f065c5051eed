//! Edits of a mesh: tags and positions. What an edit names is checked before anything changes.

use glam::DVec3;

use crate::error::{Error, Place, Result};
use crate::mesh::control_mesh::{Corner, Crease, check_position, check_sharpness};
use crate::mesh::model::next_revision;
use crate::mesh::topology::{Retagged, Topology};
use crate::mesh::{ControlMesh, Model};

/// A step of an edit.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Crease(Crease),
    Corner(Corner),
    Hole { face: u32, hole: bool },
    Position { vertex: u32, position: DVec3 },
}

/// Steps that change a mesh together, in their order: begun by [`ControlMesh::edit`], carried out by [`Model::apply`].
///
/// ```
/// use hullform::mesh::{Model, builtin};
/// let mut model = Model::new(builtin("cube")?);
/// let mut edit = model.mesh().edit();
/// edit.crease(0, 1, 2.5).corner(7, 10.0).position(3, [-1.0, -1.0, 1.5]);
/// let changes = model.apply(&edit)?;
/// assert_eq!(model.topology().vertex_sharpness(7), 10.0);
/// assert!(changes.faces().len() < model.mesh().face_count() + 1);
/// // What does not go is refused as a whole, by the place that is wrong.
/// let mut edit = model.mesh().edit();
/// edit.corner(2, 1.0).crease(0, 6, 1.0);
/// assert!(model.apply(&edit).is_err());
/// assert_eq!(model.topology().vertex_sharpness(2), 0.0);
/// # Ok::<(), hullform::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edit {
    steps: Vec<Step>,
}

/// What an edit has changed of a model.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChangeSet {
    before: u64,
    after: u64,
    faces: Vec<u32>,
    moved: Vec<u32>,
    is_placed_anew: bool,
}

impl ControlMesh {
    /// Begins an edit.
    pub fn edit(&self) -> Edit {
        Edit::default()
    }
}

impl Edit {
    /// Makes the edge `a`-`b` a crease of this sharpness, or smooth with 0; 10 or more is infinite. Boundaries are sharp whatever is said of them.
    pub fn crease(&mut self, a: u32, b: u32, sharpness: f32) -> &mut Edit {
        let vertices = [a, b];
        self.steps.push(Step::Crease(Crease {
            vertices,
            sharpness,
        }));
        self
    }

    /// Makes `vertex` a corner of this sharpness, or smooth with 0; 10 or more is infinite.
    pub fn corner(&mut self, vertex: u32, sharpness: f32) -> &mut Edit {
        self.steps.push(Step::Corner(Corner { vertex, sharpness }));
        self
    }

    /// Makes `face` a hole, or draws it again.
    pub fn hole(&mut self, face: u32, hole: bool) -> &mut Edit {
        self.steps.push(Step::Hole { face, hole });
        self
    }

    /// Moves `vertex` to a place, in the mesh's units.
    pub fn position(&mut self, vertex: u32, position: [f64; 3]) -> &mut Edit {
        let position = position.into();
        self.steps.push(Step::Position { vertex, position });
        self
    }

    /// Whether it has no step.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }
}

impl ChangeSet {
    /// The faces that look different from their own surroundings, ascending: what was planned for others is still right. Positions do not count, plans do not
    /// depend on them.
    pub fn faces(&self) -> &[u32] {
        &self.faces
    }

    /// The vertices that were moved, ascending.
    pub fn moved(&self) -> &[u32] {
        &self.moved
    }

    /// Whether the bounding box is another one, and with it the [`Placement`](crate::mesh::Placement): then all local positions are other ones.
    pub fn is_placed_anew(&self) -> bool {
        self.is_placed_anew
    }

    /// The revision of the model that was edited.
    pub(crate) fn before(&self) -> u64 {
        self.before
    }

    /// The revision that came of it.
    pub(crate) fn after(&self) -> u64 {
        self.after
    }
}

/// The edge between two vertices.
fn edge_between(topology: &Topology, [a, b]: [u32; 2]) -> Option<u32> {
    // Whichever vertex has fewer.
    let around = [(a, b), (b, a)].map(|(from, to)| (topology.vertex_edges(from), to));
    let (edges, to) = around.into_iter().min_by_key(|(edges, _)| edges.len())?;
    let joins = |&&edge: &&u32| a != b && topology.edge(edge).vertices.contains(&to);
    edges.iter().find(joins).copied()
}

impl Model {
    /// Carries out an edit: all of it, or, where any step is refused, nothing.
    ///
    /// # Errors
    /// [`Error::Input`] with the edge, vertex or face for one that is not there, a sharpness below 0 or one that the scheme knows no rule for, and a
    /// position that is not finite, or beyond 1e300 and a face's.
    pub fn apply(&mut self, edit: &Edit) -> Result<ChangeSet> {
        let edges = edit.steps.iter().map(|step| self.check(step));
        let edges: Vec<Option<u32>> = edges.collect::<Result<_>>()?;
        let mut retagged = Retagged {
            edges: edges.into_iter().flatten().collect(),
            ..Retagged::default()
        };
        let mut changes = ChangeSet {
            before: self.revision,
            after: next_revision(),
            ..ChangeSet::default()
        };
        for &step in &edit.steps {
            match step {
                Step::Crease(crease) => self.mesh.set_crease(crease),
                Step::Corner(corner) => {
                    self.mesh.set_corner(corner);
                    retagged.vertices.push(corner.vertex);
                }
                Step::Hole { face, hole } => {
                    self.mesh.set_hole(face, hole);
                    retagged.faces.push(face);
                }
                Step::Position { vertex, position } => {
                    self.mesh.set_position(vertex, position);
                    changes.moved.push(vertex);
                }
            }
        }
        changes.faces = self.topology.retag(&self.mesh, &retagged);
        changes.moved.sort_unstable();
        changes.moved.dedup();
        if !changes.moved.is_empty() {
            let before = std::mem::replace(&mut self.placement, self.mesh.placement());
            changes.is_placed_anew = before != self.placement;
        }
        self.revision = changes.after;
        Ok(changes)
    }

    /// Whether a step goes; of a crease its edge.
    fn check(&self, step: &Step) -> Result<Option<u32>> {
        let scheme = self.mesh.options().scheme;
        let vertices = self.mesh.vertex_count();
        let is_vertex = |vertex: u32| match (vertex as usize) < vertices {
            true => Ok(()),
            false => Err(Error::input(
                Place::Vertex(vertex as usize),
                format!("an edit names it, but the mesh has {vertices} vertices"),
                "vertex indices must be below the number of vertices",
            )),
        };
        match *step {
            Step::Crease(Crease {
                vertices: [a, b],
                sharpness,
            }) => {
                let place = || Place::Edge(a as usize, b as usize);
                let edge = edge_between(&self.topology, [a, b]).ok_or_else(|| {
                    Error::input(
                        place(),
                        "an edit names it, but no face has this edge",
                        "creases need two neighbouring vertices of a face",
                    )
                })?;
                check_sharpness(place(), sharpness)?;
                scheme.check_sharpness(place(), sharpness)?;
                return Ok(Some(edge));
            }
            Step::Corner(Corner { vertex, sharpness }) => {
                is_vertex(vertex)?;
                let place = || Place::Vertex(vertex as usize);
                check_sharpness(place(), sharpness)?;
                scheme.check_sharpness(place(), sharpness)?;
            }
            Step::Hole { face, .. } => {
                let faces = self.mesh.face_count();
                if face as usize >= faces {
                    return Err(Error::input(
                        Place::Face(face as usize),
                        format!("an edit names it, but the mesh has {faces} faces"),
                        "face indices must be below the number of faces",
                    ));
                }
            }
            Step::Position { vertex, position } => {
                is_vertex(vertex)?;
                let is_used = !self.topology.vertex_faces(vertex).is_empty();
                check_position(vertex as usize, position, is_used)?;
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BoundaryInterpolation, CreaseMethod, Scheme, SchemeOptions, builtin};

    /// Adds a step that does not go.
    type Wrong = fn(&mut Edit) -> &mut Edit;

    /// Numbers without a pattern (splitmix64).
    fn random(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = *state;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    fn step(edit: &mut Edit, model: &Model, state: &mut u64) {
        let mut below = |count: usize| (random(state) % count as u64) as u32;
        let sharpness = [0.0, 0.3, 1.0, 2.5, 10.0][below(5) as usize];
        let topology = model.topology();
        let vertex = below(topology.vertex_count());
        match below(5) {
            0 => edit.corner(vertex, sharpness),
            1 => edit.hole(below(topology.face_count()), below(2) == 0),
            2 => edit.position(vertex, [0.1 * f64::from(sharpness), 0.0, 1.0]),
            _ => {
                let [a, b] = topology.edges()[below(topology.edge_count()) as usize].vertices;
                edit.crease(b, a, sharpness)
            }
        };
    }

    /// Three quads on an edge, and a fourth that touches one of them in a vertex.
    fn fins() -> ControlMesh {
        let positions: Vec<[f64; 3]> = (0..11).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let faces = [0, 1, 2, 3, 1, 0, 4, 5, 0, 1, 6, 7, 3, 8, 9, 10];
        let mesh = ControlMesh::builder(&positions, &[4; 4], &faces).build();
        mesh.expect("a sound mesh")
    }

    fn under(name: &str, boundary: BoundaryInterpolation, creasing: CreaseMethod) -> ControlMesh {
        let mesh = match name {
            "fins" => fins(),
            name => builtin(name).expect("it is built in"),
        };
        let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
        let faces: Vec<u32> = mesh.faces().flatten().copied().collect();
        let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
        let builder = ControlMesh::builder(&positions, &sizes, &faces);
        let options = SchemeOptions {
            boundary,
            creasing,
            ..SchemeOptions::default()
        };
        let builder = mesh.creases().iter().fold(builder, |builder, crease| {
            let [a, b] = crease.vertices;
            builder.crease(a, b, crease.sharpness)
        });
        builder.options(options).build().expect("a sound mesh")
    }

    /// Everything that is asked of a topology, whatever the rules of boundaries and creases, on open, closed and non-manifold meshes.
    #[test]
    fn an_edited_model_is_that_of_the_edited_mesh() {
        use BoundaryInterpolation::{EdgeAndCorner, EdgeOnly, None};
        let mut state = 7;
        for name in ["hull", "cubes-2x2x2", "sheet", "ngons", "fins"] {
            for boundary in [None, EdgeOnly, EdgeAndCorner] {
                for creasing in [CreaseMethod::Uniform, CreaseMethod::Chaikin] {
                    let mut model = Model::new(under(name, boundary, creasing));
                    for number in 0..60 {
                        let mut edit = model.mesh().edit();
                        (0..1 + number % 3).for_each(|_| step(&mut edit, &model, &mut state));
                        let before = model.clone();
                        let changes = model.apply(&edit).expect("all of it is there");
                        let fresh = Model::new(model.mesh().clone());
                        let what = format!("{name} {boundary:?} {creasing:?} {number} {edit:?}");
                        let differing = model.topology().differing(fresh.topology());
                        assert_eq!(differing, [0; 0], "{what}");
                        assert_eq!(model.placement(), fresh.placement(), "{what}");
                        let changed = model.topology().differing(before.topology());
                        let told = |face: &u32| changes.faces().contains(face);
                        assert!(changed.iter().all(told), "{what}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_refused_changes_nothing_and_says_where() {
        let mesh = builtin("cube").expect("it is built in");
        let mut model = Model::new(mesh.clone());
        let revision = model.revision;
        let edits: [(&str, Wrong); 10] = [
            ("edge 0-6: ", |edit| edit.crease(0, 6, 1.0)),
            ("edge 3-3: ", |edit| edit.crease(3, 3, 1.0)),
            ("edge 0-99: ", |edit| edit.crease(0, 99, 1.0)),
            ("edge 0-1: ", |edit| edit.crease(0, 1, -1.0)),
            ("edge 0-1: ", |edit| edit.crease(0, 1, f32::NAN)),
            ("vertex 8: ", |edit| edit.corner(8, 1.0)),
            ("vertex 7: ", |edit| edit.corner(7, -0.1)),
            ("face 6: ", |edit| edit.hole(6, true)),
            ("vertex 8: ", |edit| edit.position(8, [0.0; 3])),
            ("vertex 1: ", |edit| edit.position(1, [0.0, f64::NAN, 0.0])),
        ];
        for (place, wrong) in edits {
            let mut edit = model.mesh().edit();
            edit.corner(0, 5.0).hole(2, true).position(4, [9.0; 3]);
            wrong(&mut edit);
            let refused = model.apply(&edit).expect_err("it does not go").to_string();
            assert!(refused.starts_with(place), "{refused}");
            assert!(refused.contains("; "), "a remedy: {refused}");
            assert_eq!((model.mesh(), model.revision), (&mesh, revision));
            let fresh = Topology::new(&mesh);
            assert_eq!(model.topology().differing(&fresh), [0; 0]);
        }
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let triangle = ControlMesh::builder(&positions, &[3], &[0, 1, 2]);
        let triangle = triangle.scheme(Scheme::Butterfly).build();
        let mut model = Model::new(triangle.expect("a sound mesh"));
        let mut edit = model.mesh().edit();
        edit.crease(0, 1, 1.5);
        assert!(model.apply(&edit).is_err(), "no rule for it");
    }
}
