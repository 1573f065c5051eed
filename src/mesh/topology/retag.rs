//! Sharpness and holes after tags have changed, from what is around the places that they name: bit for bit what [`Topology::new`] finds.

use smallvec::SmallVec;

use crate::mesh::control_mesh::creased_edges;
use crate::mesh::creased_edges::CreasedEdges;
use crate::mesh::sharpness::{decayed_around_vertex, is_infinite};
use crate::mesh::topology::{Topology, clamp};
use crate::mesh::{ControlMesh, INFINITE_SHARPNESS};

/// Where tags of a mesh have changed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Retagged {
    /// Edges, by their numbers.
    pub edges: Vec<u32>,
    /// Vertices.
    pub vertices: Vec<u32>,
    /// Vertices around which there are other edges than before.
    pub around: Vec<u32>,
    /// Faces that have become holes, or stopped being any.
    pub faces: Vec<u32>,
}

/// What the tags of a mesh say.
struct Tags<'a> {
    mesh: &'a ControlMesh,
    creased: CreasedEdges,
}

impl Tags<'_> {
    fn sharpness(&self, ends: [u32; 2]) -> f32 {
        let crease = self.creased.crease(ends);
        clamp(crease.map_or(0.0, |crease| self.mesh.creases()[crease].sharpness))
    }
}

impl Topology {
    /// Brings sharpness and holes up to the tags of a mesh, which are other ones at some places alone. Tells which faces look different from their own
    /// surroundings now, ascending: those at vertices where anything is of another sharpness, those that have become holes or stopped being any, and the
    /// ones beside these.
    pub(crate) fn retag(&mut self, mesh: &ControlMesh, changed: &Retagged) -> Vec<u32> {
        let tags = Tags {
            mesh,
            creased: creased_edges(mesh),
        };
        let mut vertices: Vec<u32> = Vec::new();
        for &edge in &changed.edges {
            let sharpness = self.sharpness_by(&tags, edge);
            let own = &mut self.edges[edge as usize];
            if own.sharpness.to_bits() != sharpness.to_bits() {
                own.sharpness = sharpness;
                vertices.extend(own.vertices);
            }
        }
        let ends = changed
            .edges
            .iter()
            .flat_map(|&edge| self.edge(edge).vertices);
        let mut ends: Vec<u32> = ends.chain(changed.around.iter().copied()).collect();
        ends.sort_unstable();
        ends.dedup();
        for &vertex in &ends {
            self.foresee_at(&tags, vertex, &mut vertices);
        }
        let tagged = changed.vertices.iter().chain(&changed.around);
        self.retag_vertices(mesh, tagged, &mut vertices);
        vertices.extend(&changed.around);
        let holes = self.retag_holes(&tags, &ends, &changed.faces);
        let around = vertices
            .iter()
            .flat_map(|&vertex| self.vertex_faces(vertex));
        let mut faces: Vec<u32> = around.map(|at| at.face).collect();
        // Those that were removed are around nothing.
        faces.extend(
            changed
                .faces
                .iter()
                .filter(|&&face| self.face(face).is_empty()),
        );
        for &hole in &holes {
            faces.push(hole);
            let beside = self.face_edges(hole).iter();
            faces.extend(beside.flat_map(|&edge| self.edge_faces(edge)));
        }
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// What an edge's tag, its boundary and what is not manifold make of it.
    fn sharpness_by(&self, tags: &Tags<'_>, edge: u32) -> f32 {
        if self.edge_faces(edge).len() < 2 || !self.is_manifold_edge(edge) {
            return INFINITE_SHARPNESS;
        }
        tags.sharpness(self.edge(edge).vertices)
    }

    /// As `Topology::manifold_edges` finds it for all.
    fn is_manifold_edge(&self, edge: u32) -> bool {
        let from = self.edge(edge).vertices[0];
        let mut walks = [0; 2];
        for &face in self.edge_faces(edge) {
            let edges = self.face_edges(face).iter();
            let corner = edges.into_iter().position(|&own| own == edge);
            let corner = corner.expect("a face on the edge has it");
            walks[usize::from(self.face(face)[corner] != from)] += 1;
        }
        walks[0] < 2 && walks[1] < 2
    }

    /// Computes the sharpness at the next level of the edges around a vertex, there, as `Topology::foresee` does for all.
    fn foresee_at(&mut self, tags: &Tags<'_>, vertex: u32, changed: &mut Vec<u32>) {
        let around: SmallVec<[u32; 8]> = self.vertex_edges(vertex).into();
        let is_boundary = |topology: &Topology, edge: u32| topology.edge_faces(edge).len() < 2;
        let sharpness = around.iter().map(|&edge| {
            let own = self.edge(edge);
            // What holes leave of boundaries is taken by its tags here, see `Topology::new`.
            if self.has_open_boundaries() && is_boundary(self, edge) {
                tags.sharpness(own.vertices)
            } else {
                own.sharpness
            }
        });
        let sharpness: SmallVec<[f32; 8]> = sharpness.collect();
        let next = decayed_around_vertex(self.options.creasing, &sharpness);
        for (&edge, next) in around.iter().zip(next) {
            let next = match is_boundary(self, edge) {
                true => INFINITE_SHARPNESS,
                false => next,
            };
            let vertices = self.edge(edge).vertices;
            let mut both = self.next_sharpness(edge);
            let own = &mut both[usize::from(vertices[1] == vertex)];
            if own.to_bits() != next.to_bits() {
                *own = next;
                self.set_next(edge, both);
                changed.extend(vertices);
            }
        }
    }

    fn retag_vertices<'a>(
        &mut self,
        mesh: &ControlMesh,
        vertices: impl Iterator<Item = &'a u32> + Clone,
        changed: &mut Vec<u32>,
    ) {
        if vertices.clone().next().is_none() {
            return;
        }
        let manifold = self.manifold_edges();
        for &vertex in vertices {
            let corners = mesh.corners().iter().rev();
            let tag = corners.into_iter().find(|corner| corner.vertex == vertex);
            let sharpness = match self.is_sharpened(vertex, &manifold) {
                true => INFINITE_SHARPNESS,
                false => clamp(tag.map_or(0.0, |corner| corner.sharpness)),
            };
            let own = &mut self.vertex_sharpness[vertex as usize];
            if own.to_bits() != sharpness.to_bits() {
                *own = sharpness;
                changed.push(vertex);
            }
        }
    }

