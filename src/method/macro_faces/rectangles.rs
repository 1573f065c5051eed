//! Rectangles by separatrices: from each edge at an extraordinary vertex a line goes straight on through regular vertices, to an extraordinary one or to the
//! boundary. What these lines leave are rectangles of faces, and corners of rectangles meet corners, since at a regular vertex a line has both edges that
//! lie opposite to each other, or none (Brainerd et al. 2016, section 7.3).
//!
//! Regular here is what has four quads around it, creases or not. Lines also are where macro faces may not go on at all, see [`Region::is_barred`]; they too
//! go straight on beyond their ends. Where no line has a corner, as on a torus or a tube, one begins at the first face ("an arbitrary regular
//! separatrix origin"). Sides longer than the span are cut into as few parts as it takes, of about the same length, by more lines: the first that is too
//! long first, and each line is taken into account by those that come later.

use super::MacroFace;
use super::region::Region;
use crate::mesh::topology::FaceCorner;

/// The rectangles, of at most `span` by `span` faces.
pub fn find(region: &Region<'_>, span: u32) -> Vec<MacroFace> {
    let mut lines = Lines::new(region);
    lines.begin();
    lines.give_corners();
    while lines.cut(span) {}
    lines.rectangles()
}

/// The sides that lie on lines.
struct Lines<'a> {
    region: &'a Region<'a>,
    /// By side; both sides of an edge are alike.
    marked: Vec<bool>,
}

impl Lines<'_> {
    fn new<'a>(region: &'a Region<'a>) -> Lines<'a> {
        Lines {
            region,
            marked: vec![false; 4 * region.topology().face_count()],
        }
    }

    /// The sides of all quads, holes included: lines go on along them.
    fn sides(&self) -> impl Iterator<Item = u32> + use<> {
        let topology = self.region.topology();
        let faces = 0..topology.face_count() as u32;
        let quads: Vec<u32> = faces
            .filter(|&face| topology.face(face).len() == 4)
            .collect();
        quads
            .into_iter()
            .flat_map(|face| (0..4).map(move |corner| 4 * face + corner))
    }

    fn begin(&mut self) {
        for side in self.sides() {
            let next = Region::after(side, 1);
            let is_at_end = !self.is_passed(side) || !self.is_passed(next);
            if is_at_end || self.region.is_barred(side) {
                self.mark(side);
            }
        }
    }

    /// Whether no line has to begin where a side begins: at vertices with four quads, and at those of the boundary where a single line ends.
    fn is_passed(&self, side: u32) -> bool {
        let vertex = self.region.start(side);
        let topology = self.region.topology();
        let is_on_side = || match topology.vertex_faces(vertex) {
            [_] => true,
            [first, second] => {
                let are_quads = [first, second].map(|at| topology.face(at.face).len() == 4);
                let [a, b] = [first, second].map(|at| 4 * at.face + at.corner);
                let joins = |a: u32, b: u32| self.region.beyond(Region::after(a, 3)) == Some(b);
                // Joined twice they are all around it.
                are_quads == [true; 2] && joins(a, b) != joins(b, a)
            }
            _ => false,
        };
        self.region.goes_on(vertex) || is_on_side()
    }

    /// Marks an edge, and all that go straight on from both of its ends.
    fn mark(&mut self, side: u32) {
        let mut next = vec![side];
        while let Some(side) = next.pop() {
            if std::mem::replace(&mut self.marked[side as usize], true) {
                continue;
            }
            next.extend(self.region.beyond(side));
            let end = self.region.start(Region::after(side, 1));
            if self.region.goes_on(end) {
                next.extend(self.region.straight(side));
            }
        }
    }

    fn is_marked(&self, side: u32) -> bool {
        self.marked[side as usize]
    }

    /// Whether lines meet where a side begins, in its face.
    fn is_corner(&self, side: u32) -> bool {
        self.is_marked(side) && self.is_marked(Region::after(side, 3))
    }

    /// Adds lines to what has none that meet.
    fn give_corners(&mut self) {
        let mut met = vec![false; self.marked.len() / 4];
        for first in 0..met.len() as u32 {
            if met[first as usize] || self.region.topology().face(first).len() != 4 {
                continue;
            }
            let mut faces = vec![first];
            met[first as usize] = true;
            let (mut at, mut has_corner, mut marked) = (0, false, None);
            while let Some(&face) = faces.get(at) {
                at += 1;
                for side in (0..4).map(|corner| 4 * face + corner) {
                    has_corner |= self.is_corner(side);
                    if self.is_marked(side) {
                        marked = marked.or(Some(side));
                    } else if let Some(beyond) = self.region.beyond(side)
                        && !std::mem::replace(&mut met[(beyond / 4) as usize], true)
                    {
                        faces.push(beyond / 4);
                    }
                }
            }
            if has_corner {
                continue;
            }
            // A tube is cut across, at its rim; what has no rim both ways.
            let side = marked.unwrap_or(4 * first);
            if marked.is_none() {
                self.mark(side);
            }
            self.mark(Region::after(side, 3));
        }
    }

    /// The side along which the next face to the right begins, whose own is the lower one; None where a line is between.
    fn right(&self, lower: u32) -> Option<u32> {
        let side = Region::after(lower, 1);
        let beyond = self.region.beyond(side).filter(|_| !self.is_marked(side))?;
        Some(Region::after(beyond, 1))
    }

    /// The lower side of the face above.
    fn above(&self, lower: u32) -> Option<u32> {
        let side = Region::after(lower, 2);
        self.region.beyond(side).filter(|_| !self.is_marked(side))
    }

    /// The lower sides from one on to the right.
    fn row(&self, lower: u32) -> Vec<u32> {
        let row = std::iter::successors(Some(lower), |&lower| self.right(lower));
        row.take(self.marked.len()).collect()
    }

    /// Cuts what is longer than the span; false where nothing is. Lines may leave long parts between them, which the next time finds.
    fn cut(&mut self, span: u32) -> bool {
        let mut is_cut = false;
        for lower in self.sides() {
            if !self.is_corner(lower) {
                continue;
            }
            let row = self.row(lower);
            let parts = row.len().div_ceil(span as usize);
            for part in 1..parts {
                let behind = row[part * row.len() / parts - 1];
                self.mark(Region::after(behind, 1));
                is_cut = true;
            }
        }
        is_cut
    }

    fn rectangles(&self) -> Vec<MacroFace> {
        let mut met = vec![false; self.marked.len() / 4];
        let mut found = Vec::new();
        for lower in self.sides() {
            let face = lower / 4;
            if met[face as usize] || !self.is_corner(lower) || !self.region.has(face) {
                continue;
            }
            let one = self.rectangle(lower);
            for cell in &one.cells {
                met[cell.face as usize] = true;
            }
            found.push(one);
        }
        found
    }

    /// The rectangle whose corner is where a side begins.
    fn rectangle(&self, lower: u32) -> MacroFace {
        let columns = self.row(lower).len();
        let rows = std::iter::successors(Some(lower), |&lower| self.above(lower));
        let rows: Vec<u32> = rows.take(self.marked.len()).collect();
        let sides = rows.iter().flat_map(|&lower| self.row(lower));
        let cell = |side: u32| FaceCorner {
            face: side / 4,
            corner: side % 4,
        };
        let cells: Vec<FaceCorner> = sides.map(cell).collect();
        assert_eq!(
            cells.len(),
            columns * rows.len(),
            "lines go straight on wherever four quads meet, so all rows end at the same one"
        );
        MacroFace {
            columns: columns as u32,
            rows: rows.len() as u32,
            cells,
        }
    }
}
