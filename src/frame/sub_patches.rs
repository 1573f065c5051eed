//! What a list draws whose patches may have more segments than a tessellator makes: each patch, or each of its pieces. Numbers of these stand in the place of
//! patches' then. They come in the order of patches, one at least of each, so that none is below its patch's.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::abi;
use crate::frame::Cut;
use crate::frame::backend::Mould;
use crate::method::{Pass, Prepared};
use crate::tessellation::{
    Domain, Levels, Piece, Spacing, TESSELLATED, coordinates, piece_coordinates, triangulate,
};

/// Whether a list of this level has sub-patches.
pub(crate) fn has_sub_patches(level: f32) -> bool {
    level > TESSELLATED
}

/// The sub-patches of a pass, without slots, by the levels of its patches; of a vacant slot one of which nothing is drawn.
pub(super) fn sub_patches(
    pass: &Pass,
    levels: impl Fn(usize) -> Option<Levels>,
) -> Vec<abi::SubPatch> {
    let of_patch = |patch: usize| {
        let levels = levels(patch);
        let depth = levels.map_or(0, |levels| levels.piece_depth());
        let (edges, inside) = levels.map_or_else(Default::default, |own| (own.edges, own.inside));
        Piece::all(depth).map(move |piece| abi::SubPatch {
            patch_number: patch as u32,
            piece: piece.plan(),
            slot: 0,
            edges,
            inside,
        })
    };
    (0..pass.extent()).flat_map(of_patch).collect()
}

/// The sub-patches of each pass.
pub(super) fn all_sub_patches(
    prepared: &Prepared,
    cut: Cut,
    tagged: Option<&[Vec<Levels>]>,
) -> Vec<Vec<abi::SubPatch>> {
    let of_pass = |(number, pass): (usize, &Pass)| {
        let tagged = tagged.map(|all| all[number].as_slice());
        sub_patches(pass, |patch| levels_of(pass, cut, tagged, patch))
    };
    prepared.passes.iter().enumerate().map(of_pass).collect()
}

/// The most sub-patches that a pass has at cuts up to a level, however edits change it.
#[cfg(feature = "vulkan")]
pub(crate) fn most_sub_patches(pass: &Pass, level: f32) -> u64 {
    let level = level.min((1u32 << pass.max_level.min(abi::HIGHEST_LEVEL)) as f32);
    let levels = Levels {
        domain: pass.domain,
        edges: [level; 4],
        inside: level,
        cells: [1; 2],
    };
    (pass.patches.len() as u64) << (2 * levels.piece_depth())
}

/// The levels of the whole patch.
fn whole_levels(record: &abi::SubPatch) -> Option<Levels> {
    (record.inside > 0.0).then_some(Levels {
        domain: Domain::Quads,
        edges: record.edges,
        inside: record.inside,
        cells: [1; 2],
    })
}

/// What is drawn of a pass: its patches, or sub-patches.
#[derive(Clone, Copy)]
pub(crate) struct Drawn<'a> {
    pub pass: &'a Pass,
    pub cut: Cut,
    /// By patch, where depth tags give them levels.
    pub tagged: Option<&'a [Levels]>,
    pub sub_patches: Option<&'a [abi::SubPatch]>,
}

impl<'a> Drawn<'a> {
    /// How many there are; of patches those up to the last that is not vacant.
    pub fn count(&self) -> usize {
        self.sub_patches
            .map_or_else(|| self.pass.extent(), <[_]>::len)
    }

    /// The numbers between which all is that is drawn. Of methods that refine as deep as a frame needs, patches stand in the order of depths, and few may be drawn.
    pub fn range(&self) -> Range<usize> {
        let all = 0..self.count();
        if !self.pass.is_dynamic() {
            return all;
        }
        let is_drawn = |&number: &usize| self.whole(number).is_some();
        let last = all.clone().rev().find(is_drawn);
        let first = all.clone().find(is_drawn);
        first
            .zip(last)
            .map_or(0..0, |(first, last)| first..last + 1)
    }