    /// Brings holes up to date; tells which faces have become one, or stopped being any.
    fn retag_holes(&mut self, tags: &Tags<'_>, ends: &[u32], faces: &[u32]) -> Vec<u32> {
        let mut asked = faces.to_vec();
        if self.has_open_boundaries() {
            let around = ends.iter().flat_map(|&vertex| self.vertex_faces(vertex));
            asked.extend(around.map(|at| at.face));
            asked.sort_unstable();
            asked.dedup();
        }
        let mut changed = Vec::new();
        for face in asked {
            let is_hole = self.face(face).is_empty()
                || tags.mesh.holes().contains(&face)
                || self.is_left_open(tags, face);
            if std::mem::replace(&mut self.holes[face as usize], is_hole) != is_hole {
                changed.push(face);
            }
        }
        changed
    }

    /// As `Topology::open_boundary_faces` finds it for all.
    fn is_left_open(&self, tags: &Tags<'_>, face: u32) -> bool {
        let is_open = |&edge: &u32| {
            self.edge_faces(edge).len() < 2
                && !is_infinite(tags.sharpness(self.edge(edge).vertices))
        };
        let mut vertices = self.face(face).iter();
        self.has_open_boundaries()
            && vertices.any(|&vertex| self.vertex_edges(vertex).iter().any(is_open))
    }
}

#[cfg(test)]
impl Topology {
    /// The faces of either that look different from their own surroundings: by vertices, whatever the numbers of edges.
    pub(crate) fn differing(&self, other: &Topology) -> Vec<u32> {
        let both = [self, other];
        let edge = |of: &Topology, edge: u32| {
            let next = of.next_sharpness(edge).map(f32::to_bits);
            let own = of.edge(edge);
            (own.vertices, own.sharpness.to_bits(), next)
        };
        let at_vertex = |vertex: u32| {
            both.map(|of| {
                let edges = of.vertex_edges(vertex).iter().map(|&own| edge(of, own));
                let edges: Vec<_> = edges.collect();
                let faces = of.vertex_faces(vertex).to_vec();
                (of.vertex_sharpness(vertex).to_bits(), edges, faces)
            })
        };
        let is_different = |&face: &u32| {
            let [one, two] = both.map(|of| {
                let edges = of.face_edges(face).iter().map(|&own| edge(of, own));
                (of.is_hole(face), of.face(face), edges.collect::<Vec<_>>())
            });
            one != two
                || one.1.iter().any(|&vertex| {
                    let [one, two] = at_vertex(vertex);
                    one != two
                })
        };
        let faces = 0..self.face_count().max(other.face_count()) as u32;
        faces.filter(is_different).collect()
    }

    /// Whether all that is asked of them is the same, numbers included.
    pub(crate) fn is_same(&self, other: &Topology) -> bool {
        let [one, two] = [self, other].map(|of| {
            let next = (0..of.edge_count() as u32).map(|edge| of.next_sharpness(edge));
            let next: Vec<_> = next.map(|next| next.map(f32::to_bits)).collect();
            let all = 0..of.vertex_count().max(of.edge_count()) as u32;
            let lists = all.map(|i| (of.edge_faces(i), of.vertex_faces(i), of.vertex_edges(i)));
            let sharpness = of.vertex_sharpness.iter().map(|own| own.to_bits());
            (
                next,
                lists.collect::<Vec<_>>(),
                sharpness.collect::<Vec<_>>(),
                (&of.faces, &of.face_edges, &of.edges, &of.holes),
            )
        });
        one == two
    }
}
