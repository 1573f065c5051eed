//! Tess levels of a patch, a function of its edges alone on each edge. Twin of `glsl/lib/levels.glsl`.

use crate::abi;
use crate::tessellation::{Piece, TESSELLATED};

/// Vulkan's spacing modes that keep vertices away from corners. Fractional-odd does not (see Brainerd et al. 2016, section 9.7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Spacing {
    /// Whole levels, equal steps.
    #[default]
    Equal,
    /// Any level; two short steps grow as the level does.
    FractionalEven,
}

impl Spacing {
    /// The number of segments of an edge of this level, as tessellators make them (Vulkan spec, "Tessellator Spacing").
    pub fn segments(self, level: f32) -> u32 {
        let level = self.clamp(level, abi::HIGHEST_LEVEL);
        match self {
            Spacing::Equal => level.ceil() as u32,
            Spacing::FractionalEven => 2 * (level / 2.0).ceil() as u32,
        }
    }

    /// The level within what can be drawn, and plans of `max_level` levels serve: from [`least`](Self::least) to 2^`max_level` and at
    /// most [`greatest`](Self::greatest). What is no number becomes the least.
    pub fn clamp(self, level: f32, max_level: u32) -> f32 {
        let greatest = ((1u32 << max_level.min(abi::HIGHEST_LEVEL)) as f32).min(self.greatest());
        // Not f32::clamp, which lets NaN pass.
        level.max(self.least()).min(greatest.max(self.least()))
    }

    /// The greatest level: 1024 with equal spacing, for which patches are cut into pieces before they are drawn; else 64, all that every tessellator does.
    pub fn greatest(self) -> f32 {
        match self {
            Spacing::Equal => (1u32 << abi::HIGHEST_LEVEL) as f32,
            Spacing::FractionalEven => TESSELLATED,
        }
    }

    /// The least level: the tessellator raises lower ones to it.
    pub fn least(self) -> f32 {
        match self {
            Spacing::Equal => 1.0,
            Spacing::FractionalEven => 2.0,
        }
    }

    /// The name of the shader module's variant.
    pub fn name(self) -> &'static str {
        match self {
            Spacing::Equal => "equal",
            Spacing::FractionalEven => "fractional-even",
        }
    }
}

/// The shape of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Domain {
    /// The unit square.
    Quads,
    /// The triangle u, v >= 0, u + v <= 1. Corner 0 is (0, 0), 1 is (1, 0), 2 is (0, 1).
    Triangles,
}

impl Domain {
    /// How many corners, and edges.
    pub fn corners(self) -> usize {
        match self {
            Domain::Quads => 4,
            Domain::Triangles => 3,
        }
    }

    /// The point of it for (u, v): itself, or one on the edge for what lies outside. Numbers that a tessellator rounded a little beyond the edge
    /// stay.
    pub(crate) fn nearest(self, [u, v]: [f32; 2]) -> [f32; 2] {
        const ROUNDED: f32 = 1e-6;
        let [u, v] = [u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)];
        match self {
            Domain::Triangles if u + v > 1.0 + ROUNDED => [u, 1.0 - u],
            _ => [u, v],
        }
    }

    /// Whether (u, v) is a point of it.
    pub fn contains(self, [u, v]: [f32; 2]) -> bool {
        let farthest = match self {
            Domain::Quads => u.max(v),
            Domain::Triangles => u + v,
        };
        u.min(v) >= 0.0 && farthest <= 1.0
    }
}

/// Tess levels of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Its shape.
    pub domain: Domain,
    /// Cells along u and v, each of which has these levels: one of what is no macro face.
    pub cells: [u32; 2],
    /// Of the edges from corner i to corner i + 1; triangles repeat that of edge 2.
    pub edges: [f32; 4],
    /// Of the inside, in all directions.
    pub inside: f32,
}

/// The levels of a patch when quads have `level`, from the spacing's least to 2^`max_level` and at most its greatest; of triangles 64.
pub fn levels(
    domain: Domain,
    patch: &abi::Patch,
    level: f32,
    spacing: Spacing,
    max_level: u32,
) -> Levels {
    levels_of_edges(domain, patch, [level; 4], spacing, max_level)
}