    /// The patch of a number.
    fn patch(&self, number: usize) -> usize {
        let patch = |all: &[abi::SubPatch]| all[number].patch_number as usize;
        self.sub_patches.map_or(number, patch)
    }

    /// The levels of the whole patch.
    fn whole(&self, number: usize) -> Option<Levels> {
        match self.sub_patches {
            Some(all) => whole_levels(&all[number]),
            None => levels_of(self.pass, self.cut, self.tagged, number),
        }
    }

    /// What the tessellator is given.
    pub fn levels(&self, number: usize) -> Option<Levels> {
        self.whole(number).map(|levels| levels.of_pieces())
    }

    /// The points that it needs in the ring: all of its patch's.
    pub fn points(&self, number: usize) -> u32 {
        let needed = |levels| Cut::points_of(self.pass, self.patch(number), &levels);
        self.whole(number).map_or(0, needed)
    }
}

/// The levels of a patch, by depth tags where there are any; None where there is no such patch, its slot is vacant, or it is not chosen.
pub(super) fn levels_of(
    pass: &Pass,
    cut: Cut,
    tagged: Option<&[Levels]>,
    patch: usize,
) -> Option<Levels> {
    match tagged {
        Some(_) if pass.is_vacant(patch) => None,
        Some(levels) => levels.get(patch).filter(|own| own.inside > 0.0).copied(),
        None => cut.levels(pass, patch),
    }
}

/// Vertices and triangles of some pieces of a patch, by v and u, without the triangles that have no area.
pub(super) fn mould(
    patch: &abi::Patch,
    levels: &Levels,
    pieces: impl Iterator<Item = Piece>,
) -> Mould {
    let own = coordinates(&levels.of_pieces(), Spacing::Equal);
    let joined = triangulate(levels.domain, &own);
    let mut places: Vec<[f32; 2]> = Vec::new();
    let mut triangles = Vec::new();
    let mut numbers: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut of_piece = Vec::with_capacity(own.len());
    for piece in pieces {
        of_piece.clear();
        of_piece.extend(own.iter().map(|&uv| {
            let at = piece_coordinates(patch, levels, piece, uv);
            *numbers.entry(at.map(f32::to_bits)).or_insert_with(|| {
                places.push(at);
                places.len() as u32 - 1
            })
        }));
        let own = joined
            .iter()
            .map(|triangle| triangle.map(|i| of_piece[i as usize]));
        triangles.extend(own.filter(|[a, b, c]| a != b && b != c && c != a));
    }
    let mut order: Vec<u32> = (0..places.len() as u32).collect();
    // No coordinate is negative: bits are in the order of numbers.
    order.sort_unstable_by_key(|&i| {
        let [u, v] = places[i as usize].map(f32::to_bits);
        [v, u]
    });
    let mut ranks = vec![0; order.len()];
    for (rank, &i) in (0u32..).zip(&order) {
        ranks[i as usize] = rank;
    }
    for corner in triangles.iter_mut().flatten() {
        *corner = ranks[*corner as usize];
    }
    Mould {
        uv: order.iter().map(|&i| places[i as usize]).collect(),
        triangles,
    }
}

/// The triangles of some pieces of a patch, by the numbers of vertices that come in any order; None where these are not all.
pub(super) fn join(
    patch: &abi::Patch,
    levels: &Levels,
    pieces: impl Iterator<Item = Piece>,
    uv: &[[f32; 2]],
) -> Option<Vec<[u32; 3]>> {
    let Mould { uv: own, triangles } = mould(patch, levels, pieces);
    let numbers: FxHashMap<[u32; 2], u32> =
        uv.iter().map(|at| at.map(f32::to_bits)).zip(0..).collect();
    let number = |at: &[f32; 2]| numbers.get(&at.map(f32::to_bits)).copied();
    let numbers: Vec<u32> = own.iter().map(number).collect::<Option<_>>()?;
    let numbered = |triangle: [u32; 3]| triangle.map(|i| numbers[i as usize]);
    Some(triangles.into_iter().map(numbered).collect())
}
