//! Plans as the bytes that the shaders read.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::plan::builder::Plan;
use crate::plan::packed_rows::{PackedRows, RowsView};
use crate::plan::strip::{Stretch, Strip};
use crate::plan::tree::{Node, NodeKind, child_of_corner};

/// Where a packed plan's parts begin, and how many stencils each level needs.
#[derive(Clone, Copy, Debug)]
pub struct PlanHeader {
    /// Vertices of the 1-ring.
    pub ring_size: u32,
    /// The number of its first stencil among all.
    pub rows: u32,
    /// Its root.
    pub root: u32,
    /// Its deepest level.
    pub max_level: u32,
    /// The number of stencils needed at level 0..=11; beyond the deepest level as there. An edge beside an n-gon is one level deeper than
    /// the patches that have half of it.
    pub counts: [u32; abi::HIGHEST_LEVEL as usize + 2],
}

/// The points of a terminal node's children that are B-splines, of all levels: each has its own list, so that a row of points is two words wherever it is.
fn children(corner: u32, levels: &[[u32; 25]]) -> Vec<u32> {
    let places = (1..4).flat_map(|step| {
        let child = (child_of_corner(corner) + step) % 4;
        let first = child % 2 + 5 * (child / 2);
        (0..16).map(move |point| first + point % 4 + 5 * (point / 4))
    });
    let places: Vec<usize> = places.collect();
    let level = |grid: &[u32; 25]| {
        places
            .iter()
            .map(|&place| grid[place])
            .collect::<Vec<u32>>()
    };
    levels.iter().flat_map(level).collect()
}

/// What a node's kind tells of the point that its points are relative to. Bases come first among the stencils, so their numbers are small.
fn base_bits(plan: &Plan, base: Option<u32>) -> u32 {
    base.map_or(0, |number| {
        let corner = plan.stencils.corner(number as usize);
        let origin = corner.map_or(0, |corner| abi::STENCIL_CORNER + corner);
        (number + 1) << abi::NODE_BASE_SHIFT | origin << abi::NODE_ORIGIN_SHIFT
    })
}

/// Plans packed one after another.
#[derive(Clone, Debug, Default)]
pub struct PackedPlans {
    /// One a plan; patches have copies of what their shaders need of these.
    pub headers: Vec<PlanHeader>,
    /// The quadtrees' nodes.
    pub nodes: Vec<abi::Node>,
    /// The nodes' points: numbers of stencils, sixteen a B-spline, two 16-bit halves a word, the lower first.
    pub points: Vec<u32>,
    /// The stencils, and behind those of each plan its tangents near corners.
    pub rows: PackedRows,
    /// For each plan the number, among its stencils, of the first of two tangents near each corner; [`abi::NO_TANGENTS`] without any.
    pub nearby: Vec<[u32; 4]>,
    /// Where nodes begin that are there, children of one parent side by side.
    known_nodes: FxHashMap<Box<[u32]>, u32>,
    /// Where lists begin that are there.
    known_lists: FxHashMap<Box<[u32]>, u32>,
}

impl PackedPlans {
    /// Appends a plan.
    ///
    /// # Errors
    /// [`Misuse::PlanTooLarge`] when the plan has more than 65,535 stencils: points are numbered in 16 bits.
    pub fn push(&mut self, plan: &Plan) -> Result<()> {
        let (points, greatest) = (plan.stencils.len(), usize::from(u16::MAX));
        if points > greatest {
            return Err(Error::Misuse(Misuse::PlanTooLarge { points, greatest }));
        }
        let root = self.tree(&plan.nodes, plan);
        self.headers.push(PlanHeader {
            ring_size: plan.ring_size as u32,
            rows: self.rows.len() as u32,
            root,
            max_level: plan.max_level,
            counts: std::array::from_fn(|level| {
                plan.stencils.count(plan.max_level.min(level as u32)) as u32
            }),
        });
        match plan.stencils.in_pool() {
            Some(rows) => self.rows.append_pooled(rows)?,
            None => self.rows.append(&plan.packed_stencils())?,
        }
        for tangent in plan.nearby.iter().flatten().flatten() {
            self.rows.push_dense(tangent)?;
        }
        let mut next = plan.stencils.len() as u32;
        self.nearby.push(plan.nearby.each_ref().map(|tangents| {
            let number = if tangents.is_some() {
                next
            } else {
                abi::NO_TANGENTS
            };
            next += if tangents.is_some() { 2 } else { 0 };
            number
        }));
        Ok(())
    }

