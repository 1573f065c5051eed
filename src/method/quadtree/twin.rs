//! What the evaluation shaders of the method compute, on the CPU, from the same bytes and in the same order of operations.
//!
//! On its edges and at its corners a patch is not evaluated by its own plan but by those of the edges and vertices, which all faces there
//! share: that gives all of them the same bits. Twin of `glsl/method/quadtree.glsl` and `glsl/method/quadtree_regular.glsl`.

use glam::{Vec2, Vec3};
use smallvec::SmallVec;

use crate::abi;
use crate::method::quadtree::NODE_KINDS;
use crate::method::quadtree::hubs;
use crate::method::quadtree::places::place_at;
use crate::method::quadtree::view::{self, Border};
use crate::method::regular::{self, Place, exchanged, place};
use crate::method::spline::{bspline, creased};
use crate::method::surface::{Controls, Surface, SurfacePoint};
use crate::method::{Cell, Pass};
use crate::patch::bspline::Basis;
use crate::plan::{Leaf, Plans, Row, RowsView, walk};

/// A plain B-spline patch.
pub fn regular(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    regular_surface(pass, given, patch, uv).point()
}

/// Its tangents.
pub fn regular_tangents(
    pass: &Pass,
    given: &Controls,
    patch: usize,
    uv: Vec2,
    _: u32,
) -> [Vec3; 2] {
    let Surface { du, dv, .. } = regular_surface(pass, given, patch, uv);
    [du, dv]
}

