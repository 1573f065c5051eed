//! Several faces as one patch (Brainerd et al. 2016, section 7.3): a grid of cells, each of which is evaluated as its face is when it is drawn alone, by the
//! same numbers in the same order, and so with the same bits. Twin of `glsl/lib/macro_face.glsl`, `glsl/lib/macro_regular.glsl`,
//! `glsl/method/quadtree_quartets.glsl`, `glsl/method/quadtree_grids.glsl` and `glsl/method/quadtree_rectangles.glsl`, or
//! `glsl/method/quadtree_rectangles_cached.glsl`.
//!
//! Rectangles of regular faces alone have shaders of their own, without a ring: machines that run invocations abreast go both ways where some need one and some the
//! other, and control shaders through all that any might compute.
//!
//! The patches of the faces stand behind those of the macro faces, in slots of which nothing is drawn; what a pass has for its patches, tables, texture and
//! rings, is there for them as well. Regular cells share one grid of control vertices, with one more around the cells; where no regular cell needs a
//! vertex of it, it is any.
//!
//! **Where a vertex is.** A side of n cells at level f has f n segments, and (u, v) times n need not be exact. Tessellators count whole steps of 2^-16 (Direct3D
//! 11.3 functional specification, section 14.3), and so do we within a cell: vertex k of f is at the step nearest to k / f, which is exact where f is a power of
//! two, and so are the steps from the other end. Its (u, v) is (cell + step) / n, rounded: three roundings away from it, less than half a step as
//! long as 3 n 2^-24 < 2^-17. That holds up to n = 42, and there are 32 at most; so the nearest step is the one that was meant.
//!
//! Beside an n-gon a side has the vertices of two halves, at halves of steps. Such a side is one edge, n = 1, and what is divided by 1 is exact as it is.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::abi;
use crate::mesh::Model;
use crate::mesh::topology::FaceCorner;
use crate::method::macro_faces::MacroFace;
use crate::method::pass::Bounds;
use crate::method::ptex::to_ptex_tangents;
use crate::method::quadtree::twin;
use crate::method::regular::regular_surface;
use crate::method::surface::{Controls, Surface, SurfacePoint};
use crate::method::{Cell, MacroFaces, Pass};
use crate::tessellation::{Domain, cells};

/// Where patches of single faces are: the pass and the slot, by face.
type Places = Vec<Option<(usize, usize)>>;

/// The passes of single faces with some of these drawn together: regular patches, those with short rings, those with long ones, and then macro faces.
/// Rectangles with a face whose ring is long stay single faces: all rings of a pass are of one kind.
pub fn aggregated(mut passes: Vec<Pass>, model: &Model, faces: MacroFaces) -> Vec<Pass> {
    let places = places(&passes, model);
    let is_apart = |cell: &FaceCorner| {
        let place = places[cell.face as usize];
        place.is_none_or(|(pass, _)| pass > SHORT)
    };
    let mut found = faces.find(model);
    found.retain(|one| one.cells.len() > 1 && !one.cells.iter().any(is_apart));
    let is_plain = |one: &MacroFace| {
        let mut cells = one.cells.iter();
        cells.all(|cell| places[cell.face as usize].is_some_and(|(pass, _)| pass == REGULAR))
    };
    let (plain, mixed): (Vec<&MacroFace>, Vec<&MacroFace>) =
        found.iter().partition(|one| is_plain(one));
    let plain_kind = match faces {
        MacroFaces::Quartets => Kind::Quartets,
        _ => Kind::Grids,
    };
    let together = [(plain, plain_kind), (mixed, Kind::Rectangles)]
        .map(|(found, kind)| kind.pass(&passes, model, &found, &places));
    let mut kept: Vec<Vec<bool>> = passes
        .iter()
        .map(|pass| vec![true; pass.patches.len()])
        .collect();
    for cell in found.iter().flat_map(|one| &one.cells) {
        if let Some((pass, slot)) = places[cell.face as usize] {
            kept[pass][slot] = false;
        }
    }
    for (pass, kept) in passes.iter_mut().zip(kept) {
        let mut slots = kept.iter();
        pass.patches.retain(|_| slots.next() == Some(&true));
        let mut slots = kept.iter();
        pass.texture.retain(|_| slots.next() == Some(&true));
        for patch in &mut pass.patches {
            patch.flags |= abi::PATCH_COUNTED;
        }
    }
    passes.extend(together);
    passes
}

/// Among the passes of single faces, those of regular patches and of patches with short rings.
const REGULAR: usize = 0;
const SHORT: usize = 1;