/// The levels of a patch whose edges from corner i to corner i + 1 belong to edges of quads of the levels `edges`, from the spacing's least to
/// 2^`max_level` and at most its greatest, of triangles 64; of a triangle the last counts twice.
///
/// Where a quad meets an n-gon, its edge gets twice the segments of the n-gon's half edge: 2k and k with equal spacing, 4k and 2k with
/// fractional-even (Brainerd et al. 2016, section 7.2). A piece has what its face's edges have after as many halvings, and before two smaller pieces
/// likewise twice the segments of each.
pub fn levels_of_edges(
    domain: Domain,
    patch: &abi::Patch,
    edges: [f32; 4],
    spacing: Spacing,
    max_level: u32,
) -> Levels {
    levels_of_edges_and_inside(domain, patch, edges, 0.0, spacing, max_level)
}

/// The same of a patch whose inside has a level of its face at least: neighbours need know nothing of it.
pub(crate) fn levels_of_edges_and_inside(
    domain: Domain,
    patch: &abi::Patch,
    edges: [f32; 4],
    inside: f32,
    spacing: Spacing,
    max_level: u32,
) -> Levels {
    // Triangles are never cut into pieces.
    let max_level = match domain {
        Domain::Triangles => max_level.min(abi::TESSELLATED_LEVEL),
        Domain::Quads => max_level,
    };
    let edges = edges.map(|level| spacing.clamp(level, max_level));
    let inside = spacing.clamp(inside, max_level);
    let half = |level: f32| match spacing {
        Spacing::Equal => (level * 0.5).ceil(),
        Spacing::FractionalEven => 2.0 * (level * 0.25).ceil(),
    };
    // Once for a part of an n-gon, and as often as the face of a piece is halved.
    let halvings = halvings(patch);
    let halved = |level: f32| (0..halvings).fold(level, |level, _| half(level));
    let edges = edges.map(halved);
    let inside = edges.into_iter().fold(halved(inside), f32::max);
    let even = |edge: usize| patch.flags & abi::PATCH_EVEN_EDGE << edge != 0;
    let level = |edge: usize| match edges[edge] {
        level if even(edge) => 2.0 * half(level),
        level => level,
    };
    Levels {
        domain,
        cells: cells(patch),
        edges: [0, 1, 2, 3].map(level),
        inside,
    }
    .in_whole_pieces()
}

/// How often the edges of the control mesh are halved to make those of a patch. Twin of `patch_halvings` in `glsl/lib/half_level.glsl`.
fn halvings(patch: &abi::Patch) -> u32 {
    let is_piece = patch.flags >> abi::PATCH_CHILD_SHIFT & 15 == abi::CHILD_PIECE;
    let depth = if is_piece {
        Piece::of_plan(patch.plan).depth
    } else {
        0
    };
    depth + u32::from(patch.flags & abi::PATCH_HALF != 0)
}

/// The columns and rows of a macro face; one each of other patches. Twin of `cells_of` in `glsl/lib/cells.glsl`.
pub(crate) fn cells(patch: &abi::Patch) -> [u32; 2] {
    match patch.flags & abi::PATCH_MACRO {
        0 => [1; 2],
        _ => [abi::MACRO_COLUMNS_SHIFT, abi::MACRO_ROWS_SHIFT]
            .map(|shift| (patch.flags >> shift & 31) + 1),
    }
}

impl Levels {
    /// The greatest of all.
    pub fn greatest(&self) -> f32 {
        self.edges.iter().copied().fold(self.inside, f32::max)
    }

    /// The vertices that the tessellator makes of a patch (Vulkan spec, "Quad Tessellation", "Triangle Tessellation"); of pieces together.
    pub fn vertices(&self, spacing: Spacing) -> u32 {
        self.of_pieces().at_once(spacing) << (2 * self.piece_depth())
    }

    /// How many of them are different: pieces share those between them, and several may go to one of an edge's.
    pub fn different_vertices(&self, spacing: Spacing) -> u32 {
        match self.piece_depth() {
            0 => self.at_once(spacing),
            _ => {
                let inside = spacing.segments(self.inside) - 1;
                self.outer(spacing) + inside * inside
            }
        }
    }

