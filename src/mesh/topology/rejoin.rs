//! Faces that are added, removed or connected otherwise: who touches whom afterwards, numbered as [`Topology::new`] numbers it.
//!
//! Edges are numbered in the order in which faces show them, and lists around vertices go by these numbers; sums follow them. A number that stayed where
//! it was when a face before it goes would be another surface, in its last bits. So numbers are dealt anew, but nothing is searched for: edges of faces that stay
//! are known, and those of a few others are looked up around their ends. What is as sharp as it was is carried over.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use crate::mesh::ControlMesh;
use crate::mesh::faces::Slot;
use crate::mesh::topology::Topology;

/// What became of edges.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Rejoined {
    /// By their numbers before, those that they have now; [`GONE`] of those that no face has any more.
    pub edges: Vec<u32>,
    /// The vertices of the faces that are other ones, as they were and as they are, ascending.
    pub vertices: Vec<u32>,
    /// The edges that these faces have now, and those that they had and others still have.
    pub own: Vec<u32>,
}

/// Instead of an edge: no face has it any more.
pub(crate) const GONE: u32 = u32::MAX;

impl Topology {
    /// The edge between two vertices.
    pub(crate) fn edge_between(&self, [a, b]: [u32; 2]) -> Option<u32> {
        // Whichever vertex has fewer.
        let around = [(a, b), (b, a)].map(|(from, to)| (self.vertex_edges(from), to));
        let (edges, to) = around.into_iter().min_by_key(|(edges, _)| edges.len())?;
        let joins = |&&edge: &&u32| a != b && self.edge(edge).vertices.contains(&to);
        edges.iter().find(joins).copied()
    }

    /// Takes over the faces of a mesh, which are other ones in some places. Edges that come are smooth and faces that come no holes until
    /// [`Topology::retag`] says what they are.
    pub(crate) fn rejoin(&mut self, mesh: &ControlMesh, slots: &BTreeMap<u32, Slot>) -> Rejoined {
        let mut old = std::mem::take(self);
        let touched = slots.iter().flat_map(|(&face, slot)| {
            let before = old.face(face).iter();
            before.chain(&slot.vertices).copied()
        });
        let mut vertices: Vec<u32> = touched.collect();
        vertices.sort_unstable();
        vertices.dedup();
        let known = old.edge_count();
        let sides = old.sides_among(mesh, slots);
        let mut first_of = vec![GONE; known];
        let mut first = Vec::with_capacity(sides.len());
        for (side, &edge) in (0..).zip(&sides) {
            let edge = edge as usize;
            if edge >= first_of.len() {
                first_of.resize(edge + 1, GONE);
            }
            if first_of[edge] == GONE {
                first_of[edge] = side;
            }
            first.push(first_of[edge]);
        }
        let mut sharpness = std::mem::take(&mut old.vertex_sharpness);
        sharpness.resize(mesh.vertex_count(), 0.0);
        let mut holes = std::mem::take(&mut old.holes);
        holes.resize(mesh.face_count(), false);
        for (&face, slot) in slots {
            holes[face as usize] = slot.vertices.is_empty();
        }
        let mut joined = Topology::apart(mesh.shared_faces().clone(), sharpness, old.options);
        joined.holes = holes;
        joined.join(&first, |side, from, to| {
            let edge = sides[side];
            match (edge as usize) < known {
                true => {
                    let next = [from, to].map(|end| old.next_at(edge, end));
                    (old.edge(edge).sharpness, next)
                }
                false => (0.0, [0.0; 2]),
            }
        });
        let number = |&side: &u32| match side {
            GONE => GONE,
            side => joined.face_edges[side as usize],
        };
        let edges: Vec<u32> = first_of[..known].iter().map(number).collect();
        let had = slots.keys().flat_map(|&face| old.face_edges(face));
        let had = had.map(|&edge| edges[edge as usize]);
        let have = slots.keys().flat_map(|&face| joined.face_edges(face));
        let mut own: Vec<u32> = have
            .copied()
            .chain(had.filter(|&edge| edge != GONE))
            .collect();
        own.sort_unstable();
        own.dedup();
        *self = joined;
        Rejoined {
            edges,
            vertices,
            own,
        }
    }

    /// Of each side of all faces its edge by the number that it had, or by one behind these.
    fn sides_among(&self, mesh: &ControlMesh, slots: &BTreeMap<u32, Slot>) -> Vec<u32> {
        let faces = mesh.shared_faces();
        let mut sides = Vec::with_capacity(faces.vertices().len());
        let mut new: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        let mut from = 0;
        for (&face, slot) in slots {
            let own = self.faces.range(face as usize);
            let own = match own.is_empty() {
                true => self.faces.start(face as usize),
                false => own,
            };
            sides.extend_from_slice(&self.face_edges[from..own.start]);
            from = own.end;
            let vertices = &slot.vertices;
            for (corner, &a) in vertices.iter().enumerate() {
                let b = vertices[if corner + 1 < vertices.len() {
                    corner + 1
                } else {
                    0
                }];
                let next = (self.edge_count() + new.len()) as u32;
                let known = self.edge_between([a, b]);
                let edge =
                    known.unwrap_or_else(|| *new.entry([a.min(b), a.max(b)]).or_insert(next));
                sides.push(edge);
            }
        }
        sides.extend_from_slice(&self.face_edges[from..]);
        sides
    }
}