fn places(passes: &[Pass], model: &Model) -> Places {
    let mut places = vec![None; model.topology().face_count()];
    let offsets = model.mesh().ptex_offsets();
    for (number, pass) in passes.iter().enumerate() {
        for (slot, patch) in pass.patches.iter().enumerate() {
            // Those before it that begin at the same number are removed faces.
            let face = offsets.partition_point(|&first| first <= patch.ptex) - 1;
            if model.topology().face(face as u32).len() == 4 {
                places[face] = Some((number, slot));
            }
        }
    }
    places
}

/// How macro faces are drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Regular faces, whose vertices go through the vertex shader.
    Quartets,
    /// Regular faces, whose vertices are too many for that.
    Grids,
    /// Some with plans.
    Rectangles,
}

impl Kind {
    /// The pass of some macro faces.
    fn pass(self, passes: &[Pass], model: &Model, found: &[&MacroFace], places: &Places) -> Pass {
        let (shader, control_points) = match self {
            Kind::Quartets => ("quadtree_quartets", QUARTET_VERTICES),
            Kind::Grids => ("quadtree_grids", 1),
            Kind::Rectangles => ("quadtree_rectangles", 1),
        };
        let short = &passes[SHORT];
        let mut pass = Pass {
            max_level: short.max_level,
            face_at: Some(face_at),
            bounds: Some(bounds),
            tangents: Some(tangents),
            cell: Some(cell),
            ..Pass::new(shader, Domain::Quads, control_points, point)
        };
        if self == Kind::Rectangles && !found.is_empty() {
            pass.cached = Some("quadtree_rectangles_cached");
            pass.controls = short.controls.clone();
            pass.tables = short.tables.clone();
            pass.scratch_points = short.scratch_points.clone();
            pass.scratch_products = short.scratch_products.clone();
        }
        self.fill(&mut pass, passes, model, found, places);
        pass
    }

    /// Fills in its macro faces, and their cells behind them.
    fn fill(
        self,
        pass: &mut Pass,
        passes: &[Pass],
        model: &Model,
        found: &[&MacroFace],
        places: &Places,
    ) {
        pass.patches.resize(found.len(), abi::Patch::default());
        pass.texture.resize(found.len(), Default::default());
        for (number, one) in found.iter().enumerate() {
            let first = pass.patches.len() as u32;
            for (place, at) in one.cells.iter().enumerate() {
                let (own, slot) =
                    places[at.face as usize].expect("macro faces are of faces that are drawn");
                let record = passes[own].patches[slot];
                pass.patches.push(abi::Patch {
                    flags: record.flags | abi::PATCH_VACANT,
                    ..record
                });
                let place = place as u32;
                let place = [place % one.columns, place / one.columns];
                let texture = match model.mesh().texture() {
                    Some(_) => passes[own].texture[slot],
                    None => grid_texture(place, turn(&record, at)),
                };
                pass.texture.push(texture);
            }
            let block = Block {
                one,
                first,
                passes,
                places,
            };
            let plan = pass.scratch_points.len() as u32;
            if self == Kind::Rectangles {
                block.add_sums(pass);
            }
            let [w, h] = [one.columns as f32, one.rows as f32];
            pass.texture[number] = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]];
            pass.patches[number] = block.record(pass, plan);
            let words = block.words(pass);
            pass.controls.extend(words);
        }
    }
}

/// Five by five.
const QUARTET_VERTICES: u32 = 25;

/// The corner of a face's own patch that is at the (0, 0) of a cell.
fn turn(record: &abi::Patch, at: &FaceCorner) -> u32 {
    (at.corner + 4 - (record.flags >> abi::PATCH_TURN_SHIFT & 3)) % 4
}

/// Where the mesh has no texture coordinates, those of ptex faces go on over the whole macro face: no vertex in it has two.
fn grid_texture([i, j]: [u32; 2], turn: u32) -> [[f32; 2]; 4] {
    std::array::from_fn(|corner| {
        let [u, v] = [[0, 0], [1, 0], [1, 1], [0, 1]][(corner + 4 - turn as usize) % 4];
        [(i + u) as f32, (j + v) as f32]
    })
}

/// What is written down of a macro face.
struct Block<'a> {
    one: &'a MacroFace,
    /// The slot of its first cell.
    first: u32,
    passes: &'a [Pass],
    places: &'a Places,
}

