//! Refinement levels with every vertex kept as a row of weights over the 1-ring.

use crate::mesh::topology::Topology;
use crate::plan::configuration::Configuration;
use crate::plan::sums::Sums;
use crate::subdivision::{Refinement, refine, refine_edge};

/// A refinement level: some cells in their surroundings, each vertex a row of weights.
#[derive(Clone)]
pub(super) struct Level {
    pub topology: Topology,
    pub rows: Sums,
}

impl Level {
    /// The configuration's own faces.
    pub fn whole(configuration: &Configuration) -> Level {
        let topology = configuration.topology();
        Level {
            rows: Sums::identity(topology.vertex_count()),
            topology,
        }
    }

    /// The level at which the plan of a face begins: the quad itself, or the n-gon's part at its corner 0.
    pub fn base(configuration: &Configuration) -> Level {
        let base = Level::whole(configuration);
        if base.topology.face(0).len() == 4 {
            base
        } else {
            base.refined(&[(0, 0)])
        }
    }

    /// The next level of some cells.
    pub fn refined(&self, cells: &[(u32, u32)]) -> Level {
        self.next(refine(&self.topology, cells))
    }

    /// The next level of the two halves of an edge; see [`refine_edge`].
    pub fn refined_edge(&self, edge: u32, from: u32, sides: &[u32]) -> Level {
        self.next(refine_edge(&self.topology, edge, from, sides))
    }

    fn next(&self, refined: Refinement) -> Level {
        Level {
            topology: refined.topology,
            rows: self.rows.next(&refined.masks),
        }
    }
}