    fn at_once(&self, spacing: Spacing) -> u32 {
        let [inside, across] = self.inside_segments(spacing);
        match self.domain {
            _ if inside * across == 1 => self.domain.corners() as u32,
            Domain::Quads => self.outer(spacing) + (inside - 1) * (across - 1),
            Domain::Triangles => {
                self.outer(spacing) + inner_rings(inside).map(ring_vertices).sum::<u32>()
            }
        }
    }

    /// The triangles that the tessellator makes of a patch; of pieces together, those without area included.
    pub fn triangles(&self, spacing: Spacing) -> u32 {
        match self.piece_depth() {
            0 => self.triangles_at_once(spacing),
            depth => self.of_pieces().triangles_at_once(spacing) << (2 * depth),
        }
    }

    fn triangles_at_once(&self, spacing: Spacing) -> u32 {
        let [inside, across] = self.inside_segments(spacing);
        match self.domain {
            Domain::Quads if inside * across == 1 => 2,
            // By Euler's formula.
            Domain::Quads => self.outer(spacing) + 2 * (inside - 1) * (across - 1) - 2,
            Domain::Triangles if inside == 1 => 1,
            // Between two rings there are as many triangles as both have segments; the innermost ring may itself be a triangle.
            Domain::Triangles => {
                let segments: u32 = inner_rings(inside).map(|ring| 3 * ring).sum();
                let innermost = if inside % 2 == 1 { 3 - 1 } else { 0 };
                self.outer(spacing) + 2 * segments - innermost
            }
        }
    }

    /// The segments of all edges.
    fn outer(&self, spacing: Spacing) -> u32 {
        let edges = 0..self.domain.corners();
        edges.map(|edge| self.edge_segments(edge, spacing)).sum()
    }

    /// The segments of an edge, over all cells.
    pub(super) fn edge_segments(&self, edge: usize, spacing: Spacing) -> u32 {
        self.cells[edge % 2] * spacing.segments(self.edges[edge])
    }

    /// The greatest number of segments of an edge or of the inside, over all cells.
    pub(crate) fn greatest_segments(&self, spacing: Spacing) -> u32 {
        self.cells[0].max(self.cells[1]) * spacing.segments(self.greatest())
    }

    /// Of the inside along u and v. A level of 1 counts as just over 1 unless all levels are 1.
    pub(super) fn inside_segments(&self, spacing: Spacing) -> [u32; 2] {
        let inside = self
            .cells
            .map(|cells| cells * spacing.segments(self.inside));
        let mut edges = 0..self.domain.corners();
        let is_cut =
            inside[0] * inside[1] > 1 || edges.any(|edge| self.edge_segments(edge, spacing) > 1);
        match is_cut {
            true => inside.map(|segments| segments.max(2)),
            false => inside,
        }
    }
}

/// The segments on a side of each triangle within a triangle whose inside level makes `segments`, from the outside; the last may be 0, a
/// point.
pub(crate) fn inner_rings(segments: u32) -> impl Iterator<Item = u32> {
    (1..=segments / 2).map(move |ring| segments - 2 * ring)
}

/// The vertices of a ring with so many segments a side.
pub(crate) fn ring_vertices(segments: u32) -> u32 {
    (3 * segments).max(1)
}

