//! What is refined around each irregularity, to all depths: level by level, so that the points of a level are one step, of which frames need parts.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use crate::abi;
use crate::mesh::Model;
use crate::mesh::sharpness::is_infinite;
use crate::method::fas::caps::Caps;
use crate::method::fas::level::Level;
use crate::method::fas::levels::{control_vertices, record, spline_controls};
use crate::method::patches;
use crate::method::pieces::Cell;
use crate::method::points::Points;
use crate::method::stage::{ALWAYS, NOWHERE, Stage};
use crate::method::{EndCaps, Pass, Prepared};
use crate::subdivision::{BsplinePatch, bspline_patch, corner_points, refine};

/// Up to any depth.
const DEEPEST: u32 = u32::MAX;

/// What is made level by level.
pub struct Growth<'a> {
    model: &'a Model,
    points: Points,
    /// B-splines, such with corners of their own, bicubic end caps, those of the kind that is asked for.
    passes: [Pass; 4],
    kind: EndCaps,
    deepest: u32,
}

/// A level with some of its faces.
struct Grown<'a> {
    level: Level<'a>,
    cells: Vec<Cell>,
}

/// What is irregular on a level: by irregularity, which of the levels has it, and its cells there.
struct Irregular<'a> {
    levels: Vec<Level<'a>>,
    cells: Vec<(usize, Vec<Cell>)>,
}

impl<'a> Growth<'a> {
    /// Nothing yet, for the passes of [`fas`](crate::method::fas::passes).
    pub fn new(model: &'a Model, passes: [Pass; 4], kind: EndCaps, deepest: u32) -> Growth<'a> {
        Growth {
            model,
            points: control_vertices(model),
            passes,
            kind,
            deepest: deepest.max(1),
        }
    }

    /// All of it.
    pub fn grow(mut self) -> Prepared {
        let base = self.base();
        self.begin();
        let first = self.children(&base.level, &base.cells, self.deepest - 1);
        let mut irregular = self.first_level(first);
        self.caps(&mut irregular, 1);
        for depth in 2..=self.deepest {
            irregular = self.next_level(&irregular, depth);
            self.caps(&mut irregular, depth);
        }
        Prepared {
            points: self.points,
            irregularities: irregular.cells.len() as u32,
            ..Prepared::of(self.passes)
        }
    }

    /// Begins a step of points.
    fn begin(&mut self) {
        self.points.begin(abi::POINTS_REFINE, self.points.count);
    }

    /// The rows of the step so far.
    fn rows(&self) -> u32 {
        self.points.steps.last().map_or(0, |step| step.count)
    }

    /// The control mesh: its B-splines are always drawn, and all else is refined.
    fn base(&mut self) -> Grown<'a> {
        let topology = self.model.topology();
        let parts = patches::parts(self.model).into_iter().map(Cell::of);
        let (quads, mut cells): (Vec<Cell>, Vec<Cell>) =
            parts.partition(|cell| topology.face(cell.face).len() == 4);
        let mut grown = Grown {
            level: Level {
                is_irregular: vec![false; topology.face_count()],
                first_point: 0,
                left: self.deepest,
                topology: Cow::Borrowed(topology),
            },
            cells: quads,
        };
        for cell in &cells {
            grown.level.is_irregular[cell.face as usize] = true;
        }
        let splines = mark(&mut grown);
        self.begin();
        let always = |_: u32| ALWAYS;
        self.splines(&grown, &splines, [NOWHERE, 0], always);
        let Grown {
            level,
            cells: quads,
        } = grown;
        cells.extend(quads.into_iter().filter(|cell| is_irregular(&level, cell)));
        Grown { level, cells }
    }

