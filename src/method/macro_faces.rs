//! Macro faces: several quads that are drawn as one patch (Brainerd et al. 2016, section 7.3). Here is which quads these are; how they are drawn is the
//! `quadtree` method's.
//!
//! **Rectangles** are what separatrices leave of the mesh, see `macro_faces/rectangles.rs`; **quartets** are four regular faces around a vertex, see
//! `macro_faces/quartets.rs`. Faces of other than four corners are in none, nor are holes.

mod lines;
mod quartets;
mod rectangles;
mod region;

use crate::error::{Error, Result};
use crate::mesh::Model;
use crate::mesh::topology::FaceCorner;
use crate::plan::SmoothQuads;
pub(super) use lines::join_sides;
use region::Region;

/// Which faces are drawn together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MacroFaces {
    /// None: a patch a face.
    #[default]
    None,
    /// Rectangles of up to `span` by `span` faces, 2..=32. They are drawn with up to 64 / `span` segments an edge of a face.
    Rectangles {
        /// The most edges of a side.
        span: u32,
    },
    /// Four regular faces around a vertex. They are drawn with up to 32 segments an edge of a face.
    Quartets,
}

impl MacroFaces {
    /// The range of [`Rectangles::span`](MacroFaces::Rectangles).
    pub const SPANS: std::ops::RangeInclusive<u32> = 2..=32;

    /// The most edges that a side has.
    pub fn span(self) -> u32 {
        match self {
            MacroFaces::None => 1,
            MacroFaces::Rectangles { span } => span,
            MacroFaces::Quartets => 2,
        }
    }

    /// The greatest tess level that every face can have: the tessellator makes 64 segments of a side at most.
    pub fn greatest_level(self) -> u32 {
        64 / self.span()
    }

    /// Checks the range.
    ///
    /// # Errors
    /// [`Error::Option`] when the span is out of range.
    pub fn check(self) -> Result<MacroFaces> {
        match self {
            MacroFaces::Rectangles { span } if !Self::SPANS.contains(&span) => Err(Error::Option {
                option: "--macro-span",
                problem: format!("{span} is out of range"),
                remedy:
                    "give 2 to 32; faces of rectangles of so many can be cut into 64 / N segments"
                        .into(),
            }),
            sound => Ok(sound),
        }
    }

    /// The macro faces of a model, in the order of their first faces; none of a span out of range. Each quad is in one at most; of rectangles, each that is no
    /// hole in exactly one, and be it alone. In time and memory like the model's size.
    pub fn find(self, model: &Model) -> Vec<MacroFace> {
        let smooth = SmoothQuads::new(model.topology());
        let region = Region::new(model, &smooth);
        match self {
            MacroFaces::Rectangles { span } if span > 0 => rectangles::find(&region, span),
            MacroFaces::Quartets => quartets::find(&region),
            _ => Vec::new(),
        }
    }

    /// How many of each there are.
    pub fn count(self, model: &Model) -> MacroFaceCounts {
        let smooth = SmoothQuads::new(model.topology());
        let found = self.find(model);
        let mut counts = MacroFaceCounts::default();
        let topology = model.topology();
        let mut alone = vec![true; topology.face_count()];
        for one in found.iter().filter(|one| one.cells.len() > 1) {
            counts.macro_faces += 1;
            counts.faces += one.cells.len();
            let [columns, rows] = [one.columns, one.rows];
            counts.largest = counts.largest.max([columns.max(rows), columns.min(rows)]);
            for cell in &one.cells {
                alone[cell.face as usize] = false;
            }
        }
        let faces = (0u32..).zip(&alone);
        for (face, _) in faces.filter(|&(face, alone)| *alone && !topology.is_hole(face)) {
            match smooth.is_regular(face) {
                true => counts.regular += 1,
                false => counts.irregular += 1,
            }
        }
        counts
    }
}

/// Quads that are drawn as one patch: a grid of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MacroFace {
    /// Cells along u.
    pub columns: u32,
    /// Cells along v.
    pub rows: u32,
    /// The cells, number i + `columns` j: each a face, and the corner of it that is at the cell's (0, 0). From there along the face's side runs u.
    pub cells: Vec<FaceCorner>,
}

/// How many faces there are of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MacroFaceCounts {
    /// Macro faces of more than one face.
    pub macro_faces: usize,
    /// The faces in these.
    pub faces: usize,
    /// Faces by themselves that have plans, n-gons as one.
    pub irregular: usize,
    /// Faces by themselves that are one B-spline.
    pub regular: usize,
    /// The longer and the shorter side of the largest macro face, in faces: the one with the longest side.
    pub largest: [u32; 2],
}