impl Block<'_> {
    fn size(&self) -> [u32; 2] {
        [self.one.columns, self.one.rows]
    }

    fn cells<'p>(&self, pass: &'p Pass) -> &'p [abi::Patch] {
        &pass.patches[self.first as usize..][..self.one.cells.len()]
    }

    /// Its patch. A side has an even number of segments where an n-gon lies beyond; such a side is one edge.
    fn record(&self, pass: &Pass, plan: u32) -> abi::Patch {
        let [w, h] = self.size();
        let mut flags = abi::PATCH_MACRO
            | (w - 1) << abi::MACRO_COLUMNS_SHIFT
            | (h - 1) << abi::MACRO_ROWS_SHIFT;
        let mut valences = [0; 4];
        let corners = [[0, 0], [w - 1, 0], [w - 1, h - 1], [0, h - 1]];
        for (edge, [i, j]) in (0u32..).zip(corners) {
            let place = (i + w * j) as usize;
            let cell = self.cells(pass)[place];
            let own = (edge + turn(&cell, &self.one.cells[place])) % 4;
            valences[edge as usize] = cell.valences.to_le_bytes()[own as usize];
            if cell.flags & abi::PATCH_EVEN_EDGE << own != 0 {
                flags |= abi::PATCH_EVEN_EDGE << edge;
            }
        }
        abi::Patch {
            ptex: self.cells(pass)[0].ptex,
            flags,
            controls: pass.controls.len() as u32,
            plan,
            valences: u32::from_le_bytes(valences),
        }
    }

    /// What its patch points at, see `MACRO_HEADER`.
    fn words(&self, pass: &Pass) -> Vec<u32> {
        let [w, h] = self.size();
        let one_over = |n: u32| (1.0 / n as f32).to_bits();
        let cells = self.cells(pass);
        let planned = cells.iter().filter(|cell| has_plan(cell)).count() as u32;
        let mut grid = vec![0; ((w + 3) * (h + 3)) as usize];
        let mut turns = Vec::with_capacity(cells.len());
        let mut with_plans = Vec::new();
        let mut before = 0;
        for ((place, cell), at) in (0u32..).zip(cells).zip(&self.one.cells) {
            let turn = turn(cell, at);
            turns.push(before | turn << abi::MACRO_TURN_SHIFT);
            if has_plan(cell) {
                before += 1;
                with_plans.push(self.first + place);
                continue;
            }
            let (own, slot) = self.places[at.face as usize].expect("its patch was found");
            let first = self.passes[own].patches[slot].controls as usize;
            let steps = Steps::new(w + 3, [place % w, place / w], turn);
            for (i, &vertex) in self.passes[own].controls[first..first + 16]
                .iter()
                .enumerate()
            {
                grid[steps.place(i % 4, i / 4)] = vertex;
            }
        }
        let header = [self.first, one_over(w), one_over(h), planned];
        let words = header.into_iter().chain(grid).chain(turns);
        words.chain(with_plans).collect()
    }

    /// Adds what its points take: a word for each cell with a plan, where its slot begins, and these.
    fn add_sums(&self, pass: &mut Pass) {
        let mut points = [0; abi::HIGHEST_LEVEL as usize + 1];
        let mut products = [0; abi::HIGHEST_LEVEL as usize + 1];
        for cell in self.cells(pass).iter().filter(|cell| has_plan(cell)) {
            let plan = cell.plan as usize;
            for level in 0..points.len() {
                points[level] += 1 + pass.scratch_points[plan][level];
                products[level] += pass.scratch_products[plan][level];
            }
        }
        pass.scratch_points.push(points);
        pass.scratch_products.push(products);
    }
}

/// Whether a cell is evaluated by a plan: it has a ring.
fn has_plan(cell: &abi::Patch) -> bool {
    cell.flags >> abi::PATCH_RING_SHIFT & 63 != 0
}

/// Whether a cache has points of a patch: of macro faces their cells have them.
pub(super) fn has_points(pass: &Pass, patch: usize) -> bool {
    let record = &pass.patches[patch];
    match pass.face_at {
        None => !pass.is_vacant(patch),
        Some(_) => record.flags & abi::PATCH_VACANT != 0 && has_plan(record),
    }
}

/// The cells of a macro face of one row or column: across these there are two segments at least, whatever their level. None of any other patch.
pub(super) fn single_row(pass: &Pass, patch: usize) -> Range<usize> {
    let is_row = cells(&pass.patches[patch]).contains(&1);
    match pass.faces_of(patch) {
        faces if is_row && faces.len() > 1 => faces,
        _ => 0..0,
    }
}

/// Where the control vertices of a regular face are in the grid: from the first, how far it is to the next along its own u and v.
struct Steps {
    first: i32,
    right: i32,
    up: i32,
}

impl Steps {
    fn new(pitch: u32, [i, j]: [u32; 2], turn: u32) -> Steps {
        let (pitch, origin) = (pitch as i32, (i + pitch * j) as i32);
        let (first, right, up) = match turn {
            0 => (0, 1, pitch),
            1 => (3 * pitch, -pitch, 1),
            2 => (3 + 3 * pitch, -1, -pitch),
            _ => (3, pitch, -1),
        };
        Steps {
            first: origin + first,
            right,
            up,
        }
    }

    fn place(&self, x: usize, y: usize) -> usize {
        (self.first + x as i32 * self.right + y as i32 * self.up) as usize
    }
}

/// Which cell has a point, and where in the face's own patch. Twin of `CellPlace`.
struct CellPlace {
    /// The cell's column and row.
    at: [u32; 2],
    /// Its slot.
    slot: usize,
    turn: u32,
    uv: Vec2,
}

