//! Carrying out an edit: all of it, or nothing.

use std::collections::BTreeMap;
use std::sync::Arc;

use rustc_hash::FxHashSet;

use crate::error::{Error, Place, Result};
use crate::mesh::Model;
use crate::mesh::control_mesh::{Corner, Crease, check_position, check_sharpness};
use crate::mesh::edit::draft::Draft;
use crate::mesh::edit::{ChangeSet, Edit, Step};
use crate::mesh::faces::Slot;
use crate::mesh::model::next_revision;
use crate::mesh::topology::{GONE, Rejoined, Retagged, Topology};

impl Model {
    /// Carries out an edit: all of it, or, where any step is refused, nothing.
    ///
    /// # Errors
    /// [`Error::Input`] with the edge, vertex or face for one that is not there, a face of fewer than three vertices or one that names a vertex twice, a face
    /// of more corners than the scheme takes, or that is to be connected to more or fewer vertices than it has, a sharpness below 0 or one that the scheme knows no rule for,
    /// and a position that is not finite, or beyond 1e300 and a face's; with the mesh for one that is left without faces.
    pub fn apply(&mut self, edit: &Edit) -> Result<ChangeSet> {
        let draft = self.draft(edit)?;
        edit.steps
            .iter()
            .try_for_each(|step| self.check(&draft, step))?;
        let Draft {
            slots,
            positions,
            added,
            ..
        } = draft;
        let mut changes = ChangeSet {
            before: self.revision,
            after: next_revision(),
            added,
            ..ChangeSet::default()
        };
        let vertices = self.mesh.vertex_count() as u32;
        changes
            .moved
            .extend(vertices..vertices + positions.len() as u32);
        self.mesh.add_vertices(&positions);
        let mut retagged = Retagged::default();
        // Vertices alone touch nothing, but are counted.
        if !slots.is_empty() || !positions.is_empty() {
            let Rejoined {
                edges,
                vertices,
                own,
            } = self.reshape(slots, &mut retagged.faces, &mut changes.moved);
            (retagged.edges, retagged.around) = (own, vertices);
            changes.edges = Some(edges);
        }
        for step in &edit.steps {
            self.set_tag(step, &mut retagged, &mut changes.moved);
        }
        changes.faces = Arc::make_mut(&mut self.topology).retag(&self.mesh, &retagged);
        changes.moved.sort_unstable();
        changes.moved.dedup();
        if !changes.moved.is_empty() {
            let before = std::mem::replace(&mut self.placement, self.mesh.placement());
            changes.is_placed_anew = before != self.placement;
        }
        self.revision = changes.after;
        Ok(changes)
    }