    /// Appends a node that is a tree of its own, a B-spline of sixteen points, number x + 4 y, unless it is there; returns its number.
    pub fn push_bspline(&mut self, points: &[u32; 16]) -> u32 {
        let points = self.list(points);
        self.siblings(&[abi::Node {
            kind: NodeKind::Regular as u32 | abi::ORIGIN_NONE << abi::NODE_ORIGIN_SHIFT,
            points,
            sharpness: 0.0,
        }])
    }

    /// Appends the tree of an edge that a face evaluates with points of its own plan, as far as it is not there; returns its root.
    pub fn push_strip(&mut self, plan: &Plan, strip: &Strip) -> u32 {
        let root = self.stretch(plan, strip, 0, 0);
        self.siblings(&[root])
    }

    /// What the tree of an edge has for the stretch from `at` / 2^`depth` to one more. Levels towards an extraordinary vertex are one node.
    fn stretch(&mut self, plan: &Plan, strip: &Strip, depth: u32, at: u32) -> abi::Node {
        if let Some(stretch) = strip.at(depth, at) {
            return self.pack(&stretch.node(), plan, |children| children);
        }
        if let Some((end, levels)) = strip.approach(depth, at) {
            let points: Vec<u32> = levels.iter().flat_map(Stretch::points).collect();
            let base = base_bits(plan, levels.first().map(|level| level.base));
            return abi::Node {
                kind: abi::NODE_CURVE_TERMINAL | end << 4 | (levels.len() as u32) << 8 | base,
                points: self.list(&points),
                sharpness: 0.0,
            };
        }
        let halves = [2 * at, 2 * at + 1].map(|half| self.stretch(plan, strip, depth + 1, half));
        abi::Node {
            kind: abi::NODE_INTERNAL,
            points: self.siblings(&halves),
            sharpness: 0.0,
        }
    }

    /// Appends what is not there of a tree, whose nodes are in breadth-first order; returns its root. Points are numbers within a plan, so trees of different
    /// plans are often the same, and parts of trees even more so.
    fn tree(&mut self, nodes: &[Node], plan: &Plan) -> u32 {
        let children = nodes.iter().filter_map(|node| match node {
            Node::Internal { children } => Some(*children as usize),
            _ => None,
        });
        // Where siblings begin, in ascending order: first the root, which has none.
        let starts: Vec<usize> = (0..nodes.len().min(1)).chain(children).collect();
        let mut places = vec![0; starts.len()];
        let mut end = nodes.len();
        for (number, &start) in starts.iter().enumerate().rev() {
            let siblings = nodes[start..end].iter();
            let packed: SmallVec<[abi::Node; 4]> = siblings
                .map(|node| {
                    let of = |children: u32| starts.binary_search(&(children as usize));
                    let place = |children| places[of(children).unwrap_or_default()];
                    self.pack(node, plan, place)
                })
                .collect();
            places[number] = self.siblings(&packed);
            end = start;
        }
        places.first().copied().unwrap_or_default()
    }

    /// Appends siblings that are not there yet; returns where they begin.
    fn siblings(&mut self, nodes: &[abi::Node]) -> u32 {
        let words = bytemuck::cast_slice(nodes);
        if let Some(&known) = self.known_nodes.get(words) {
            return known;
        }
        let start = self.nodes.len() as u32;
        self.known_nodes.insert(words.into(), start);
        self.nodes.extend_from_slice(nodes);
        start
    }

    /// A node; `place` tells where children are that begin so in the plan.
    fn pack(&mut self, node: &Node, plan: &Plan, place: impl Fn(u32) -> u32) -> abi::Node {
        let (corner, levels, points, base, sharpness) = match node {
            Node::Internal { children } => (0, 0, place(*children), None, 0.0),
            Node::Regular { points, base, .. } => (0, 0, self.list(points), *base, 0.0),
            Node::Crease {
                points,
                edge,
                sharpness,
                base,
            } => (*edge, 0, self.list(points), *base, *sharpness),
            Node::Terminal {
                corner,
                levels,
                base,
            } => {
                let points = self.list(&children(*corner, levels));
                (*corner, levels.len() as u32, points, *base, 0.0)
            }
            Node::Curve {
                points,
                edge,
                sharpness,
                base,
            } => (*edge, 0, self.list(points), *base, *sharpness),
            Node::Extraordinary { corner } => (*corner, 0, 0, None, 0.0),
        };
        abi::Node {
            kind: node.kind() as u32 | corner << 4 | levels << 8 | base_bits(plan, base),
            points,
            sharpness,
        }
    }

