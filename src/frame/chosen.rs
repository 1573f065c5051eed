//! A draw list of which only some patches are drawn.

use glam::Vec3;

use crate::error::{Error, Misuse, Result};
use crate::frame::culling::bezier;
use crate::frame::draw_list::new_number;
use crate::frame::tagged::not_drawn;
use crate::frame::{Decides, DrawList};
use crate::method::{Pass, Prepared};

impl DrawList {
    /// The same of some patches alone, chosen by pass and number: of the others nothing is drawn, and no point is computed in the ring. For whoever knows which
    /// patches are seen, or in which part of a picture something has changed. The batches are the same, with the same numbers: those of which no patch is chosen
    /// need not be drawn. What is drawn of a patch has the same bits.
    ///
    /// As depth tags do, it makes decisions of the host that must be on the device before it is drawn ([`has_decisions`](Self::has_decisions)).
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] for another than the list was made for; [`Misuse::DecidedByDevice`] where that chooses.
    pub fn only(
        mut self,
        prepared: &Prepared,
        chosen: impl Fn(usize, u32) -> bool,
    ) -> Result<DrawList> {
        if !self.is_of(prepared) {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        if self.options().decides == Decides::Device {
            let what = "chosen patches";
            return Err(Error::Misuse(Misuse::DecidedByDevice { what }));
        }
        let of_pass = |(number, pass): (usize, &Pass)| {
            let levels = |patch: u32| match chosen(number, patch) {
                true => self.levels(prepared, number, patch),
                false => None,
            };
            let patches = 0..pass.patches.len() as u32;
            patches
                .map(|p| levels(p).unwrap_or(not_drawn(pass)))
                .collect()
        };
        let passes = prepared.passes.iter().enumerate();
        self.tagged = Some(passes.map(of_pass).collect());
        let sub_patches = self.sub_patches.iter_mut().flatten();
        for (number, own) in sub_patches.enumerate() {
            for piece in own.iter_mut().filter(|p| !chosen(number, p.patch_number)) {
                (piece.edges, piece.inside) = ([0.0; 4], 0.0);
            }
        }
        self.number = new_number();
        self.decide(prepared);
        Ok(self)
    }
}

/// Points in whose convex hull the surface of a patch is, with control vertices at `vertices`: the Bezier points of a spline, of others the vertices of their
/// [hull](Pass::hull). None where that is not known, or nothing is drawn of the patch.
///
/// # Panics
/// For fewer vertices than the pass is of.
pub fn hull_points(pass: &Pass, patch: usize, vertices: &[Vec3]) -> Vec<Vec3> {
    let place = |&vertex: &u32| vertices[vertex as usize];
    match pass.spline(patch) {
        Some(spline) => bezier(&spline.each_ref().map(place)).into(),
        None => pass.hull(patch).iter().map(place).collect(),
    }
}
