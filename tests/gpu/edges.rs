//! No cracks between faces: both sides of an edge have the same vertices.

use std::collections::BTreeMap;

use glam::Vec3;
use hullform::gpu::{Cut, Fill};
use hullform::mesh::Model;
use hullform::method::{METHODS, Pass, Prepared, to_ptex};
use hullform::plan::PlanOptions;
use hullform::subdivision::LimitSurface;

use crate::common;
use crate::common::gpu::{Frame, Gpu, SPACINGS, capturing, cut, prepare};
use crate::shapes;

/// A line between two patches: of the control mesh, from its lower vertex on, or between two corners of an n-gon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Line {
    Edge(u32, u32),
    Inner { face: u32, corner: u32 },
}

/// Vertices along a line, each with where it stands: by face and corner, since a line may have more than two sides.
type Sides = BTreeMap<Line, BTreeMap<(u32, bool), Vec<(f32, Vec3)>>>;

struct Part<'a> {
    face: u32,
    corner: u32,
    vertices: &'a [u32],
}

impl Part<'_> {
    /// The line that (u, v) lies on, if it lies on the part's edge `edge`, and where between the line's ends.
    fn place(&self, edge: u32, [u, v]: [f32; 2]) -> Option<(Line, f32)> {
        let (off, along) = [(v, u), (1.0 - u, v), (1.0 - v, 1.0 - u), (u, 1.0 - v)][edge as usize];
        if off != 0.0 {
            return None;
        }
        let n = self.vertices.len() as u32;
        if n == 4 {
            return Some(self.edge(edge, along));
        }
        let previous = (self.corner + n - 1) % n;
        Some(match edge {
            0 => self.edge(self.corner, 0.5 * along),
            3 => self.edge(previous, 0.5 + 0.5 * along),
            // From the middle of the edge that leaves the corner to the face's centre.
            1 => (self.inner(self.corner), along),
            _ => (self.inner(previous), 1.0 - along),
        })
    }

    /// The mesh's edge that leaves a corner.
    fn edge(&self, corner: u32, along: f32) -> (Line, f32) {
        let n = self.vertices.len();
        let (a, b) = (
            self.vertices[corner as usize],
            self.vertices[(corner as usize + 1) % n],
        );
        if a < b {
            (Line::Edge(a, b), along)
        } else {
            (Line::Edge(b, a), 1.0 - along)
        }
    }

    fn inner(&self, corner: u32) -> Line {
        let face = self.face;
        Line::Inner { face, corner }
    }
}

/// Sorts the captured vertices that lie on edges by line and side.
fn sides(model: &Model, prepared: &Prepared, frame: &Frame) -> Sides {
    let numbers = LimitSurface::new(model.mesh());
    let mut sides = Sides::new();
    for (pass, vertices) in prepared.passes.iter().zip(&frame.passes) {
        for vertex in vertices {
            let (part, uv) = part(model, &numbers, pass, vertex);
            for (line, along) in (0..4).filter_map(|edge| part.place(edge, uv)) {
                // The two halves of an n-gon's edge are one side; the two sides of an inner line are two corners.
                let corner = matches!(line, Line::Inner { corner, .. } if corner == part.corner);
                let side = sides.entry(line).or_default();
                let side = side.entry((part.face, corner)).or_default();
                side.push((along, Vec3::from(vertex.position)));
            }
        }
    }
    sides
}

fn part<'a>(
    model: &'a Model,
    numbers: &LimitSurface,
    pass: &Pass,
    vertex: &hullform::abi::Captured,
) -> (Part<'a>, [f32; 2]) {
    let patch = &pass.patches[vertex.patch_number as usize];
    let (face, corner) = numbers.face_corner(patch.ptex as usize);
    let vertices = model.mesh().face(face as usize);
    let part = Part {
        face,
        corner,
        vertices,
    };
    (part, to_ptex(patch, vertex.uv))
}

/// In order along the line; what stands twice at one place (the middle of an n-gon's edge belongs to two patches) once.
fn in_order(mut side: Vec<(f32, Vec3)>, tolerance: f32, what: &str) -> Vec<(f32, Vec3)> {
    side.sort_by(|a, b| a.0.total_cmp(&b.0));
    side.dedup_by(|b, a| {
        let same = b.0 == a.0;
        assert!(
            !same || b.1.distance(a.1) <= tolerance,
            "{what}: a crack at {}",
            a.0
        );
        same
    });
    side
}

