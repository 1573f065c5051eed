//! What batches draw of a patch, which may be some of its pieces.

use crate::frame::Batch;
use crate::frame::sub_patches::{join, mould};
use crate::method::Prepared;
use crate::tessellation::{Levels, Piece};

impl<'a> Batch<'a> {
    /// The pieces of a patch that it draws; none where patches are drawn whole.
    fn pieces(&self, patch: u32) -> impl ExactSizeIterator<Item = Piece> + use<'a> {
        let all = self.sub_patches();
        let first = all.partition_point(|own| own.patch_number < patch);
        let end = all.partition_point(|own| own.patch_number <= patch);
        all[first..end].iter().map(|own| Piece::of_plan(own.piece))
    }

    /// The levels of a patch that it draws, and whether as a whole.
    fn levels(&self, prepared: &Prepared, patch: u32) -> Option<(Levels, bool)> {
        let levels = self.list().levels(prepared, self.pass(), patch)?;
        let pieces = match self.list().has_sub_patches() {
            true => 1 << (2 * levels.piece_depth()),
            false => 0,
        };
        let whole = self.pieces(patch).len() == pieces;
        self.patches().contains(&patch).then_some((levels, whole))
    }

    /// As [`DrawList::triangles`](super::DrawList::triangles), of what it draws of a patch.
    pub fn triangles(
        &self,
        prepared: &Prepared,
        patch: u32,
        uv: &[[f32; 2]],
    ) -> Option<Vec<[u32; 3]>> {
        let (levels, whole) = self.levels(prepared, patch)?;
        if whole {
            return self.list().triangles(prepared, self.pass(), patch, uv);
        }
        let record = &prepared.passes[self.pass()].patches[patch as usize];
        join(record, &levels, self.pieces(patch), uv)
    }

    /// How many different vertices what it draws of a patch has; none of one that it does not draw.
    pub fn different_vertices(&self, prepared: &Prepared, patch: u32) -> u32 {
        let record = |levels: &Levels| {
            let record = &prepared.passes[self.pass()].patches[patch as usize];
            mould(record, levels, self.pieces(patch)).uv.len() as u32
        };
        match self.levels(prepared, patch) {
            None => 0,
            Some((_, true)) => self.list().vertices(prepared, self.pass(), patch),
            Some((levels, false)) => record(&levels),
        }
    }

    /// How often what it draws of a patch is evaluated at least; never of one that it does not draw.
    pub fn evaluations(&self, prepared: &Prepared, patch: u32) -> u32 {
        let Some((levels, _)) = self.levels(prepared, patch) else {
            return 0;
        };
        let (backend, spacing) = (self.list().options().backend, self.list().cut().spacing);
        match self.list().has_sub_patches() {
            true => {
                let pieces = self.pieces(patch).len() as u32;
                pieces * backend.evaluations(&levels.of_pieces(), spacing)
            }
            false => backend.evaluations(&levels, spacing),
        }
    }
}
