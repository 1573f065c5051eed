//! What the device needs to decide about patches, see `glsl/decide.comp` and `glsl/limits.comp`.

use rustc_hash::FxHashMap;

use crate::abi;
use crate::method::{Outline, Pass, Prepared, Table};

/// Lists of vertices, each there once.
struct Lists<'a> {
    outline: &'a Outline,
    words: Vec<u32>,
    known: FxHashMap<u32, u32>,
    needs: FxHashMap<Needs, u32>,
}

/// The points that a patch needs in the ring, by level.
type Needs = [u32; abi::HIGHEST_LEVEL as usize + 1];

impl Lists<'_> {
    /// Where the list of a side begins.
    fn place(&mut self, side: u32) -> u32 {
        let Lists {
            outline,
            words,
            known,
            ..
        } = self;
        *known.entry(side).or_insert_with(|| {
            let first = words.len() as u32;
            let vertices = outline.side(side);
            words.push(vertices.len() as u32);
            words.extend_from_slice(vertices);
            first
        })
    }

    /// What bounds a patch. Of a macro face it is a list of its own: how many vertices are its faces', and how many there are; then these.
    fn hull(&mut self, pass: &Pass, patch: usize) -> u32 {
        let Some(bounds) = pass.macro_bounds(patch) else {
            let spline = if pass.is_spline { abi::HULL_SPLINE } else { 0 };
            return pass.hull(patch).len() as u32 | spline;
        };
        let place = self.words.len() as u32;
        if bounds.vertices.is_empty() || place >= abi::HULL_LISTED {
            return 0;
        }
        self.words
            .extend([bounds.own as u32, bounds.vertices.len() as u32]);
        self.words.extend(bounds.vertices);
        let spline = if bounds.splines.is_empty() {
            0
        } else {
            abi::HULL_SPLINE
        };
        place | abi::HULL_LISTED | spline
    }

    /// Where it stands how many points a patch needs.
    fn needs(&mut self, pass: &Pass, patch: usize) -> u32 {
        let needs: Needs = std::array::from_fn(|level| pass.points(patch, level as u32));
        let words = &mut self.words;
        *self.needs.entry(needs).or_insert_with(|| {
            words.extend(needs);
            (words.len() - needs.len()) as u32
        })
    }
}

/// `PatchSides` of all patches of a pass, the lists of vertices that these point into, where the sides that patches have in common are there once; and, of the
/// first pass, what all vertices' limits and normals are made of.
pub(crate) fn deciding_tables(prepared: &Prepared, number: usize) -> [Table; 3] {
    let (outline, pass) = (&prepared.outline, &prepared.passes[number]);
    let mut lists = Lists {
        outline,
        words: Vec::new(),
        known: FxHashMap::default(),
        needs: FxHashMap::default(),
    };
    let records = pass
        .sides
        .iter()
        .enumerate()
        .map(|(patch, sides)| abi::PatchSides {
            sides: sides.map(|side| lists.place(side)),
            hull: lists.hull(pass, patch) | pass.stage_flags(patch),
            needs: lists.needs(pass, patch),
        });
    let records: Vec<abi::PatchSides> = records.collect();
    let ends = match number {
        0 => ends(prepared.vertex_count() as u32, &mut lists),
        _ => Vec::new(),
    };
    [
        Table::of(&records),
        Table::of(&lists.words),
        Table::of(&ends),
    ]
}

/// How many vertices there are, and for each where its own words begin. There, its star: how many faces there are around, and of each the vertex behind it
/// and the one before; then the terms of its limit: how many, and of each where its value is from and its weight.
///
/// Each has room for the terms of a smooth vertex among quads, so that other tags move nothing else.
fn ends(vertices: u32, lists: &mut Lists<'_>) -> Vec<u32> {
    let outline = lists.outline;
    let mut words = vec![0; 1 + vertices as usize];
    words[0] = vertices;
    for vertex in 0..vertices {
        words[1 + vertex as usize] = words.len() as u32;
        let star = outline.star(vertex);
        words.push(star.len() as u32);
        words.extend(star.iter().flatten());
        let row = outline.limit_row(vertex);
        words.push(row.len() as u32);
        let most = match row.is_empty() && outline.is_on_surface() {
            true => 0,
            false => 1 + 2 * star.len(),
        };
        let behind = words.len() + 2 * most;
        for &(source, weight) in row {
            let source = match source & abi::LIMIT_FACE {
                0 => source,
                _ => {
                    let side = outline.side_of_face(source & !abi::LIMIT_FACE);
                    abi::LIMIT_FACE | lists.place(side)
                }
            };
            words.extend([source, weight.to_bits()]);
        }
        words.resize(behind.max(words.len()), 0);
    }
    words
}