fn regular_surface(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> Surface {
    let abi::Patch {
        controls, flags, ..
    } = pass.patches[patch];
    let controls = &pass.controls[controls as usize..];
    let point = |x: usize, y: usize| given.vertices[controls[x + 4 * y] as usize];
    regular::regular_surface(flags, uv, point)
}

/// A patch with a border: runs the stencils that the point needs, and evaluates it. Each plan takes its ring relative to its first
/// vertex: so sums err by what the ring's own size has for rounding, wherever it is.
pub fn irregular(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    match irregular_surface(pass, given, patch, uv) {
        Evaluated::Surface(surface) => surface.point(),
        Evaluated::Corner(corner) => corner,
    }
}

/// Its tangents. A corner has the limit and its normal, and no tangents: differences along both edges stand for them, to second order, in the limit's plane.
/// At an extraordinary vertex, where only their directions have a limit, their lengths depend on how far they reach: to the first two vertices of the
/// level.
pub fn irregular_tangents(
    pass: &Pass,
    given: &Controls,
    patch: usize,
    uv: Vec2,
    level: u32,
) -> [Vec3; 2] {
    let corner = match irregular_surface(pass, given, patch, uv) {
        Evaluated::Surface(Surface { du, dv, .. }) => return [du, dv],
        Evaluated::Corner(corner) => corner,
    };
    let nearest = 1.0 / (1u32 << level) as f32;
    let slope = |axis: Vec2, length: f32| {
        let step = if uv.dot(axis) > 0.5 { -length } else { length };
        let there = irregular(pass, given, patch, uv + step * axis);
        (there.position - corner.position) / step
    };
    [Vec2::X, Vec2::Y].map(|axis| {
        let tangent = match level {
            0 => slope(axis, nearest),
            _ => 2.0 * slope(axis, nearest) - slope(axis, 2.0 * nearest),
        };
        tangent - tangent.dot(corner.normal) * corner.normal
    })
}

/// What a point of a patch with a border is.
enum Evaluated {
    Surface(Surface),
    /// The limit of a corner, and its normal.
    Corner(SurfacePoint),
}

fn irregular_surface(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> Evaluated {
    let plans = plans(pass);
    let abi::Patch {
        controls, flags, ..
    } = pass.patches[patch];
    let border = Border::of(pass, patch);
    let mirrored = border.is_mirrored();
    let (number, uv) = match place(flags, uv) {
        Place::Inside if mirrored => (0, Vec2::new(uv.y, uv.x)),
        Place::Inside => (0, uv),
        Place::Edge(edge, t) => (
            1 + edge,
            Vec2::new(on_edge(border.used(1 + edge as usize).flags, t), 0.0),
        ),
        Place::Corner(corner) => (5 + corner, Vec2::ZERO),
    };
    let &abi::Use { flags, root, .. } = border.used(number as usize);
    let one_use = Use {
        pass,
        plans,
        border,
        controls,
        number: if flags & abi::USE_INSIDE != 0 {
            0
        } else {
            number as usize
        },
    };
    if flags & abi::USE_LIMIT != 0 {
        return Evaluated::Corner(one_use.limit(given, flags));
    }
    let side = flags >> abi::USE_SIDE_SHIFT;
    let surface = one_use.evaluate(given, root, uv, side);
    let surface = match flags & abi::USE_REFLECTED {
        0 => surface,
        _ => Surface {
            du: -surface.du,
            ..surface
        },
    };
    let Surface { position, du, dv } = if number == 0 && mirrored {
        exchanged(surface)
    } else {
        turned(surface, flags >> abi::USE_TURN_SHIFT & 3)
    };
    // Half of the edge is the whole patch.
    let half = flags & (abi::USE_FIRST_HALF | abi::USE_SECOND_HALF) != 0;
    let scale = if half { 0.5 } else { 1.0 };
    Evaluated::Surface(Surface {
        position,
        du: scale * du,
        dv: scale * dv,
    })
}

/// The kind of the node that the inside of a patch is evaluated by at (u, v); none without plans.
#[cfg(feature = "host")]
pub(crate) fn node_kind(pass: &Pass, patch: usize, uv: Vec2) -> Option<u32> {
    if pass.tables.len() <= view::BORDERS {
        return None;
    }
    Some(inside(pass, patch, uv).kind)
}

/// Where the walk of a patch's inside ends.
fn inside(pass: &Pass, patch: usize, uv: Vec2) -> Leaf {
    let border = Border::of(pass, patch);
    let uv = if border.is_mirrored() {
        Vec2::new(uv.y, uv.x)
    } else {
        uv
    };
    let leaf = walk(plans(pass), border.used(0).root, uv);
    leaf.expect("borders have the roots of packed trees")
}

/// The cell at (u, v) of a patch. Plans are numbered as they are packed, by where their rows begin; trees may be the same.
pub(super) fn cell(pass: &Pass, patch: usize, uv: Vec2) -> Option<Cell> {
    let Leaf { kind, scale, .. } = inside(pass, patch, uv);
    let all = view::rows_of_insides(pass);
    let rows = Border::of(pass, patch).used(0).rows;
    Some(Cell {
        plan: all.range(..rows).count() as u32,
        kind: *NODE_KINDS.get(kind as usize)?,
        depth: scale.log2() as u32,
    })
}

/// How many vertices of the ring of a patch bound it; none where some of what is in it is computed from others.
pub(super) fn hull_size(pass: &Pass, patch: usize) -> u32 {
    let size = Border::of(pass, patch).used(0).size;
    let first = pass.patches[patch].controls;
    let last = pass.controls[(first + size - 1) as usize];
    if hubs::is_point(last) { 0 } else { size }
}

/// Where a vertex of a ring is, or a point that is computed beforehand.
fn position(given: &Controls, named: u32) -> Vec3 {
    match hubs::is_point(named) {
        true => spoke(given, named, Vec3::ZERO),
        false => given.vertices[named as usize],
    }
}

/// From `origin` to it.
pub(super) fn spoke(given: &Controls, named: u32, origin: Vec3) -> Vec3 {
    if !hubs::is_point(named) {
        return given.vertices[named as usize] - origin;
    }
    let hub = &given.points[hubs::number_of(named) as usize];
    Vec3::from(hub.position) + (Vec3::from(hub.normal) - origin)
}

/// From along a patch's edge to along the whole edge in its own direction.
fn on_edge(flags: u32, [t, s]: [f32; 2]) -> f32 {
    let [t, s] = match () {
        () if flags & abi::USE_FIRST_HALF != 0 => [0.5 * t, 0.5 + 0.5 * s],
        () if flags & abi::USE_SECOND_HALF != 0 => [0.5 + 0.5 * t, 0.5 * s],
        () => [t, s],
    };
    if flags & abi::USE_FLIPPED != 0 { s } else { t }
}

/// Derivatives in the patch's frame, from one that is turned by so many quarters.
fn turned(Surface { position, du, dv }: Surface, quarters: u32) -> Surface {
    let (du, dv) = match quarters {
        0 => (du, dv),
        1 => (-dv, du),
        2 => (-du, -dv),
        _ => (dv, -du),
    };
    Surface { position, du, dv }
}

/// What a patch is evaluated by at some place.
pub(super) struct Use<'a> {
    pub(super) pass: &'a Pass,
    pub(super) plans: Plans<'a>,
    pub(super) border: Border<'a>,
    /// Where the patch's ring begins.
    pub(super) controls: u32,
    pub(super) number: usize,
}

impl<'a> Use<'a> {
    /// Whether it has a plan, or control vertices themselves.
    fn has_plan(&self) -> bool {
        self.border.used(self.number).size > 0
    }

    /// The vertices of its ring; of what has no plan, those that are evaluated themselves.
    pub(super) fn vertices(&self) -> impl Iterator<Item = u32> {
        let Use {
            pass,
            border,
            controls,
            number,
            ..
        } = *self;
        let &abi::Use { size, ring, .. } = border.used(number);
        let (start, size) = match size {
            0 => (border.record.plain, border.record.plain_count),
            size => (ring, size),
        };
        let is_own = number == 0 && self.has_plan();
        (0..size).map(move |i| {
            let place = if is_own {
                i
            } else {
                self.place(start, i as usize)
            };
            pass.controls[(controls + place) as usize]
        })
    }

    /// Place `i` of the list that begins at `start`.
    pub(super) fn place(&self, start: u32, i: usize) -> u32 {
        let ring = self.border.used(0).size as usize;
        place_at(ring, &self.pass.controls[start as usize..], i)
    }

    /// Stencil `number` of its plan.
    pub(super) fn stencil(&self, number: u32) -> Row<'a> {
        let row = self
            .plans
            .rows
            .row(self.border.used(self.number).rows + number);
        row.expect("plans have their stencils")
    }

    /// The vertex of a corner, which points near it are relative to.
    fn corner(&self, given: &Controls, corner: u32) -> Vec3 {
        let number = self.border.use_of_corner(corner) as usize;
        let place = self.place(self.border.used(number).ring, 0);
        position(given, self.pass.controls[(self.controls + place) as usize])
    }

    /// What its points are relative to where nothing else is said.
    pub(super) fn origin(&self, given: &Controls) -> Vec3 {
        let first = self.vertices().next();
        position(given, first.expect("a ring has vertices"))
    }

    /// The limit of a corner, and its normal.
    fn limit(&self, given: &Controls, flags: u32) -> SurfacePoint {
        let origin = self.origin(given);
        if flags & abi::USE_HUB == 0 {
            return SurfacePoint {
                position: self.point(given, 0) + origin,
                normal: self.vertex_normal(given, flags),
            };
        }
        let &abi::Use { rows, root, .. } = self.border.used(self.number);
        SurfacePoint {
            position: spoke(given, abi::HUB_POINT | rows, origin) + origin,
            normal: given.points[root as usize].normal.into(),
        }
    }

    /// The order in which stencils are summed.
    pub(super) fn order(&self, i: usize) -> usize {
        if self.number > 0 {
            return i;
        }
        self.place(self.controls + self.border.used(0).size, i) as usize
    }

    /// Point `number` of its slot.
    fn point(&self, given: &Controls, number: u32) -> Vec3 {
        let mut vertices = self.vertices();
        if !self.has_plan() {
            let vertex = vertices.nth(number as usize);
            return position(given, vertex.expect("points are the use's own"));
        }
        let ring: SmallVec<[u32; 64]> = vertices.collect();
        let row = self.stencil(number);
        let origin = match row.corner {
            abi::STENCIL_OWN => position(given, ring[0]),
            corner => self.corner(given, corner),
        };
        let places = (0..ring.len()).map(|i| self.order(i));
        let terms = places.map(|place| row.weight(place) * spoke(given, ring[place], origin));
        weighted_sum(ring.len(), terms)
    }

    fn evaluate(&self, given: &Controls, root: u32, uv: Vec2, side: u32) -> Surface {
        let leaf = walk(self.plans, root, uv);
        let leaf = leaf.expect("borders have the roots of packed trees");
        let (u, mut v) = creased(leaf.uv, leaf.edge, leaf.sharpness);
        if leaf.kind == abi::NODE_CURVE {
            v = CURVE;
        }
        let points = leaf.points + 16 * side;
        let surface = bspline(u, v, leaf.scale, |x, y| {
            let number = self.plans.point(points + x as u32 + 4 * y as u32);
            self.point(given, number.expect("leaves have their points"))
        });
        let base = match leaf.base {
            0 => Vec3::ZERO,
            number => self.point(given, number - 1),
        };
        let origin = match leaf.origin {
            0 => self.origin(given),
            abi::ORIGIN_NONE => Vec3::ZERO,
            corner => self.corner(given, corner),
        };
        Surface {
            position: (surface.position + base) + origin,
            ..surface
        }
    }
}