/// How far two sides may have a vertex at different places: some devices count tess coordinates in steps of 2^-16, and reach a vertex by
/// multiples of a rounded step. So a quad's 4/10 and half of an n-gon's 4/5 are not the same, up to half a step for each of 32 segments.
const COORDINATE: f32 = 16.0 / 65536.0;

/// The greatest gaps over the diagonal: where both sides have the same coordinates, and where these differ.
#[derive(Clone, Copy, Default)]
struct Gaps {
    same: f32,
    other: f32,
}

/// Compares every side of every line with the line's first.
fn compare(name: &str, model: &Model, prepared: &Prepared, frame: &Frame, gaps: &mut Gaps) {
    let diagonal = common::diagonal(model.mesh()) as f32;
    let tolerance = 1e-6 * diagonal;
    for (line, sides) in sides(model, prepared, frame) {
        let what = format!("{name} {line:?}");
        let mut sides = sides.into_values();
        let first = sides.next().expect("a line has a side");
        let first = in_order(first, tolerance, &what);
        let length: f32 = first.windows(2).map(|w| w[0].1.distance(w[1].1)).sum();
        for side in sides {
            let side = in_order(side, tolerance, &what);
            assert_eq!(side.len(), first.len(), "{what}: a T-junction");
            for (a, b) in side.iter().zip(&first) {
                let (off, gap) = ((a.0 - b.0).abs(), a.1.distance(b.1));
                assert!(off <= COORDINATE, "{what}: {} beside {}", a.0, b.0);
                // No curve here runs four times as fast as on average.
                let allowed = tolerance + 4.0 * off * length;
                assert!(gap <= allowed, "{what}: a gap of {gap} at {}", a.0);
                let worst = if off == 0.0 {
                    &mut gaps.same
                } else {
                    &mut gaps.other
                };
                *worst = worst.max(gap / diagonal);
            }
        }
    }
}

/// Plans that go less deep than the level asks for bound all patches alike, regular ones too.
#[test]
fn shallow_plans_leave_no_t_junctions() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let options = PlanOptions {
        max_level: 2,
        ..PlanOptions::default()
    };
    let prepared = (METHODS[0].prepare)(&model, options).expect("sound options");
    let cuts = SPACINGS.map(|spacing| cut(8.0, spacing));
    let workarounds = &gpu.device.info().workarounds;
    let capturing = capturing(&prepared, &cuts);
    let loaded = gpu.load(&model, prepared, workarounds, capturing);
    let mut loaded = loaded.expect("the ring holds a patch");
    for cut in cuts {
        let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
        let gaps = &mut Gaps::default();
        compare("shallow", &model, loaded.prepared(), &frame, gaps);
    }
    drop(loaded);
    gpu.finish();
}

fn mixed_meshes() -> Vec<(String, Model)> {
    let own = ["ngons", "hull"].map(|name| (name.into(), shapes::built_in(name)));
    let shared = shapes::catmark().into_iter();
    let nonquads = shared.filter(|(name, _)| name == "catmark_nonquads");
    own.into_iter().chain(nonquads).collect()
}

#[test]
fn both_sides_of_every_edge_have_the_same_vertices() {
    let Some(gpu) = Gpu::open() else { return };
    let whole = (1..=16).chain([31, 63, 64]).map(|level| level as f32);
    let levels = whole.chain([3.3, 5.7, 11.9]);
    let all: Vec<Cut> = levels
        .flat_map(|level| SPACINGS.map(|spacing| cut(level, spacing)))
        .collect();
    for (name, model) in mixed_meshes() {
        let small = model.mesh().face_count() < 200;
        let cuts: Vec<Cut> = all
            .iter()
            .copied()
            .filter(|cut| small || cut.level <= 9.0)
            .collect();
        for method in METHODS {
            let prepared = prepare(&model, method.name);
            let options = capturing(&prepared, &cuts);
            let workarounds = &gpu.device.info().workarounds;
            let loaded = gpu.load(&model, prepared, workarounds, options);
            let mut loaded = loaded.expect("the ring holds a patch");
            let mut gaps = Gaps::default();
            for &cut in &cuts {
                let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
                let what = format!("{name} {} {cut:?}", method.name);
                compare(&what, &model, loaded.prepared(), &frame, &mut gaps);
            }
            let Gaps { same, other } = gaps;
            println!(
                "{name} {}: gaps up to {same:.1e} of the diagonal, {other:.1e} between unlike coordinates",
                method.name
            );
        }
    }
    gpu.finish();
}