    /// The faces and vertices that an edit leads to.
    fn draft(&self, edit: &Edit) -> Result<Draft<'_>> {
        let mut draft = Draft::new(&self.mesh);
        for step in &edit.steps {
            match step {
                Step::Vertex(position) => draft.add_vertex(*position)?,
                Step::AddFace(vertices) => draft.add_face(vertices)?,
                Step::RemoveFace(face) => draft.remove_face(*face)?,
                Step::ReconnectFace(face, vertices) => draft.reconnect_face(*face, vertices)?,
                _ => {}
            }
        }
        draft.finish()?;
        // Where its vertices are at last, unless a step moves them, which is checked by itself.
        let moved = edit.steps.iter().filter_map(|step| match step {
            Step::Position { vertex, .. } => Some(*vertex),
            _ => None,
        });
        let moved: FxHashSet<u32> = moved.collect();
        for &vertex in draft.used.difference(&moved) {
            check_position(vertex as usize, draft.position(vertex), true)?;
        }
        Ok(draft)
    }

    /// Takes over faces; adds those that have changed, and the vertices that they have begun or ceased to use.
    fn reshape(
        &mut self,
        slots: BTreeMap<u32, Slot>,
        faces: &mut Vec<u32>,
        moved: &mut Vec<u32>,
    ) -> Rejoined {
        let Model { mesh, topology, .. } = self;
        let topology = Arc::make_mut(topology);
        let indices = mesh.texture().map(|texture| texture.indices.clone());
        let before = mesh.shared_faces().clone();
        mesh.set_faces(&slots, |vertex| {
            let at = topology.vertex_faces(vertex).first()?;
            let corner = before.range(at.face as usize).start + at.corner as usize;
            indices.as_ref()?.get(corner).copied()
        });
        let used = |topology: &Topology, vertex: u32| !topology.vertex_faces(vertex).is_empty();
        let corners = slots.iter().flat_map(|(&face, slot)| {
            let had = topology.face(face).iter();
            had.chain(&slot.vertices)
        });
        let were: Vec<(u32, bool)> = corners
            .map(|&vertex| (vertex, used(topology, vertex)))
            .collect();
        let lost = slots.keys().flat_map(|&face| topology.face_edges(face));
        let lost: Vec<(u32, [u32; 2])> = lost
            .map(|&edge| (edge, topology.edge(edge).vertices))
            .collect();
        let rejoined = topology.rejoin(mesh, &slots);
        let lost = lost
            .into_iter()
            .filter(|&(edge, _)| rejoined.edges[edge as usize] == GONE);
        let lost: FxHashSet<[u32; 2]> = lost.map(|(_, [a, b])| [a.min(b), a.max(b)]).collect();
        if !lost.is_empty() {
            mesh.retain_creases(|[a, b]| !lost.contains(&[a.min(b), a.max(b)]));
        }
        let other = were
            .into_iter()
            .filter(|&(vertex, was)| used(topology, vertex) != was);
        moved.extend(other.map(|(vertex, _)| vertex));
        faces.extend(slots.keys());
        rejoined
    }

    /// Carries out a step that sets a tag or a position.
    fn set_tag(&mut self, step: &Step, retagged: &mut Retagged, moved: &mut Vec<u32>) {
        match *step {
            Step::Crease(crease) => {
                self.mesh.set_crease(crease);
                retagged
                    .edges
                    .extend(self.topology.edge_between(crease.vertices));
            }
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
                moved.push(vertex);
            }
            _ => {}
        }
    }

    /// Whether a step goes that sets a tag or a position.
    fn check(&self, draft: &Draft<'_>, step: &Step) -> Result<()> {
        let scheme = self.mesh.options().scheme;
        let vertices = draft.vertex_count();
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
                if !self.is_edge(draft, [a, b]) {
                    return Err(Error::input(
                        place(),
                        "an edit names it, but no face has this edge",
                        "creases need two neighbouring vertices of a face",
                    ));
                }
                check_sharpness(place(), sharpness)?;
                scheme.check_sharpness(place(), sharpness)
            }
            Step::Corner(Corner { vertex, sharpness }) => {
                is_vertex(vertex)?;
                let place = || Place::Vertex(vertex as usize);
                check_sharpness(place(), sharpness)?;
                scheme.check_sharpness(place(), sharpness)
            }
            Step::Hole { face, .. } => draft.check_is_face(face),
            Step::Position { vertex, position } => {
                is_vertex(vertex)?;
                check_position(vertex as usize, position, self.is_used(draft, vertex))
            }
            _ => Ok(()),
        }
    }

    /// Whether any face has an edge between two vertices at last.
    fn is_edge(&self, draft: &Draft<'_>, [a, b]: [u32; 2]) -> bool {
        let stays = |&face: &u32| !draft.slots.contains_key(&face);
        let known = self.topology.edge_between([a, b]);
        if known.is_some_and(|edge| self.topology.edge_faces(edge).iter().any(stays)) {
            return true;
        }
        draft.sides.contains(&[a.min(b), a.max(b)])
    }

    /// Whether any face uses a vertex at last.
    fn is_used(&self, draft: &Draft<'_>, vertex: u32) -> bool {
        let around = self.topology.vertex_faces(vertex).iter();
        around
            .into_iter()
            .any(|at| !draft.slots.contains_key(&at.face))
            || draft.used.contains(&vertex)
    }
}
