//! The quadtree of a face, as the paper's figure 5 has it, in the face's own coordinates.

use hullform::mesh::Model;
use hullform::plan::{Node, NodeKind, Plan, PlanOptions, Ring};
use hullform::{Error, Result};
use serde_json::{Value, json};

/// The plan of a face, or of the parts of an n-gon that have the same.
pub struct FacePlan {
    /// The n-gon's corners whose parts these are; none of a quad.
    pub corners: Vec<u32>,
    /// The vertices at the corners (0,0), (1,0), (1,1) and (0,1), their valences, and the sharpness of the edges from each to the next. An n-gon's part has
    /// a vertex of the mesh at (0,0) alone.
    pub vertices: Vec<(u32, usize)>,
    pub sharpness: Vec<f32>,
    pub stencils: usize,
    /// The nodes, each behind its parent.
    pub cells: Vec<Cell>,
}

/// A node of a quadtree, and where it is.
pub struct Cell {
    pub kind: NodeKind,
    /// Its number among the nodes.
    pub node: usize,
    pub level: u32,
    /// Its least u and v, and its size.
    pub low: [f64; 2],
    pub size: f64,
    /// The corner of a terminal or extraordinary node at which the vertex is.
    pub corner: Option<[f64; 2]>,
    /// The levels that a terminal node stands for.
    pub levels: usize,
    /// What is left of a crease's sharpness.
    pub sharpness: Option<f32>,
    /// The stencils that it is a B-spline of, number x + 4 y in the plan's frame.
    pub points: Vec<u32>,
    /// The numbers of its children.
    pub children: Vec<usize>,
}

/// The different plans of a face's parts.
///
/// # Errors
/// [`Error::Option`] when there is no such face.
pub fn plans(model: &Model, face: u32, options: PlanOptions) -> Result<Vec<FacePlan>> {
    let topology = model.topology();
    let vertices = topology.face(face);
    if vertices.is_empty() {
        return Err(Error::Option {
            option: "--face",
            problem: format!("there is no face {face}"),
            remedy: format!("give 0 to {}", topology.face_count() - 1),
        });
    }
    if vertices.len() == 4 {
        let ring = Ring::of_quad(topology, face).expect("the face is a quad");
        return Ok(vec![FacePlan::new(model, face, &ring, options)?]);
    }
    let mut rings: Vec<(Ring, Vec<u32>)> = Vec::new();
    for corner in 0..vertices.len() as u32 {
        let ring = Ring::of_part(topology, face, corner).expect("the face has this corner");
        let is_same = |(other, _): &&mut (Ring, Vec<u32>)| {
            (&other.configuration, other.mirrored) == (&ring.configuration, ring.mirrored)
        };
        match rings.iter_mut().find(is_same) {
            Some((_, corners)) => corners.push(corner),
            None => rings.push((ring, vec![corner])),
        }
    }
    let plan = |(ring, corners): (Ring, Vec<u32>)| {
        let plan = FacePlan::new(model, face, &ring, options)?;
        Ok(FacePlan { corners, ..plan })
    };
    rings.into_iter().map(plan).collect()
}

impl FacePlan {
    fn new(model: &Model, face: u32, ring: &Ring, options: PlanOptions) -> Result<FacePlan> {
        let topology = model.topology();
        let plan = Plan::build(&ring.configuration, options)?;
        let (vertices, edges) = (topology.face(face), topology.face_edges(face));
        let named = |&vertex: &u32| (vertex, topology.vertex_edges(vertex).len());
        let sharpness = |&edge: &u32| topology.edges()[edge as usize].sharpness;
        let is_quad = vertices.len() == 4;
        let frame = Frame {
            turn: if is_quad { ring.start } else { 0 },
            mirrored: ring.mirrored,
        };
        let mut cells = Vec::new();
        push(&mut cells, &plan.nodes, frame, 0, (0, [0.0; 2]));
        let own = ring.start as usize;
        let before = (own + edges.len() - 1) % edges.len();
        Ok(FacePlan {
            corners: Vec::new(),
            vertices: match is_quad {
                true => vertices.iter().map(named).collect(),
                false => vec![named(&vertices[own])],
            },
            sharpness: match is_quad {
                true => edges.iter().map(sharpness).collect(),
                false => vec![sharpness(&edges[own]), 0.0, 0.0, sharpness(&edges[before])],
            },
            stencils: plan.stencils.len(),
            cells,
        })
    }

