//! Which piece of a patch a point is evaluated by, for who looks at one.

use crate::plan::NodeKind;

/// The node of a plan by which a point inside of a patch is evaluated. On edges and at corners other plans have the word, which all faces there share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The plan's number within its pass: patches of the same surroundings have the same.
    pub plan: u32,
    /// The node's kind.
    pub kind: NodeKind,
    /// How often the patch is halved there, levels within a terminal node included.
    pub depth: u32,
}
