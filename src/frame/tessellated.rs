//! A draw list carried out on the CPU: the vertices that the tessellator would make, evaluated by the method's twin in parallel, and their triangles.

use std::sync::Arc;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::error::{Error, Misuse, Result};
use crate::frame::DrawList;
use crate::frame::backend::Mould;
use crate::method::{Controls, Prepared, SurfacePoint};
use crate::tessellation::Levels;

/// A vertex of a tessellated surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TessellatedPoint {
    /// The pass, by its number in [`Prepared::passes`].
    pub pass: u32,
    /// The patch, by its number in the pass.
    pub patch: u32,
    /// Where in the patch's own domain.
    pub uv: [f32; 2],
    /// Position, in local units, and unit normal.
    pub surface: SurfacePoint,
}

/// A surface as points and triangles. Patches do not share points; where they meet, and the method promises it, points have the same bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellated {
    /// By pass and patch, then v and u.
    pub points: Vec<TessellatedPoint>,
    /// Counter-clockwise in (u, v), by the points' numbers.
    pub triangles: Vec<[u32; 3]>,
}

impl DrawList {
    /// What drawing the list would give: of `prepared`, which it was made for, from its [controls](Prepared::controls). Patches are evaluated in parallel, in
    /// rayon's current pool; the result does not depend on how many threads there are.
    ///
    /// Points have the bits that a device gives them if it rounds as IEEE 754 says and has the same tess coordinates, as devices do at levels that are
    /// powers of two.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] when the list was made for something else; [`Misuse::Count`] for controls of another number of vertices;
    /// [`Error::Refused`] for more points than 32 bits number.
    pub fn tessellate(&self, prepared: &Prepared, controls: &Controls) -> Result<Tessellated> {
        if !self.is_of(prepared) {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        prepared.check_count("control vertices", controls.vertices.len())?;
        let (backend, spacing) = (self.options().backend, self.cut().spacing);
        let mut moulds: FxHashMap<Key, Arc<Mould>> = FxHashMap::default();
        let mut jobs = Vec::new();
        let (mut points, mut triangles) = (0u64, 0);
        for (number, pass) in (0u32..).zip(&prepared.passes) {
            for patch in 0..pass.patches.len() as u32 {
                let Some(levels) = self.levels(prepared, number as usize, patch) else {
                    continue;
                };
                let mould = moulds.entry(key(&levels));
                let mould =
                    Arc::clone(mould.or_insert_with(|| Arc::new(backend.mould(&levels, spacing))));
                points += mould.uv.len() as u64;
                triangles += mould.triangles.len();
                jobs.push((number, patch, mould));
            }
        }
        if points > u64::from(u32::MAX) {
            return Err(Error::Refused(format!(
                "the surface has {points} points, more than can be numbered; choose a lower level"
            )));
        }
        let surface = jobs.par_iter().with_min_len(16);
        let surface = surface.flat_map_iter(|(number, patch, mould)| {
            let pass = &prepared.passes[*number as usize];
            mould.uv.iter().map(move |&uv| TessellatedPoint {
                pass: *number,
                patch: *patch,
                uv,
                surface: pass.evaluate(controls, *patch as usize, uv.into()),
            })
        });
        let surface: Vec<TessellatedPoint> = surface.collect();
        let mut faces = Vec::with_capacity(triangles);
        let mut first = 0;
        for (.., mould) in &jobs {
            let own = mould.triangles.iter();
            faces.extend(own.map(|triangle| triangle.map(|point| first + point)));
            first += mould.uv.len() as u32;
        }
        Ok(Tessellated {
            points: surface,
            triangles: faces,
        })
    }
}

/// What a mould depends on.
type Key = (usize, [u32; 2], [u32; 5]);

fn key(levels: &Levels) -> Key {
    let [a, b, c, d] = levels.edges.map(f32::to_bits);
    (
        levels.domain.corners(),
        levels.cells,
        [a, b, c, d, levels.inside.to_bits()],
    )
}
