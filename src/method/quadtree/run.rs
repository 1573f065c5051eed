//! Patches on their way to a pass.

use rustc_hash::FxHashMap;

use crate::mesh::topology::Topology;
use crate::method::patches::Part;
use crate::method::quadtree::configurations::Configurations;
use crate::method::quadtree::irregular::Record;
use crate::method::quadtree::surroundings::Surroundings;
use crate::plan::Ring;
use crate::plan::database::Kind;

/// Patches on their way to a pass, and the different configurations that they have.
#[derive(Default)]
pub struct Run {
    pub slots: Vec<u32>,
    pub configurations: Configurations,
    /// Those of smooth rings, by their keys.
    smooth: FxHashMap<u32, u32>,
}

impl Run {
    /// What a patch is; its plan is the number of its configuration in the run, which is taken.
    pub fn record(
        &mut self,
        topology: &Topology,
        part: Part,
        surroundings: &mut Surroundings,
    ) -> Record {
        let mut number = |configuration| self.configurations.number(Kind::Inside, configuration);
        match surroundings {
            Surroundings::Regular(_) => unreachable!("it needs no plan"),
            Surroundings::Smooth(start, ring) => {
                let plan = self.smooth.entry(start.key).or_insert_with(|| {
                    let ring = Ring::of_quad(topology, part.face);
                    number(ring.expect("a smooth face is a quad").configuration)
                });
                Record {
                    part,
                    plan: *plan,
                    ring_size: ring.vertices().len() as u32,
                    start: start.corner as u8,
                    mirrored: start.mirrored,
                    is_smooth: true,
                }
            }
            Surroundings::Irregular(ring) => Record {
                part,
                plan: number(std::mem::take(&mut ring.configuration)),
                ring_size: ring.vertices.len() as u32,
                start: ring.start as u8,
                mirrored: ring.mirrored,
                is_smooth: false,
            },
        }
    }
}
