//! Levels that each patch has for itself: by depth tags, or by where it lies in what a method refines as deep as a frame needs.

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::sub_patches::has_sub_patches;
use crate::frame::{Backend, Cut};
use crate::method::{DepthTags, IsolationOptions, Pass, Prepared};
use crate::tessellation::{Levels, levels_of_edges_and_inside};

/// What each patch has, and how deep a frame refines.
pub(super) struct Tagged {
    /// By pass and patch; level 0 where nothing is drawn.
    pub levels: Vec<Vec<Levels>>,
    /// By irregularity.
    pub depths: Vec<u32>,
}

/// Of a patch of which nothing is drawn.
pub(super) fn not_drawn(pass: &Pass) -> Levels {
    Levels {
        domain: pass.domain,
        edges: [0.0; 4],
        inside: 0.0,
        cells: [1; 2],
    }
}

impl Tagged {
    /// The levels that depth tags give to all patches, at a cut as the backend makes it.
    ///
    /// # Errors
    /// [`Misuse`] for tags that are no depths, and for other than one a vertex.
    pub fn by_tags(
        prepared: &Prepared,
        backend: Backend,
        cut: Cut,
        tags: &DepthTags,
    ) -> Result<Tagged> {
        prepared.check_count("depth tags", tags.depths.len())?;
        let mut tagged = tags.depths.iter().copied().enumerate();
        let deepest = DepthTags::DEEPEST;
        if let Some((vertex, depth)) = tagged.find(|(_, depth)| !(0.0..=deepest).contains(depth)) {
            return Err(Error::Misuse(Misuse::Depth { vertex, depth }));
        }
        let mut insides = tags.insides.iter().copied().enumerate();
        if let Some((ptex, depth)) = insides.find(|(_, depth)| !(0.0..=deepest).contains(depth)) {
            return Err(Error::Misuse(Misuse::InsideDepth { ptex, depth }));
        }
        let depths: Vec<f32> = prepared.outline.depths(&tags.depths)?;
        let level = |depth: f32| {
            let level = backend.level_of(depth).min(cut.level);
            // Where vertices are counted levels are whole.
            if has_sub_patches(cut.level) {
                level.ceil()
            } else {
                level
            }
        };
        let inside = |face: &abi::Patch| match tags.insides.get(face.ptex as usize) {
            Some(&depth) if backend.takes_any_level() => level(depth),
            _ => 0.0,
        };
        let mut deep = prepared.depths_at(|side| level(depths[side as usize]));
        if has_sub_patches(cut.level) {
            // Shaders that cut patches into pieces count an edge's halves by the record, which is that of the greatest depths.
            deep.fill(IsolationOptions::GREATEST_LEVEL);
        }
        let of_pass = |pass: &Pass| {
            let (domain, spacing, max_level) = (pass.domain, cut.spacing, pass.max_level);
            let levels = |(patch, sides): (usize, &[u32; 4])| {
                let own = pass.at_depths(patch, |of| deep[of as usize]);
                own.map_or(not_drawn(pass), |own| {
                    let edges = sides.map(|side| level(depths[side as usize]));
                    let faces = pass.patches[pass.faces_of(patch)].iter();
                    let inside = faces.map(inside).fold(0.0, f32::max);
                    levels_of_edges_and_inside(domain, &own, edges, inside, spacing, max_level)
                })
            };
            pass.sides.iter().enumerate().map(levels).collect()
        };
        Ok(Tagged {
            levels: prepared.passes.iter().map(of_pass).collect(),
            depths: deep,
        })
    }

    /// The same at a cut alone; None where that says all.
    pub fn by_cut(prepared: &Prepared, cut: Cut) -> Option<Tagged> {
        let of_pass = |pass: &Pass| {
            let levels = |patch| cut.levels(pass, patch).unwrap_or(not_drawn(pass));
            (0..pass.patches.len()).map(levels).collect()
        };
        prepared.is_dynamic().then(|| Tagged {
            levels: prepared.passes.iter().map(of_pass).collect(),
            depths: prepared.depths_at(|_| cut.level),
        })
    }
}