    /// Appends a list of points that is not there yet; returns where it begins.
    fn list(&mut self, points: &[u32]) -> u32 {
        if let Some(&known) = self.known_lists.get(points) {
            return known;
        }
        let start = 2 * self.points.len() as u32;
        self.known_lists.insert(points.into(), start);
        self.points.extend(
            points
                .chunks(2)
                .map(|pair| pair[0] | pair.get(1).copied().unwrap_or(0) << 16),
        );
        start
    }

    /// The plans as the walk reads them.
    pub fn view(&self) -> Plans<'_> {
        Plans {
            nodes: &self.nodes,
            points: &self.points,
            rows: self.rows.view(),
        }
    }

    /// The bytes of the quadtrees: nodes and their points.
    pub fn quadtree_bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.points[..])
    }

    /// The bytes of the stencils.
    pub fn stencil_bytes(&self) -> usize {
        self.rows.bytes()
    }
}

/// Packed plans, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Plans<'a> {
    /// As in [`PackedPlans`].
    pub nodes: &'a [abi::Node],
    /// As in [`PackedPlans`].
    pub points: &'a [u32],
    /// As in [`PackedPlans`].
    pub rows: RowsView<'a>,
}

impl Plans<'_> {
    /// Point `number` of a list; None beyond their end.
    pub fn point(&self, number: u32) -> Option<u32> {
        let pair = self.points.get(number as usize / 2)?;
        Some(pair >> (16 * (number % 2)) & 0xffff)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::mesh::builtin;
    use crate::mesh::topology::Topology;
    use crate::plan::{PlanOptions, Ring, walk};

    #[test]
    fn trees_of_edges_lead_to_the_points_of_their_stretches() {
        let (mut packed, mut stretches) = (PackedPlans::default(), 0);
        for name in ["hull", "creased-torus", "cubes-2x2x2", "pole-7"] {
            let topology = Topology::new(&builtin(name).expect("it is built in"));
            let faces = 0..topology.face_count() as u32;
            for ring in faces.filter_map(|face| Ring::of_quad(&topology, face)) {
                let plan = Plan::build(&ring.configuration, PlanOptions::default());
                let plan = plan.expect("a sound configuration");
                let turns = [(false, false), (true, false), (false, true), (true, true)];
                let strips = plan.strips.iter().flatten().flat_map(|strip| {
                    turns.map(|(mirrored, reversed)| strip.turned(mirrored, reversed))
                });
                for strip in strips {
                    let root = packed.push_strip(&plan, &strip);
                    for stretch in strip.stretches() {
                        let size = 0.5f32.powi(stretch.depth as i32);
                        let inside = [0.25, 0.5, 0.7].map(|t| (stretch.at as f32 + t) * size);
                        for t in inside {
                            let leaf = walk(packed.view(), root, Vec2::new(t, 0.0));
                            let leaf = leaf.expect("there is the tree");
                            if stretch.points.is_none() {
                                let end = if stretch.at > 0 { 1.0 } else { 0.0 };
                                let leaf = walk(packed.view(), root, Vec2::new(end, 0.0));
                                let kind = leaf.map(|leaf| leaf.kind);
                                assert_eq!(kind, Some(abi::NODE_EXTRAORDINARY));
                                continue;
                            }
                            let own = (0..16).map(|i| packed.view().point(leaf.points + i));
                            assert!(own.eq(stretch.points().map(Some)), "{name}: {t}");
                            assert_eq!((leaf.base, leaf.scale * size), (stretch.base + 1, 1.0));
                            let local = t / size - stretch.at as f32;
                            assert!((leaf.uv.x - local).abs() < 1e-5 && leaf.uv.y == 0.0);
                            stretches += 1;
                        }
                    }
                }
            }
        }
        let is_terminal = |node: &&abi::Node| node.kind & 15 == abi::NODE_CURVE_TERMINAL;
        let terminal = packed.nodes.iter().filter(is_terminal).count();
        assert!(stretches > 1000 && terminal > 10, "{stretches}, {terminal}");
    }
}
