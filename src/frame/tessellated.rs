//! A draw list carried out on the CPU: the vertices that the tessellator would make, evaluated by the method's twin in parallel, and their triangles.

use std::sync::Arc;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::DrawList;
use crate::frame::backend::Mould;
use crate::frame::sub_patches::mould;
use crate::method::{Controls, Pass, Prepared, SurfacePoint};
use crate::tessellation::{Levels, Piece};

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
    /// The most points that a surface may have which is kept as points and triangles: some 8 GB of them.
    pub const MOST_POINTS: u64 = 1 << 27;

    /// # Errors
    /// [`Error::Refused`] for more points than [`MOST_POINTS`](Self::MOST_POINTS).
    pub fn check_points(&self, prepared: &Prepared) -> Result<()> {
        let passes = prepared.passes.iter().enumerate();
        let of_pass = |(number, pass): (usize, &Pass)| {
            let patches = 0..pass.patches.len() as u32;
            let points = patches.map(|patch| u64::from(self.vertices(prepared, number, patch)));
            points.sum::<u64>()
        };
        let (points, most) = (passes.map(of_pass).sum::<u64>(), DrawList::MOST_POINTS);
        if points <= most {
            return Ok(());
        }
        Err(Error::Refused(format!(
            "the surface has {points} points, and {most} are the most that are kept; choose a lower level"
        )))
    }

    /// What drawing the list would give: of `prepared`, which it was made for, from its [controls](Prepared::controls). Patches are evaluated in parallel, in
    /// rayon's current pool; the result does not depend on how many threads there are.
    ///
    /// Points have the bits that a device gives them if it rounds as IEEE 754 says and has the same tess coordinates, as devices do at levels that are
    /// powers of two.
    ///
    /// # Errors
    /// [`Misuse::OtherSurface`] when the list was made for something else; [`Misuse::Count`] for controls of another number of vertices;
    /// [`Error::Refused`] for more points than [`MOST_POINTS`](Self::MOST_POINTS).
    pub fn tessellate(&self, prepared: &Prepared, controls: &Controls) -> Result<Tessellated> {
        if !self.is_of(prepared) {
            return Err(Error::Misuse(Misuse::OtherSurface));
        }
        prepared.check_count("control vertices", controls.vertices.len())?;
        self.check_points(prepared)?;
        let mut moulds: FxHashMap<Key, Arc<Mould>> = FxHashMap::default();
        let mut jobs = Vec::new();
        let mut triangles = 0;
        for (number, pass) in (0u32..).zip(&prepared.passes) {
            for patch in 0..pass.patches.len() as u32 {
                let Some(levels) = self.levels(prepared, number as usize, patch) else {
                    continue;
                };
                let record = &pass.patches[patch as usize];
                let mould = moulds.entry(self.key(record, &levels));
                let mould =
                    Arc::clone(mould.or_insert_with(|| Arc::new(self.mould(record, &levels))));
                triangles += mould.triangles.len();
                jobs.push((number, patch, mould));
            }
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

/// What a mould depends on: the shape, which edges count as two where vertices are counted, the cells, and the levels.
type Key = (usize, u32, [u32; 2], [u32; 5]);

impl DrawList {
    fn key(&self, patch: &abi::Patch, levels: &Levels) -> Key {
        let counted = if self.has_sub_patches() {
            EVEN_EDGES
        } else {
            0
        };
        let [a, b, c, d] = levels.edges.map(f32::to_bits);
        let levels_bits = [a, b, c, d, levels.inside.to_bits()];
        (
            levels.domain.corners(),
            patch.flags & counted,
            levels.cells,
            levels_bits,
        )
    }

    fn mould(&self, patch: &abi::Patch, levels: &Levels) -> Mould {
        match self.has_sub_patches() {
            true => mould(patch, levels, Piece::all(levels.piece_depth())),
            false => self.options().backend.mould(levels, self.cut().spacing),
        }
    }
}

/// Of all four edges.
const EVEN_EDGES: u32 = 15 * abi::PATCH_EVEN_EDGE;
