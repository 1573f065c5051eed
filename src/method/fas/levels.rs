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
use crate::method::pieces::Cell;
use crate::method::points::{Points, Row};
use crate::method::{EndCaps, Pass, Prepared};
use crate::subdivision::{BsplinePatch, ControlPoint, Mask, bspline_patch, refine};

/// A child to be: a corner of a face, and the cell but for its face.
type Child = ((u32, u32), Cell);

/// What is made level by level.
pub struct Levels<'a> {
    model: &'a Model,
    points: Points,
    splines: Pass,
    /// Splines with corners whose normals are compared with those nearby.
    cornered: Pass,
    /// Bicubic end caps.
    caps: Pass,
    /// Those of the kind that is asked for.
    own_caps: Pass,
    kind: EndCaps,
}

impl<'a> Levels<'a> {
    /// Nothing yet, for passes of B-splines, of such with corners of their own, of bicubic end caps and of those of a kind.
    pub fn new(
        model: &'a Model,
        [splines, cornered, caps, own_caps]: [Pass; 4],
        kind: EndCaps,
    ) -> Levels<'a> {
        Levels {
            model,
            points: control_vertices(model),
            splines,
            cornered,
            caps,
            own_caps,
            kind,
        }
    }

    /// Refines so many times; where there are n-gons, which are never drawn themselves, once at least.
    pub fn refine(mut self, count: u32) -> Prepared {
        let has_parts = self.model.topology().quads().is_none();
        let count = count.max(u32::from(has_parts));
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
            ..Prepared::of([self.splines, self.cornered, self.caps, self.own_caps])
        }
    }

    /// The control mesh itself, whose n-gons are refined corner by corner.
    fn first_level(&mut self, level: &mut Level<'_>) -> Vec<Child> {
        let parts = patches::parts(self.model);
        let is_part = |part: &&Part| level.topology.face(part.face).len() != 4;
        let (of_parts, cells): (Vec<Part>, Vec<Part>) =
            parts.iter().copied().partition(|part| is_part(&part));
        let of_parts: Vec<Child> = of_parts
            .into_iter()
            .map(|part| ((part.face, part.corner), Cell::of(part)))
            .collect();
        let cells: Vec<Cell> = cells.into_iter().map(Cell::of).collect();
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
        let mut caps = Caps::new(self.kind);
        let mut children = Vec::new();
        for (cell, spline) in cells.iter().zip(&splines) {
            match spline {
                Some(spline) => self.add_spline(level, cell, spline, &mut mirrored),
                None if level.left == 0 => {
                    let cap = caps.of(level, cell.face, &mut self.points);
                    let record = record(self.model, level, cell, 0);
                    let pass = match cap.is_bicubic {
                        true => &mut self.caps,
                        false => &mut self.own_caps,
                    };
                    cell.add(pass, self.model, &cap.controls, record);
                }
                None => {
                    children.extend((0..4).map(|corner| ((cell.face, corner), cell.child(corner))));
                }
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
        let (controls, plan) = spline_controls(level, spline, mirrored, &mut self.points);
        let record = record(self.model, level, cell, plan);
        let pass = match record.flags & (abi::PATCH_NEARBY_CORNER * 15) {
            0 => &mut self.splines,
            _ => &mut self.cornered,
        };
        cell.add(pass, self.model, &controls, record);
    }
}

/// The points of the control vertices themselves.
pub fn control_vertices(model: &Model) -> Points {
    let mut points = Points::default();
    points.begin(abi::POINTS_BLEND, 0);
    for vertex in 0..model.topology().vertex_count() as u32 {
        points.push(Row::Blend(&Mask::from_slice(&[(vertex, 1.0)])));
    }
    points
}

/// The control points of a B-spline, behind which the sharpness of its crease stands, and the edge of that in its plan. Mirrored points are added once.
pub fn spline_controls(
    level: &Level<'_>,
    spline: &BsplinePatch,
    mirrored: &mut FxHashMap<ControlPoint, u32>,
    points: &mut Points,
) -> (Vec<u32>, u32) {
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
    (controls, plan)
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

/// The patch of a face but for its control points.
pub fn record(model: &Model, level: &Level<'_>, cell: &Cell, plan: u32) -> abi::Patch {
    let record = cell.record(model, &level.topology);
    abi::Patch {
        flags: record.flags | flags(level, cell.face),
        plan: record.plan | plan,
        ..record
    }
}
