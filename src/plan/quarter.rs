//! What is below a quarter of a face that is no leaf.
//!
//! A quarter's limit is decided by its own surroundings, one level down, and these repeat more often than those of faces: the four quarters of a face meet
//! in all combinations. So each is grown once, as sums over its own ring, and the plans of faces put theirs together: turned and mirrored as the quarter
//! lies, with sums over the face's ring in place of the quarter's.

use crate::plan::tree::{Node, Tree, child_of_corner};

/// A quarter of more terms is of a pole.
const LARGE: usize = 1 << 13;

/// A quarter, seen from its corner of the face: that is corner 0 of both.
pub(super) struct Quarter {
    /// The cells, whose control points are numbers of sums.
    tree: Tree,
    /// Where the terms of each sum end.
    ends: Vec<usize>,
    /// Vertices of the quarter's ring, and their weights.
    terms: Vec<(u32, f64)>,
}

impl Quarter {
    /// Of cells whose control points are numbers of sums; of these, where the terms of each end, and the terms.
    pub fn new(tree: Tree, ends: Vec<usize>, terms: Vec<(u32, f64)>) -> Quarter {
        Quarter { tree, ends, terms }
    }

    /// Whether it is hardly ever needed again, and takes much memory.
    pub fn is_large(&self) -> bool {
        self.terms.len() > LARGE
    }

    /// The cells as they lie in a face, whose sums begin at this number.
    pub fn tree(&self, placed: &Placed, first: u32) -> Tree {
        placed.tree(&self.tree, first)
    }

    /// Visits its sums, over the vertices of the face's level 1.
    pub fn each_sum(&self, placed: &Placed, mut visit: impl FnMut(&[(u32, f64)])) {
        let mut sum = Vec::new();
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        for (start, &end) in starts.zip(&self.ends) {
            let terms = self.terms[start..end].iter();
            sum.clear();
            sum.extend(terms.map(|&(place, weight)| (placed.ring[place as usize], weight)));
            visit(&sum);
        }
    }
}

/// How a quarter lies in a face.
pub(super) struct Placed {
    /// The face's corner that is the quarter's corner 0.
    corner: u32,
    /// Whether it lies there as in a mirror.
    mirrored: bool,
    /// The vertices of its ring, by their numbers in the face's level 1.
    ring: Vec<u32>,
}

impl Placed {
    /// The quarter whose ring begins at its corner of the face.
    pub fn new(corner: u32, mirrored: bool, ring: Vec<u32>) -> Placed {
        Placed {
            corner,
            mirrored,
            ring,
        }
    }

    /// The face's corner at a corner of the quarter.
    fn corner(&self, own: u32) -> u32 {
        (self.corner + if self.mirrored { 4 - own } else { own }) % 4
    }

    /// The edge from a corner of the quarter to the next.
    fn edge(&self, own: u32) -> u32 {
        self.corner(own + u32::from(self.mirrored))
    }

    /// Control points, number x + 4 y.
    fn points(&self, own: &[u32; 16], first: u32) -> [u32; 16] {
        let mut points = [0; 16];
        for (i, point) in own.iter().enumerate() {
            let [mut x, mut y] = [i % 4, i / 4];
            if self.mirrored {
                (x, y) = (y, x);
            }
            for _ in 0..self.corner {
                (x, y) = (3 - y, x);
            }
            points[x + 4 * y] = first + point;
        }
        points
    }

    fn tree(&self, own: &Tree, first: u32) -> Tree {
        let node = match own {
            Tree::Inner(children) => {
                let mut corners: [Option<Tree>; 4] = Default::default();
                for corner in 0..4 {
                    let child = &children[child_of_corner(corner)];
                    corners[self.corner(corner) as usize] = Some(self.tree(child, first));
                }
                let corners = corners.map(|tree| tree.expect("each corner is one of the face's"));
                return Tree::of_corners(corners);
            }
            Tree::Leaf(node) => node,
        };
        let base = Some(self.corner);
        Tree::Leaf(match node {
            Node::Regular {
                points, mirrored, ..
            } => Node::Regular {
                points: self.points(points, first),
                mirrored: *mirrored,
                base,
            },
            Node::Crease {
                points,
                edge,
                sharpness,
                ..
            } => Node::Crease {
                points: self.points(points, first),
                edge: self.edge(*edge),
                sharpness: *sharpness,
                base,
            },
            Node::Extraordinary { corner } => Node::Extraordinary {
                corner: self.corner(*corner),
            },
            other => other.clone(),
        })
    }
}