impl CellPlace {
    fn of(pass: &Pass, patch: usize, uv: Vec2) -> CellPlace {
        let record = &pass.patches[patch];
        let [w, h] = cells(record);
        let along = |t: f32, cells: u32| {
            // Its vertices are exact, and beside an n-gon they are at half steps.
            if cells == 1 {
                return (0, t);
            }
            let steps = (t * cells as f32 * abi::MACRO_STEPS as f32).round_ties_even() as u32;
            let cell = (steps / abi::MACRO_STEPS).min(cells - 1);
            let rest = (steps - cell * abi::MACRO_STEPS) as f32;
            (cell, rest * (1.0 / abi::MACRO_STEPS as f32))
        };
        let ((i, u), (j, v)) = (along(uv.x, w), along(uv.y, h));
        let block = &pass.controls[record.controls as usize..];
        let grid = abi::MACRO_HEADER + (w + 3) * (h + 3);
        let turn = block[(grid + i + w * j) as usize] >> abi::MACRO_TURN_SHIFT & 3;
        CellPlace {
            at: [i, j],
            slot: (block[0] + i + w * j) as usize,
            turn,
            uv: match turn {
                0 => Vec2::new(u, v),
                1 => Vec2::new(1.0 - v, u),
                2 => Vec2::new(1.0 - u, 1.0 - v),
                _ => Vec2::new(v, 1.0 - u),
            },
        }
    }

    /// The surface of a cell that is one B-spline.
    fn regular(&self, pass: &Pass, given: &Controls, patch: usize) -> Surface {
        let record = &pass.patches[patch];
        let [w, _] = cells(record);
        let grid = &pass.controls[(record.controls + abi::MACRO_HEADER) as usize..];
        let steps = Steps::new(w + 3, self.at, self.turn);
        let point = |x, y| given.vertices[grid[steps.place(x, y)] as usize];
        regular_surface(pass.patches[self.slot].flags, self.uv, point)
    }
}

/// What bounds a macro face: all that bounds its cells. Rings begin with the vertices of their face.
fn bounds(pass: &Pass, patch: usize) -> Bounds {
    let record = &pass.patches[patch];
    let [w, h] = cells(record);
    let block = &pass.controls[record.controls as usize..];
    let grid = &block[abi::MACRO_HEADER as usize..];
    let (mut own, mut all) = (Vec::new(), Vec::new());
    let mut splines = Vec::new();
    for place in 0..w * h {
        let slot = (block[0] + place) as usize;
        if has_plan(&pass.patches[slot]) {
            let first = pass.patches[slot].controls as usize;
            let ring = &pass.controls[first..first + twin::hull_size(pass, slot) as usize];
            let Some(corners) = ring.get(..4) else {
                return Bounds::default();
            };
            own.extend_from_slice(corners);
            all.extend_from_slice(ring);
            continue;
        }
        let steps = Steps::new(w + 3, [place % w, place / w], 0);
        let spline = std::array::from_fn(|i| grid[steps.place(i % 4, i / 4)]);
        own.extend([5, 6, 9, 10].map(|i| spline[i]));
        all.extend_from_slice(&spline);
        splines.push(spline);
    }
    if splines.len() < (w * h) as usize {
        splines.clear();
    }
    let own: BTreeSet<u32> = own.into_iter().collect();
    let others: BTreeSet<u32> = all.into_iter().filter(|one| !own.contains(one)).collect();
    Bounds {
        vertices: own.iter().chain(&others).copied().collect(),
        own: own.len(),
        splines,
    }
}

fn face_at(pass: &Pass, patch: usize, uv: Vec2) -> (usize, Vec2) {
    let place = CellPlace::of(pass, patch, uv);
    (place.slot, place.uv)
}

fn point(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let place = CellPlace::of(pass, patch, uv);
    match has_plan(&pass.patches[place.slot]) {
        true => twin::irregular(pass, given, place.slot, place.uv),
        false => place.regular(pass, given, patch).point(),
    }
}

fn tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, level: u32) -> [Vec3; 2] {
    let place = CellPlace::of(pass, patch, uv);
    let record = &pass.patches[place.slot];
    let own = match has_plan(record) {
        true => twin::irregular_tangents(pass, given, place.slot, place.uv, level),
        false => {
            let Surface { du, dv, .. } = place.regular(pass, given, patch);
            [du, dv]
        }
    };
    to_ptex_tangents(record, own)
}

fn cell(pass: &Pass, patch: usize, uv: Vec2) -> Option<Cell> {
    let place = CellPlace::of(pass, patch, uv);
    let is_planned = has_plan(&pass.patches[place.slot]);
    is_planned.then(|| twin::cell(pass, place.slot, place.uv))?
}