/// Row 1 is the position on an edge, row 2 that plus the derivative across.
const CURVE: Basis<f32> = Basis {
    value: [0.0, 1.0, 0.0, 0.0],
    derivative: [0.0, -1.0, 1.0, 0.0],
};

/// The sum of weighted points, in the manner of the control shader: rings of more than 32 vertices are summed with compensation (Kahan 1965), since
/// where hundreds of faces meet, the tangents of neighbours differ by less than a plain sum would lose.
fn weighted_sum(ring: usize, terms: impl Iterator<Item = Vec3>) -> Vec3 {
    if ring <= abi::CONTROL_INVOCATIONS as usize {
        return terms.fold(Vec3::ZERO, |sum, term| sum + term);
    }
    compensated_sum(terms)
}

/// The sum of many terms, by what rounding takes away from each step (Kahan 1965).
pub(super) fn compensated_sum(terms: impl Iterator<Item = Vec3>) -> Vec3 {
    let (mut sum, mut lost) = (Vec3::ZERO, Vec3::ZERO);
    for term in terms {
        let rest = term - lost;
        let next = sum + rest;
        lost = (next - sum) - rest;
        sum = next;
    }
    sum
}

pub(super) fn plans(pass: &Pass) -> Plans<'_> {
    Plans {
        nodes: bytemuck::cast_slice(&pass.tables[view::NODES]),
        points: &pass.tables[view::POINTS],
        rows: RowsView {
            rows: bytemuck::cast_slice(&pass.tables[view::ROWS]),
            sets: bytemuck::cast_slice(&pass.tables[view::SETS]),
            patterns: &pass.tables[view::PATTERNS],
        },
    }
}