    /// The children of cells, whose vertices are points of the step that is begun.
    fn children(&mut self, level: &Level<'_>, cells: &[Cell], left: u32) -> Grown<'a> {
        let corners_of = |cell: &Cell| match level.topology.face(cell.face).len() {
            4 => (0..4, true),
            // A part of an n-gon is whole by then.
            _ => (cell.part.corner..cell.part.corner + 1, false),
        };
        let (mut corners, mut children) = (Vec::new(), Vec::new());
        for cell in cells {
            let (own, is_quad) = corners_of(cell);
            for corner in own {
                let child = if is_quad { cell.child(corner) } else { *cell };
                let face = corners.len() as u32;
                corners.push((cell.face, corner));
                children.push(Cell { face, ..child });
            }
        }
        let refined = refine(&level.topology, &corners);
        let first_point = self.points.count;
        for mask in &refined.masks {
            level.push(&mut self.points, mask);
        }
        Grown {
            cells: children,
            level: Level {
                is_irregular: vec![false; refined.topology.face_count()],
                first_point,
                left,
                topology: Cow::Owned(refined.topology),
            },
        }
    }

    /// The first level, whose B-splines are always drawn.
    fn first_level(&mut self, mut first: Grown<'a>) -> Irregular<'a> {
        let splines = mark(&mut first);
        let (of, count) = irregularities(&first.level);
        self.begin();
        let beyond = |face: u32| of[face as usize];
        self.splines(&first, &splines, [NOWHERE, 1], beyond);
        let mut cells = vec![(0, Vec::new()); count as usize];
        for cell in first.cells {
            if let Some((_, own)) = cells.get_mut(of[cell.face as usize] as usize) {
                own.push(cell);
            }
        }
        let levels = vec![first.level];
        Irregular { levels, cells }
    }

    /// Refines all irregularities once more, each by itself, for frames that go so deep there.
    fn next_level(&mut self, before: &Irregular<'_>, depth: u32) -> Irregular<'a> {
        let depths = [depth, DEEPEST];
        let (mut grown, mut ends) = (Vec::new(), Vec::new());
        self.begin();
        for (level, cells) in &before.cells {
            let left = self.deepest - depth;
            grown.push(self.children(&before.levels[*level], cells, left));
            ends.push(self.rows());
        }
        self.points.span(depths, std::mem::take(&mut ends));
        self.begin();
        for (irregularity, grown) in (0..).zip(&mut grown) {
            let splines = mark(grown);
            let own = |_: u32| irregularity;
            self.splines(grown, &splines, [irregularity, depth], own);
            ends.push(self.rows());
        }
        self.points.span(depths, ends);
        let (mut levels, mut cells) = (Vec::new(), Vec::new());
        for (number, mut own) in grown.into_iter().enumerate() {
            own.cells.retain(|cell| is_irregular(&own.level, cell));
            cells.push((number, own.cells));
            levels.push(own.level);
        }
        Irregular { levels, cells }
    }

    /// Adds the cells that are B-splines, from a depth of an irregularity on. `beyond` tells the irregularity of a face that is none.
    fn splines(
        &mut self,
        grown: &Grown<'_>,
        splines: &[Option<BsplinePatch>],
        [irregularity, depth]: [u32; 2],
        beyond: impl Fn(u32) -> u32,
    ) {
        let Grown { level, cells } = grown;
        let mut mirrored = FxHashMap::default();
        for (cell, spline) in cells.iter().zip(splines) {
            let Some(spline) = spline else { continue };
            let (controls, plan) = spline_controls(level, spline, &mut mirrored, &mut self.points);
            let record = record(self.model, level, cell, plan);
            let pass = usize::from(record.flags & (abi::PATCH_NEARBY_CORNER * 15) != 0);
            let pass = &mut self.passes[pass];
            cell.add(pass, self.model, &controls, record);
            pass.stages.push(Stage {
                irregularity,
                depths: [depth, DEEPEST],
                beside: match level.left {
                    0 => [NOWHERE; 4],
                    _ => beside(level, cell.face, &beyond),
                },
            });
        }
    }

    /// Adds the end caps of a level, for frames that go so deep and no deeper; of the last level, for all that go deeper too.
    fn caps(&mut self, irregular: &mut Irregular<'_>, depth: u32) {
        let is_last = depth == self.deepest;
        let depths = [depth, if is_last { DEEPEST } else { depth }];
        // Nothing is refined further, as they see it.
        irregular.levels.iter_mut().for_each(|level| level.left = 0);
        let mut ends = Vec::new();
        self.begin();
        for (irregularity, (level, cells)) in (0..).zip(&irregular.cells) {
            let level = &irregular.levels[*level];
            let mut caps = Caps::new(self.kind);
            for cell in cells {
                let cap = caps.of(level, cell.face, &mut self.points);
                let record = record(self.model, level, cell, 0);
                let pass = &mut self.passes[if cap.is_bicubic { 2 } else { 3 }];
                cell.add(pass, self.model, &cap.controls, record);
                pass.stages.push(Stage {
                    irregularity,
                    depths,
                    beside: [NOWHERE; 4],
                });
            }
            ends.push(self.rows());
        }
        self.points.span(depths, ends);
    }
}

/// The cells as B-splines; those that are none are irregular, and those that are refined along with one beyond a crease.
fn mark(grown: &mut Grown<'_>) -> Vec<Option<BsplinePatch>> {
    let Grown { level, cells } = grown;
    let splines = cells.iter().map(|cell| {
        let spline = bspline_patch(&level.topology, cell.face);
        level.is_irregular[cell.face as usize] |= spline.is_none();
        spline
    });
    let mut splines: Vec<Option<BsplinePatch>> = splines.collect();
    // At the last level nothing is refined.
    while level.left > 0 {
        let is_along = |(number, cell): (usize, &Cell)| {
            let is_left_behind = splines[number].is_some() && is_left_behind(level, cell.face);
            is_left_behind.then_some(number)
        };
        let along: Vec<usize> = cells.iter().enumerate().filter_map(is_along).collect();
        for &number in &along {
            splines[number] = None;
            level.is_irregular[cells[number].face as usize] = true;
        }
        if along.is_empty() {
            break;
        }
    }
    splines
}

/// Whether beyond an infinitely sharp edge, where the faces around a vertex count by themselves, a face is refined again and again towards an end of it. Below the
/// first levels vertices of both sides meet only if this one is refined as well.
fn is_left_behind(level: &Level<'_>, face: u32) -> bool {
    let topology = &level.topology;
    let is_refined_towards = |other: u32, edge: u32| {
        let vertices = topology.face(other);
        let ends = topology.edge(edge).vertices;
        let mut corners = (0..vertices.len() as u32).zip(vertices);
        vertices.len() != 4
            || bspline_patch(topology, other).is_some()
            || corners.any(|(corner, vertex)| {
                ends.contains(vertex) && corner_points(topology, other, corner).is_none()
            })
    };
    topology.face_edges(face).iter().any(|&edge| {
        let beyond = topology.edge_faces(edge).iter();
        let mut irregular = beyond.filter(|&&other| level.is_irregular[other as usize]);
        is_infinite(topology.edge(edge).sharpness)
            && irregular.any(|&other| is_refined_towards(other, edge))
    })
}

fn is_irregular(level: &Level<'_>, cell: &Cell) -> bool {
    level.is_irregular[cell.face as usize]
}

/// By face what hangs together of irregular faces by edges, and how many such there are.
fn irregularities(level: &Level<'_>) -> (Vec<u32>, u32) {
    let topology = &level.topology;
    let mut of = vec![NOWHERE; topology.face_count()];
    let mut count = 0;
    let mut next = Vec::new();
    for face in 0..topology.face_count() {
        next.extend((level.is_irregular[face] && of[face] == NOWHERE).then_some(face as u32));
        let is_new = !next.is_empty();
        while let Some(face) = next.pop() {
            of[face as usize] = count;
            let edges = topology.face_edges(face).iter();
            let beyond = edges.flat_map(|&edge| topology.edge_faces(edge)).copied();
            next.extend(
                beyond.filter(|&face| {
                    level.is_irregular[face as usize] && of[face as usize] == NOWHERE
                }),
            );
        }
        count += u32::from(is_new);
    }
    (of, count)
}

/// What is irregular beyond each edge of a face.
fn beside(level: &Level<'_>, face: u32, beyond: impl Fn(u32) -> u32) -> [u32; 4] {
    let topology = &level.topology;
    let edges = topology.face_edges(face);
    std::array::from_fn(|side| {
        let mut faces = topology.edge_faces(edges[side]).iter().copied();
        let irregular = faces.find(|&face| level.is_irregular[face as usize]);
        irregular.map_or(NOWHERE, &beyond)
    })
}
