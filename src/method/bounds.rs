//! What bounds patches, by which those are told that are not seen.

use std::borrow::Cow;

use crate::method::pass::Bounds;
use crate::method::{Outline, Pass};

impl Pass {
    /// The control vertices in whose convex hull the surface of a patch is; none where that is not known, or there is no such patch.
    pub fn hull(&self, patch: usize) -> Cow<'_, [u32]> {
        if self.is_vacant(patch) {
            return Cow::default();
        }
        if let Some(bounds) = self.bounds {
            return bounds(self, patch).vertices.into();
        }
        let Some(count) = self.hull else {
            return Cow::default();
        };
        let first = self.patches[patch].controls as usize;
        self.controls[first..first + count(self, patch) as usize].into()
    }

    /// The control vertices that have most of the say in where a patch is: those of the edges of the mesh that its own belong to, or of the faces that these lie in; of a
    /// macro face all of its faces'. Some may be there twice.
    pub fn own_vertices(&self, outline: &Outline, patch: usize) -> Vec<u32> {
        if let Some(Bounds {
            mut vertices, own, ..
        }) = self.macro_bounds(patch)
        {
            vertices.truncate(own);
            return vertices;
        }
        let sides = self.sides.get(patch).into_iter().flatten();
        sides
            .flat_map(|&side| outline.side(side))
            .copied()
            .collect()
    }

    /// The control points of a patch that is a bicubic B-spline, row by row along u; None of others.
    pub fn spline(&self, patch: usize) -> Option<[u32; 16]> {
        let points = self.hull(patch);
        points[..].try_into().ok().filter(|_| self.is_spline)
    }

    /// The same of all cells of a patch that is made of such: of a macro face there are several, of any other it is itself. None where a part of it is something else.
    pub fn splines(&self, patch: usize) -> Vec<[u32; 16]> {
        match self.macro_bounds(patch) {
            Some(bounds) => bounds.splines,
            None => self.spline(patch).into_iter().collect(),
        }
    }

    /// What bounds a macro face; None of other patches.
    pub(super) fn macro_bounds(&self, patch: usize) -> Option<Bounds> {
        let bounds = self.bounds.filter(|_| !self.is_vacant(patch))?;
        Some(bounds(self, patch))
    }
}
