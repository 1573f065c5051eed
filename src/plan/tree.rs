//! The quadtree of a plan: its nodes, and how repeating ones fold into terminal nodes (Brainerd et al. 2016, section 4.1).

/// What a node is; the words of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
pub enum NodeKind {
    /// Has four children.
    Internal = 0,
    /// A B-spline of sixteen control points.
    Regular = 1,
    /// A B-spline with control points mirrored beyond a boundary or an infinite crease.
    Boundary = 2,
    /// A B-spline with one semi-sharp crease along an edge.
    Crease = 3,
    /// Stands for levels of three B-splines each around an extraordinary vertex.
    Terminal = 4,
    /// An extraordinary vertex, evaluated nowhere but there.
    Extraordinary = 5,
    /// A stretch of an edge.
    Curve = 6,
}

impl NodeKind {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            NodeKind::Internal => "internal",
            NodeKind::Regular => "regular",
            NodeKind::Boundary => "boundary",
            NodeKind::Crease => "crease",
            NodeKind::Terminal => "terminal",
            NodeKind::Extraordinary => "extraordinary",
            NodeKind::Curve => "curve",
        }
    }
}

/// A node of the quadtree. Points are numbers of the plan's stencils.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// Four children x + 2 y from this node on; of an edge, two.
    Internal {
        /// The first child.
        children: u32,
    },
    /// A B-spline; `mirrored` makes it a boundary node.
    Regular {
        /// Its control points, number x + 4 y.
        points: [u32; 16],
        /// Whether any of them lies beyond a boundary or infinite crease.
        mirrored: bool,
        /// The point that they are relative to, if any.
        base: Option<u32>,
    },
    /// A B-spline with a semi-sharp crease along the edge from corner `edge` to the next.
    Crease {
        /// Its control points, number x + 4 y.
        points: [u32; 16],
        /// The creased edge, 0..=3.
        edge: u32,
        /// The sharpness that is left at this node's level.
        sharpness: f32,
        /// The point that the control points are relative to, if any.
        base: Option<u32>,
    },
    /// Levels around the extraordinary vertex at `corner`, the outermost first.
    Terminal {
        /// The corner, 0..=3, both of the node and of the face.
        corner: u32,
        /// For each level 5 x 5 points, number x + 5 y; the one beyond the extraordinary vertex is missing and stands as 0.
        levels: Vec<[u32; 25]>,
        /// The point that they are relative to.
        base: Option<u32>,
    },
    /// A stretch of an edge, in the plan of an edge: a B-spline whose row 1 is the position along the edge, and row 2 that plus the derivative
    /// across. The other rows have no weight.
    Curve {
        /// Sixteen points for each side that has its own derivative, number x + 4 y.
        points: Vec<u32>,
        /// The edge of the B-spline, 3 or 1, along which a semi-sharp crease crosses at the stretch's beginning or end.
        edge: u32,
        /// The sharpness that is left there at this node's level; 0 without a crease.
        sharpness: f32,
        /// The point that its points are relative to, if any.
        base: Option<u32>,
    },
    /// The extraordinary vertex at `corner`; of an edge, at the end `corner`.
    Extraordinary {
        /// The corner, 0..=3, both of the node and of the face.
        corner: u32,
    },
}

impl Node {
    /// The child of a terminal node at a corner: a B-spline, or what is left around the extraordinary vertex. None of other nodes.
    pub(super) fn child(&self, corner: u32) -> Option<Node> {
        let Node::Terminal {
            corner: end,
            levels,
            base,
        } = self
        else {
            return None;
        };
        let (grid, rest) = levels.split_first()?;
        if corner != *end {
            let number = child_of_corner(corner);
            let first = number % 2 + 5 * (number / 2);
            return Some(Node::Regular {
                points: std::array::from_fn(|i| grid[first + i % 4 + 5 * (i / 4)]),
                mirrored: false,
                base: *base,
            });
        }
        Some(if rest.is_empty() {
            Node::Extraordinary { corner }
        } else {
            Node::Terminal {
                corner,
                levels: rest.to_vec(),
                base: *base,
            }
        })
    }

    /// The node's kind.
    pub fn kind(&self) -> NodeKind {
        match self {
            Node::Internal { .. } => NodeKind::Internal,
            Node::Regular {
                mirrored: false, ..
            } => NodeKind::Regular,
            Node::Regular { mirrored: true, .. } => NodeKind::Boundary,
            Node::Crease { .. } => NodeKind::Crease,
            Node::Curve { .. } => NodeKind::Curve,
            Node::Terminal { .. } => NodeKind::Terminal,
            Node::Extraordinary { .. } => NodeKind::Extraordinary,
        }
    }
}

/// The quadtree while it grows.
#[derive(Clone, Debug)]
pub(super) enum Tree {
    /// Children in the order x + 2 y.
    Inner(Box<[Tree; 4]>),
    /// Anything but [`Node::Internal`].
    Leaf(Node),
}

/// The child number x + 2 y of a corner.
pub(super) fn child_of_corner(corner: u32) -> usize {
    [0, 1, 3, 2][corner as usize]
}

impl Tree {
    /// A cell with the four at its corners, in their order.
    pub(super) fn of_corners([a, b, c, d]: [Tree; 4]) -> Tree {
        // The child at corner 2 is number 3.
        Tree::Inner(Box::new([a, b, d, c]))
    }

    /// Folds inner nodes with three B-splines and one extraordinary or terminal node into terminal nodes, from the leaves up.
    pub(super) fn fold(self) -> Tree {
        let Tree::Inner(children) = self else {
            return self;
        };
        let children = Box::new(children.map(Tree::fold));
        match terminal(&children) {
            Some(node) => Tree::Leaf(node),
            None => Tree::Inner(children),
        }
    }

    /// The nodes in breadth-first order, the children of a node side by side.
    pub(super) fn flatten(self) -> Vec<Node> {
        let mut nodes = Vec::new();
        let mut queue = std::collections::VecDeque::from([self]);
        let mut next = 1;
        while let Some(tree) = queue.pop_front() {
            match tree {
                Tree::Leaf(node) => nodes.push(node),
                Tree::Inner(children) => {
                    nodes.push(Node::Internal { children: next });
                    next += 4;
                    queue.extend(*children);
                }
            }
        }
        nodes.shrink_to_fit();
        nodes
    }
}

fn terminal(children: &[Tree; 4]) -> Option<Node> {
    let end = children
        .iter()
        .position(|child| !matches!(child, Tree::Leaf(Node::Regular { .. })))?;
    let (corner, inner, mut base) = match &children[end] {
        Tree::Leaf(Node::Extraordinary { corner }) => (*corner, Vec::new(), None),
        Tree::Leaf(Node::Terminal {
            corner,
            levels,
            base,
        }) => (*corner, levels.clone(), Some(*base)),
        _ => return None,
    };
    if child_of_corner(corner) != end {
        return None;
    }
    let mut grid = [0; 25];
    for (number, child) in children
        .iter()
        .enumerate()
        .filter(|&(number, _)| number != end)
    {
        let Tree::Leaf(Node::Regular {
            points, base: own, ..
        }) = child
        else {
            return None;
        };
        if *base.get_or_insert(*own) != *own {
            return None;
        }
        for (i, &point) in points.iter().enumerate() {
            grid[(i % 4 + number % 2) + 5 * (i / 4 + number / 2)] = point;
        }
    }
    let levels = std::iter::once(grid).chain(inner).collect();
    Some(Node::Terminal {
        corner,
        levels,
        base: base.flatten(),
    })
}
