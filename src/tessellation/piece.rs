//! Pieces of squares that are halved again and again.

use crate::abi;

/// The greatest tess level of a patch that is drawn at once.
pub(crate) const TESSELLATED: f32 = (1u32 << abi::TESSELLATED_LEVEL) as f32;

/// A piece of a quad that is halved `depth` times: so many pieces to the right and up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Piece {
    /// 0..=15.
    pub depth: u32,
    /// Of 2^depth, 12 bits.
    pub column: u32,
    /// Of 2^depth, 12 bits.
    pub row: u32,
}

/// The bits of a column or row.
const PLACE_BITS: u32 = abi::PIECE_ROW_SHIFT;

impl Piece {
    /// That of a patch's plan, or of a sub-patch.
    pub fn of_plan(plan: u32) -> Piece {
        Piece {
            depth: plan >> abi::PIECE_DEPTH_SHIFT,
            column: plan & ((1 << PLACE_BITS) - 1),
            row: plan >> PLACE_BITS & ((1 << PLACE_BITS) - 1),
        }
    }

    /// As these have it.
    pub fn plan(self) -> u32 {
        self.depth << abi::PIECE_DEPTH_SHIFT | self.row << PLACE_BITS | self.column
    }

    /// All of a depth, row by row.
    pub fn all(depth: u32) -> impl Iterator<Item = Piece> {
        let count = 1 << depth;
        let row = move |row| (0..count).map(move |column| Piece { depth, column, row });
        (0..count).flat_map(row)
    }

    /// Its quarter at a corner.
    pub fn child(self, corner: u32) -> Piece {
        let [right, up] = [[0, 0], [1, 0], [1, 1], [0, 1]][corner as usize];
        Piece {
            depth: self.depth + 1,
            column: 2 * self.column + right,
            row: 2 * self.row + up,
        }
    }

    /// Which of its edges lie on those of the whole.
    pub fn borders(self) -> [bool; 4] {
        let last = (1 << self.depth) - 1;
        [
            self.row == 0,
            self.column == last,
            self.row == last,
            self.column == 0,
        ]
    }

    /// Where its corners are in the whole.
    pub fn corners(self) -> [[f32; 2]; 4] {
        let [x, y] = self.place();
        let at = |right: f32, up: f32| [self.size() * (x + right), self.size() * (y + up)];
        [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]
    }

    /// So many of its edges to the right and up.
    pub fn place(self) -> [f32; 2] {
        [self.column as f32, self.row as f32]
    }

    /// Of its edges, in those of the whole.
    pub fn size(self) -> f32 {
        1.0 / (1u32 << self.depth) as f32
    }
}
