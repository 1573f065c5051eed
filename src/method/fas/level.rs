//! A level of refinement, and points that are sums over its vertices.

use std::borrow::Cow;

use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::method::points::{Points, Row};
use crate::subdivision::Mask;

/// A level: its faces with all that touches them.
pub struct Level<'a> {
    pub topology: Cow<'a, Topology>,
    /// The point of vertex 0; those of the others follow.
    pub first_point: u32,
    /// How many levels there are to come.
    pub left: u32,
    /// The faces that are no B-splines: they are refined, or at the last level have end caps.
    pub is_irregular: Vec<bool>,
}

impl Level<'_> {
    /// Adds a point, a sum over the vertices of this level; tells its number.
    pub fn push(&self, points: &mut Points, mask: &Mask) -> u32 {
        let mut terms: Vec<(u32, f64)> = mask
            .iter()
            .map(|&(vertex, weight)| (self.first_point + vertex, weight))
            .collect();
        // A vertex may occur more than once.
        terms.sort_by_key(|&(point, _)| point);
        terms.dedup_by(|next, sum| {
            let alike = next.0 == sum.0;
            if alike {
                sum.1 += next.1;
            }
            alike
        });
        terms.retain(|&(_, weight)| weight != 0.0);
        let number = points.count;
        points.push(Row::Blend(&terms.into_iter().collect()));
        number
    }

    /// Whether nothing at a vertex inside is sharp any more at the last level.
    pub fn is_smooth(&self, vertex: u32) -> bool {
        let topology = &self.topology;
        let stays = |sharpness: f32| is_infinite(sharpness) || sharpness > self.left as f32;
        let mut sharp = topology.sharp_edges(vertex);
        let inside = |edge: u32| topology.edge_faces(edge).len() > 1;
        let alone = topology.vertex_faces(vertex).len() == 1;
        !sharp.any(|edge| inside(edge) && stays(topology.edge(edge).sharpness))
            && (alone || !stays(topology.vertex_sharpness(vertex)))
    }
}