    /// What there is to tell.
    pub fn json(&self) -> Value {
        let cell = |cell: &Cell| {
            let mut value = json!({
                "node": cell.node,
                "kind": name(cell.kind),
                "level": cell.level,
                "u": cell.low[0],
                "v": cell.low[1],
                "size": cell.size,
            });
            let mut put = |key: &str, of: Value| value[key] = of;
            if !cell.children.is_empty() {
                put("children", json!(cell.children));
            }
            if !cell.points.is_empty() {
                put("points", json!(cell.points));
            }
            if let Some(corner) = cell.corner {
                put("corner", json!(corner));
            }
            if cell.levels > 0 {
                put("levels", json!(cell.levels));
            }
            if let Some(sharpness) = cell.sharpness {
                put("sharpness", json!(sharpness));
            }
            value
        };
        let vertex =
            |&(vertex, valence): &(u32, usize)| json!({"vertex": vertex, "valence": valence});
        json!({
            "corners": self.corners,
            "vertices": self.vertices.iter().map(vertex).collect::<Vec<_>>(),
            "sharpness": self.sharpness,
            "stencils": self.stencils,
            "nodes": self.cells.iter().map(cell).collect::<Vec<_>>(),
        })
    }
}

/// The word for a kind of node.
pub fn name(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Internal => "internal",
        NodeKind::Regular => "regular",
        NodeKind::Boundary => "boundary",
        NodeKind::Crease => "crease",
        NodeKind::Terminal => "terminal",
        NodeKind::Extraordinary => "extraordinary",
        NodeKind::Curve => "curve",
    }
}

/// How a plan lies in its face.
#[derive(Clone, Copy)]
struct Frame {
    turn: u32,
    mirrored: bool,
}

impl Frame {
    /// From the plan's (u, v) to the face's.
    fn place(self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [u, v] = if self.mirrored { [v, u] } else { [u, v] };
        match self.turn {
            0 => [u, v],
            1 => [1.0 - v, u],
            2 => [1.0 - u, 1.0 - v],
            _ => [v, 1.0 - u],
        }
    }
}

/// Appends a node that is at `low` of the plan's frame, and all below it.
fn push(
    cells: &mut Vec<Cell>,
    nodes: &[Node],
    frame: Frame,
    number: usize,
    (level, low): (u32, [f64; 2]),
) {
    let node = &nodes[number];
    let size = 0.5f64.powi(level as i32);
    let at = |x: f64, y: f64| [low[0] + x * size, low[1] + y * size];
    let ends = [at(0.0, 0.0), at(1.0, 1.0)].map(|end| frame.place(end));
    let mut cell = Cell {
        kind: node.kind(),
        node: number,
        level,
        low: [0, 1].map(|axis| ends[0][axis].min(ends[1][axis])),
        size,
        corner: None,
        levels: 0,
        sharpness: None,
        points: Vec::new(),
        children: Vec::new(),
    };
    let corner_at = |corner: u32| {
        let [x, y] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][corner as usize];
        Some(frame.place(at(x, y)))
    };
    match node {
        Node::Internal { children } => {
            let children = *children as usize..*children as usize + 4;
            cell.children = children.clone().collect();
            cells.push(cell);
            for (i, child) in children.enumerate() {
                let low = at(0.5 * (i % 2) as f64, 0.5 * (i / 2) as f64);
                push(cells, nodes, frame, child, (level + 1, low));
            }
            return;
        }
        Node::Regular { points, .. } => cell.points = points.to_vec(),
        Node::Crease {
            points, sharpness, ..
        } => {
            cell.points = points.to_vec();
            cell.sharpness = Some(*sharpness);
        }
        Node::Terminal { corner, levels, .. } => {
            cell.corner = corner_at(*corner);
            cell.levels = levels.len();
        }
        Node::Extraordinary { corner } => cell.corner = corner_at(*corner),
        Node::Curve { .. } => {}
    }
    cells.push(cell);
}
