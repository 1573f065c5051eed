//! The levels of refinement: which faces are drawn of each, which are refined again, and the points of all.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use crate::abi;
use crate::mesh::Model;
use crate::mesh::sharpness::is_infinite;
use crate::mesh::topology::Topology;
use crate::method::fas::caps::{Caps, has_plane};
use crate::method::fas::level::Level;
use crate::method::patches::{self, Part};
use crate::method::points::{Points, Row};
use crate::method::ptex::Piece;
use crate::method::{Pass, Prepared};
use crate::subdivision::{BsplinePatch, ControlPoint, Mask, bspline_patch, refine};

/// A face of a level that may be drawn: its part of the control mesh, and which piece of that it is.
#[derive(Clone, Copy)]
struct Cell {
    part: Part,
    piece: Piece,
    face: u32,
}

/// A child to be: a corner of a face, and the cell but for its face.
type Child = ((u32, u32), Cell);

/// What is made level by level.
pub struct Levels<'a> {
    model: &'a Model,
    points: Points,
    splines: Pass,
    /// Splines with corners whose normals are compared with those nearby.
    cornered: Pass,
    caps: Pass,
}

impl<'a> Levels<'a> {
    /// Nothing yet, for passes of B-splines, of such with corners of their own, and of end caps.
    pub fn new(model: &'a Model, [splines, cornered, caps]: [Pass; 3]) -> Levels<'a> {
        let mut points = Points::default();
        points.begin(abi::POINTS_BLEND, 0);
        for vertex in 0..model.topology().vertex_count() as u32 {
            points.push(Row::Blend(&Mask::from_slice(&[(vertex, 1.0)])));
        }
        Levels {
            model,
            points,
            splines,
            cornered,
            caps,
        }
    }

    /// Refines so many times, one at least: n-gons are never drawn themselves.
    pub fn refine(mut self, count: u32) -> Prepared {
        let mut topology = Cow::Borrowed(self.model.topology());
        let mut first_point = 0;
        let mut cells: Option<Vec<Cell>> = None;
        for left in (0..=count).rev() {
            let mut level = Level {
                is_irregular: vec![false; topology.face_count()],
                first_point,
                left,
                topology,
            };
            let children = match cells {
                None => self.first_level(&mut level),
                Some(cells) => self.level(&mut level, &cells),
            };
            let corners: Vec<(u32, u32)> = children.iter().map(|child| child.0).collect();
            let refined = refine(&level.topology, &corners);
            let place = |(face, (_, cell)): (u32, Child)| Cell { face, ..cell };
            cells = Some((0..).zip(children).map(place).collect());
            first_point = self.points.count;
            if left > 0 {
                self.points.begin(abi::POINTS_REFINE, first_point);
                for mask in &refined.masks {
                    level.push(&mut self.points, mask);
                }
            }
            topology = Cow::Owned(refined.topology);
        }
        Prepared {
            points: self.points,
            ..Prepared::of([self.splines, self.cornered, self.caps])
        }
    }

    /// The control mesh itself, whose n-gons are refined corner by corner.
    fn first_level(&mut self, level: &mut Level<'_>) -> Vec<Child> {
        let parts = patches::parts(self.model);
        let is_part = |part: &&Part| level.topology.face(part.face).len() != 4;
        let (mut of_parts, mut cells) = (Vec::new(), Vec::new());
        for part in parts.iter().filter(is_part) {
            let cell = Cell {
                part: *part,
                piece: Piece::default(),
                face: 0,
            };
            of_parts.push(((part.face, part.corner), cell));
        }
        for part in parts.iter().filter(|part| !is_part(part)) {
            cells.push(Cell {
                part: *part,
                piece: Piece::default(),
                face: part.face,
            });
        }
        for &((face, _), _) in &of_parts {
            level.is_irregular[face as usize] = true;
        }
        let mut children = self.level(level, &cells);
        children.extend(of_parts);
        children
    }

    /// Draws what can be drawn of a level, and tells what is refined.
    fn level(&mut self, level: &mut Level<'_>, cells: &[Cell]) -> Vec<Child> {
        let splines: Vec<Option<BsplinePatch>> = cells
            .iter()
            .map(|cell| bspline_patch(&level.topology, cell.face))
            .collect();
        for (cell, spline) in cells.iter().zip(&splines) {
            level.is_irregular[cell.face as usize] |= spline.is_none();
        }
        self.points.begin(abi::POINTS_REFINE, self.points.count);
        let mut mirrored = FxHashMap::default();
        let mut caps = Caps::default();
        let mut children = Vec::new();
        for (cell, spline) in cells.iter().zip(&splines) {
            match spline {
                Some(spline) => self.add_spline(level, cell, spline, &mut mirrored),
                None if level.left == 0 => {
                    let controls = caps.points(level, cell.face, &mut self.points);
                    let record = record(self.model, level, cell, 0);
                    add(&mut self.caps, self.model, cell, &controls, record);
                }
                None => children.extend((0..4).map(|corner| {
                    let piece = cell.piece.child(corner);
                    ((cell.face, corner), Cell { piece, ..*cell })
                })),
            }
        }
        children
    }

    fn add_spline(
        &mut self,
        level: &Level<'_>,
        cell: &Cell,
        spline: &BsplinePatch,
        mirrored: &mut FxHashMap<ControlPoint, u32>,
    ) {
        let points = &mut self.points;
        let mut number = |&point: &ControlPoint| match point {
            ControlPoint::Vertex(vertex) => level.first_point + vertex,
            _ => *mirrored
                .entry(point)
                .or_insert_with(|| level.push(points, &point.mask())),
        };
        let mut controls: Vec<u32> = spline.points.iter().map(&mut number).collect();
        let plan = spline.crease.map_or(0, |(edge, sharpness)| {
            controls.push(sharpness.to_bits());
            (edge + 1) << abi::PIECE_CREASE_SHIFT
        });
        let record = record(self.model, level, cell, plan);
        let pass = match record.flags & (abi::PATCH_NEARBY_CORNER * 15) {
            0 => &mut self.splines,
            _ => &mut self.cornered,
        };
        add(pass, self.model, cell, &controls, record);
    }
}

/// The flags of a face: beyond which edges lie two patches of the next level; and where it has not the same normals as the faces beside it, at infinitely
/// sharp features, at semi-sharp ones that no level is left to smooth, and on edges of end caps.
fn flags(level: &Level<'_>, face: u32) -> u32 {
    let topology = &level.topology;
    let irregular = |&face: &u32| level.is_irregular[face as usize];
    let mut flags = 0;
    for (side, &edge) in topology.face_edges(face).iter().enumerate() {
        let faces = topology.edge_faces(edge);
        let own = level.is_irregular[face as usize];
        if level.left > 0 && !own && faces.iter().any(irregular) {
            flags |= abi::PATCH_EVEN_EDGE << side;
        }
        let capped = level.left == 0 && faces.iter().any(irregular);
        let creased = faces.len() > 1 && is_infinite(topology.edge(edge).sharpness);
        if capped || creased {
            flags |= abi::PATCH_CREASED << side;
        }
    }
    for (corner, &vertex) in (0..).zip(topology.face(face)) {
        if !level.is_smooth(vertex) {
            flags |= abi::PATCH_CREASED << (4 + corner);
        }
        let capped = level.left == 0 && level.is_irregular[face as usize];
        if is_alone(topology, face, corner) || capped && !has_plane(topology, face, corner) {
            flags |= abi::PATCH_NEARBY_CORNER << corner;
        }
    }
    flags
}

/// Whether a face has a vertex, or a sector of it between sharp edges, to itself.
fn is_alone(topology: &Topology, face: u32, corner: u32) -> bool {
    let vertex = topology.face(face)[corner as usize];
    topology.vertex_faces(vertex).len() == 1
        || topology.sharp_edges(vertex).next().is_some()
            && topology.fan(face, corner).faces.len() == 1
}

/// Adds a patch.
fn add(pass: &mut Pass, model: &Model, cell: &Cell, controls: &[u32], record: abi::Patch) {
    pass.patches.push(abi::Patch {
        controls: pass.controls.len() as u32,
        ..record
    });
    pass.controls.extend_from_slice(controls);
    pass.texture.push(texture(model, cell));
}

/// The patch of a face but for its control points.
fn record(model: &Model, level: &Level<'_>, cell: &Cell, plan: u32) -> abi::Patch {
    let topology = &level.topology;
    let valence = |&vertex: &u32| topology.vertex_edges(vertex).len().min(255) as u8;
    let mut valences = [0; 4];
    for (valence_of, vertex) in valences.iter_mut().zip(topology.face(cell.face)) {
        *valence_of = valence(vertex);
    }
    let mut flags = flags(level, cell.face);
    if model.topology().face(cell.part.face).len() != 4 {
        flags |= abi::PATCH_HALF;
    }
    if cell.piece.depth > 0 {
        flags |= abi::CHILD_PIECE << abi::PATCH_CHILD_SHIFT;
    }
    abi::Patch {
        ptex: cell.part.ptex,
        flags,
        controls: 0,
        plan: cell.piece.plan() | plan,
        valences: u32::from_le_bytes(valences),
    }
}

/// Texture coordinates at the corners of a piece: linear between those of its part.
fn texture(model: &Model, cell: &Cell) -> [[f32; 2]; 4] {
    let corners = patches::texture(model, cell.part, 0).map(glam::Vec2::from);
    cell.piece.corners().map(|[u, v]| {
        let [a, b, c, d] = corners;
        a.lerp(b, u).lerp(d.lerp(c, u), v).to_array()
    })
}