/// The plan level that tess levels need: ceil(log2 of the greatest), at most `max_level`.
pub fn required_level(levels: &Levels, max_level: u32) -> u32 {
    // A macro face of one row has two segments across at least, see `Levels::inside_segments`.
    let is_row = levels.cells != [1; 2] && levels.cells.contains(&1);
    (u32::from(is_row)..max_level.min(64))
        .find(|&level| (1u64 << level) as f32 >= levels.greatest())
        .unwrap_or(max_level)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACINGS: [Spacing; 2] = [Spacing::Equal, Spacing::FractionalEven];

    #[test]
    fn whatever_is_asked_for_levels_stay_in_range() {
        let odd = [f32::NAN, f32::INFINITY, -f32::INFINITY, -1.0, 0.0, 1e30];
        for spacing in SPACINGS {
            for max_level in [0, 6, 31, 32, 40, u32::MAX] {
                for level in odd {
                    let clamped = spacing.clamp(level, max_level);
                    assert!((spacing.least()..=spacing.greatest()).contains(&clamped));
                    for domain in [Domain::Quads, Domain::Triangles] {
                        let made = levels(domain, &patch(0), level, spacing, max_level);
                        assert!(made.vertices(spacing) > 0 && made.triangles(spacing) > 0);
                        let raw = Levels {
                            domain,
                            cells: [1; 2],
                            edges: [level; 4],
                            inside: level,
                        };
                        assert!(raw.vertices(spacing) > 0);
                        assert!(required_level(&raw, max_level) <= max_level);
                        assert!(!crate::tessellation::pattern(&raw).is_empty());
                    }
                }
            }
        }
    }

    fn patch(flags: u32) -> abi::Patch {
        abi::Patch {
            flags,
            ..Default::default()
        }
    }

    /// Whole levels 1..=64 and some between.
    fn all_levels() -> impl Iterator<Item = f32> {
        (4..=256).map(|quarters| quarters as f32 / 4.0)
    }

    #[test]
    fn edges_have_the_same_segments_on_both_sides() {
        for (level, spacing, max_level) in all_levels()
            .flat_map(|l| SPACINGS.map(|s| (l, s)))
            .flat_map(|(l, s)| [1, 2, 4, 6].map(|m| (l, s, m)))
        {
            let quad = levels(
                Domain::Quads,
                &patch(abi::PATCH_EVEN_EDGE << 2),
                level,
                spacing,
                max_level,
            );
            let half = levels(
                Domain::Quads,
                &patch(abi::PATCH_HALF),
                level,
                spacing,
                max_level,
            );
            let place = format!("{level}, {spacing:?}, {max_level}");
            // Quads agree by the same number, n-gons' inner edges too.
            assert_eq!(quad.edges[0], quad.inside, "{place}");
            assert_eq!(half.edges, [half.inside; 4], "{place}");
            // An edge before an n-gon has its segments from two parts.
            assert_eq!(
                spacing.segments(quad.edges[2]),
                2 * spacing.segments(half.edges[0]),
                "{place}"
            );
        }
    }

    /// Both ways to make the segments put their vertices at the same places: equal steps, since each level is a whole even number.
    #[test]
    fn edges_beside_n_gons_have_equal_steps() {
        for (level, spacing) in all_levels().flat_map(|l| SPACINGS.map(|s| (l, s))) {
            let quad = levels(
                Domain::Quads,
                &patch(abi::PATCH_EVEN_EDGE),
                level,
                spacing,
                6,
            );
            let half = levels(Domain::Quads, &patch(abi::PATCH_HALF), level, spacing, 6);
            for level in [quad.edges[0], half.edges[0]] {
                assert_eq!(
                    level,
                    spacing.segments(level) as f32,
                    "{level}, {spacing:?}"
                );
            }
        }
    }

    /// By Euler's formula: vertices - edges + triangles = 1, and 2 edges = 3 triangles + rim.
    #[test]
    fn vertices_and_triangles_belong_together() {
        for (level, spacing) in all_levels().flat_map(|l| SPACINGS.map(|s| (l, s))) {
            for domain in [Domain::Quads, Domain::Triangles] {
                for edge in [1.0, level, 5.0] {
                    let levels = Levels {
                        domain,
                        cells: [1; 2],
                        edges: [edge, level, level, level],
                        inside: level,
                    };
                    let (vertices, triangles) =
                        (levels.vertices(spacing), levels.triangles(spacing));
                    assert_eq!(
                        2 * vertices,
                        triangles + levels.outer(spacing) + 2,
                        "{levels:?} {spacing:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn levels_stay_within_what_the_plan_is_made_for() {
        for (level, max_level) in all_levels().flat_map(|l| (1..=6).map(move |m| (l, m))) {
            let quad = levels(
                Domain::Quads,
                &patch(abi::PATCH_EVEN_EDGE),
                level,
                Spacing::Equal,
                max_level,
            );
            assert!(quad.greatest() <= (1u32 << max_level) as f32);
            let needed = required_level(&quad, max_level);
            assert!(quad.greatest() <= (1u32 << needed) as f32);
            assert!(needed == 0 || quad.greatest() > (1u32 << (needed - 1)) as f32);
        }
    }
}
