//! Edits of a mesh: faces, vertices, tags and positions. What an edit names is checked before anything changes.

mod apply;
mod draft;
#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::mesh::ControlMesh;
use crate::mesh::control_mesh::{Corner, Crease};
use crate::mesh::topology::GONE;

/// A step of an edit.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Vertex(DVec3),
    AddFace(Vec<u32>),
    RemoveFace(u32),
    ReconnectFace(u32, Vec<u32>),
    Crease(Crease),
    Corner(Corner),
    Hole { face: u32, hole: bool },
    Position { vertex: u32, position: DVec3 },
}

/// Steps that change a mesh together: begun by [`ControlMesh::edit`], carried out by [`Model::apply`](crate::mesh::Model::apply). Vertices and faces come first, in the order of
/// their steps; then tags and positions, in theirs. So tags may name what another step adds, and not what one removes.
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
    added: Vec<u32>,
    is_placed_anew: bool,
    /// By the numbers that edges had before, those that they have now; None where none has another one.
    edges: Option<Vec<u32>>,
}

impl ControlMesh {
    /// Begins an edit.
    pub fn edit(&self) -> Edit {
        Edit::default()
    }
}

impl Edit {
    /// Adds a vertex at a place, in the mesh's units. It gets the next number: [`ControlMesh::vertex_count`] for the first of an edit, and so on. Vertices stay;
    /// what no face uses any more may be used again.
    pub fn add_vertex(&mut self, position: [f64; 3]) -> &mut Edit {
        self.steps.push(Step::Vertex(position.into()));
        self
    }

    /// Adds a face of three vertices or more. It gets the least number of a face that was removed and had as many corners, or else the next; see
    /// [`ChangeSet::added`]. In a mesh with texture coordinates its corners get those of other faces there, or else (0, 0).
    pub fn add_face(&mut self, vertices: &[u32]) -> &mut Edit {
        self.steps.push(Step::AddFace(vertices.to_vec()));
        self
    }

    /// Removes `face`. Its number stays vacant until a face of as many corners takes it; creases that are on no edge any more go, and so does its hole.
    pub fn remove_face(&mut self, face: u32) -> &mut Edit {
        self.steps.push(Step::RemoveFace(face));
        self
    }

    /// Connects the corners of `face` to other vertices, as many as it has.
    pub fn reconnect_face(&mut self, face: u32, vertices: &[u32]) -> &mut Edit {
        let vertices = vertices.to_vec();
        self.steps.push(Step::ReconnectFace(face, vertices));
        self
    }

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

    /// The vertices whose local positions may be other ones, ascending: those that were moved or added, and those that faces have begun or ceased to use.
    pub fn moved(&self) -> &[u32] {
        &self.moved
    }

    /// The faces that were added, in the order of the steps.
    pub fn added(&self) -> &[u32] {
        &self.added
    }

    /// Whether faces were added, removed or connected otherwise. Edges have other numbers then.
    pub fn is_reconnected(&self) -> bool {
        self.edges.is_some()
    }

    /// The number that an edge has now; None where no face has it any more.
    pub(crate) fn edge(&self, before: u32) -> Option<u32> {
        match &self.edges {
            None => Some(before),
            Some(edges) => edges
                .get(before as usize)
                .copied()
                .filter(|&edge| edge != GONE),
        }
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
