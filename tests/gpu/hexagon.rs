//! Methods that promise the limit at six places of a triangle: positions and normals there, from the device.

use glam::{DVec3, Vec3};
use hullform::gpu::Fill;
use hullform::mesh::{Model, Placement, Scheme, builtin};
use hullform::method::{METHODS, Method, Prepared, Reproduces, is_on_hexagon};
use hullform::subdivision::{
    Blend, LimitSurface, Mask, Refinement, deep_limit, is_cusp, refine_all, vertex_limit,
};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, capturing, cut, prepare};
use crate::common::{self, fan_at};
use crate::shapes;

/// Where the six places of a triangle are: corners, then the middles of the edges from corner i to corner i + 1.
const PLACES: [[f64; 2]; 6] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [0.5, 0.0],
    [0.5, 0.5],
    [0.0, 0.5],
];

/// The greatest error of a position, over the diagonal.
const FAR: f64 = 1e-6;

/// Half of the distance from 1 to the next float.
const U: f64 = 1.0 / (1u64 << 24) as f64;

/// What is right at a place.
#[derive(Clone, Copy)]
struct Right {
    position: DVec3,
    /// Zero where there is none.
    normal: DVec3,
    /// The greatest angle to it that rounding explains.
    turned: f64,
}

/// What a method has at a place of a face.
#[derive(Clone, Copy)]
struct Found {
    face: u32,
    place: usize,
    position: Vec3,
    normal: Vec3,
}

/// The truth of a model, and its mesh refined once.
struct Truth {
    surface: LimitSurface,
    /// The same with its mesh refined.
    finer: LimitSurface,
    refined: Refinement,
    scheme: Scheme,
    placement: Placement,
    /// In local units.
    diagonal: f64,
}

impl Truth {
    fn new(model: &Model) -> Truth {
        let scheme = model.mesh().options().scheme;
        let surface = LimitSurface::new(model.mesh());
        Truth {
            finer: surface.refined(),
            surface,
            refined: refine_all(model.topology(), scheme),
            scheme,
            placement: model.placement(),
            diagonal: model.diagonal(),
        }
    }

    fn at(&self, face: u32, place: usize) -> Right {
        let [u, v] = PLACES[place];
        let sample = self.surface.evaluate(face as usize, u, v);
        let sample = sample.expect("holes are not drawn");
        let topology = self.surface.topology();
        let (mut normal, mut turned) = (sample.normal(), self.turned(face, place));
        let corner = place as u32;
        if place < 3 && is_cusp(topology, face, corner) {
            // Each face has a normal of its own, and a method the mean of those between two infinite creases.
            let vertex = topology.face(face)[place];
            let around = fan_at(topology, face, corner).faces;
            let each = around.iter().map(|&face| {
                let corner = topology.face(face).iter().position(|&v| v == vertex);
                let corner = corner.expect("the fan is the vertex' own");
                let [u, v] = PLACES[corner];
                let sample = self.surface.evaluate(face as usize, u, v);
                let normal = sample.map_or(DVec3::ZERO, |sample| sample.normal());
                (normal, self.turned(face, corner))
            });
            let (sum, bounds) = each.fold((DVec3::ZERO, 0.0), |(sum, bounds), (normal, bound)| {
                (sum + normal, bounds + bound)
            });
            normal = sum.normalize_or_zero();
            turned = bounds / sum.length() + 16.0 * U;
        }
        Right {
            position: sample.position,
            normal,
            turned,
        }
    }

    /// How far rounding may turn a normal. A tangent is a sum of n weighted vertices: weights, vertices, products and n - 1 sums round, so it errs by
    /// (n + 2) u times the sum of all magnitudes, to first order. That over its length is an angle; of a cross product both angles count, and 16 u for
    /// unit vectors and products, over the sine between the tangents. Interpolation takes 16 u more.
    ///
    /// Where no mask is known, a method's tangents come of 20 refinements and the truth's of 26. That is a few 2^-20, and what the truth itself still
    /// turns by in so many refinements, or from face to face: at some boundary vertices of the butterfly both tangents go on turning into one
    /// direction, and there is no tangent plane.
    fn turned(&self, face: u32, place: usize) -> f64 {
        let (child, corner) = match place {
            0..3 => (place, place),
            _ => (3, (place + 2) % 3),
        };
        let (child, corner) = (4 * face + child as u32, corner as u32);
        let topology = &self.refined.topology;
        let known = vertex_limit(topology, self.scheme, child, corner).is_some();
        let limit = deep_limit(topology, self.scheme, child, corner);
        let limit = limit.expect("children have three corners");
        let mut angles = 0.0;
        let mut directions = [DVec3::ZERO; 2];
        for (tangent, direction) in [&limit.du, &limit.dv].into_iter().zip(&mut directions) {
            let terms = Mask::blend(tangent, &self.refined.masks);
            let at = |vertex: u32| self.placement.local(self.surface.position(vertex));
            let sum: DVec3 = terms.iter().map(|&(v, w)| w * at(v)).sum();
            let magnitude: f64 = terms.iter().map(|&(v, w)| (w * at(v)).length()).sum();
            angles += (terms.len() + 2) as f64 * U * magnitude / sum.length();
            *direction = sum.normalize_or_zero();
        }
        let [a, b] = directions;
        let rounded = (angles + 16.0 * U) / a.cross(b).length() + 16.0 * U;
        if known {
            return rounded;
        }
        let normal = |surface: &LimitSurface, face: u32, place: usize| {
            let [u, v] = PLACES[place];
            let sample = surface.evaluate(face as usize, u, v);
            sample.map(|sample| sample.normal())
        };
        let own = normal(&self.surface, face, place).expect("holes are not drawn");
        let vertex = topology.face(child)[corner as usize];
        let around = fan_at(topology, child, corner).faces;
        let turns = around.iter().filter_map(|&face| {
            let corner = topology.face(face).iter().position(|&v| v == vertex);
            let other = normal(&self.finer, face, corner.expect("it is in the fan"));
            Some(angle(own, other?))
        });
        let turns = turns.fold(0.0, f64::max);
        rounded + 8.0 / f64::from(1 << 20) / a.cross(b).length() + 8.0 * turns
    }

    /// Whether a place is as it should be. Where there is hardly a tangent plane, a normal may be any.
    fn holds(&self, found: &Found, greatest: &mut Greatest) -> bool {
        let right = self.at(found.face, found.place);
        let position = self.placement.local(right.position);
        let far = found.position.as_dvec3().distance(position) / self.diagonal;
        let normal = found.normal.as_dvec3();
        let has_normal = right.normal != DVec3::ZERO && right.turned < 0.01;
        let turned = match has_normal {
            true => normal
                .cross(right.normal)
                .length()
                .atan2(normal.dot(right.normal)),
            false => 0.0,
        };
        let share = if has_normal {
            turned / right.turned
        } else {
            0.0
        };
        greatest.far = greatest.far.max(far);
        greatest.turned = greatest.turned.max(turned);
        greatest.share = greatest.share.max(share);
        greatest.places += 1;
        greatest.normals += usize::from(has_normal);
        far <= FAR && share <= 1.0
    }
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// The greatest errors seen.
#[derive(Debug, Default)]
struct Greatest {
    far: f64,
    /// In radians.
    turned: f64,
    /// Of what rounding may do.
    share: f64,
    places: usize,
    normals: usize,
}

/// The methods that make the promise.
fn promising() -> impl Iterator<Item = &'static Method> {
    METHODS
        .iter()
        .filter(|method| matches!(method.contract.reproduces, Reproduces::LimitOnHexagon(_)))
}

/// All six places of every triangle that is drawn, from the device at level 2, which has them and the triangle's centre.
fn captured(gpu: &Gpu, model: &Model, method: &Method) -> Vec<Found> {
    let prepared = prepare(model, method.name);
    let at = cut(2.0, Spacing::Equal);
    let options = capturing(&prepared, &[at]);
    let loaded = gpu.load(model, prepared, &gpu.device.info().workarounds, options);
    let mut loaded = loaded.expect("nothing needs the ring");
    let frame = loaded.capture(at, Fill::Discard).expect("it is drawn");
    let mut all = Vec::new();
    for (pass, vertices) in loaded.prepared().passes.iter().zip(&frame.passes) {
        let on_hexagon = vertices.iter().filter(|vertex| is_on_hexagon(vertex.uv));
        let found: Vec<Found> = on_hexagon
            .map(|vertex| Found {
                face: pass.patches[vertex.patch_number as usize].ptex,
                place: place(vertex.uv),
                position: vertex.position.into(),
                normal: vertex.normal.into(),
            })
            .collect();
        assert_eq!(found.len(), 6 * pass.patches.len());
        all.extend(found);
    }
    all
}

fn place(uv: [f32; 2]) -> usize {
    let place = PLACES.iter().position(|place| uv.map(f64::from) == *place);
    place.expect("it is on the hexagon")
}

/// Closed, bounded and creased meshes, extraordinary vertices of valence 3 to 18, and models.
fn models() -> Vec<(String, Model)> {
    let poles = (3..=18).map(|n| format!("pole-{n}"));
    let poles = poles.map(|name| (name.clone(), builtin(&name).expect("it is built in")));
    let whole = ["bigguy", "monsterfrog"].into_iter();
    let whole = whole.filter_map(|name| Some((name.to_owned(), common::model(name)?)));
    let both = poles.chain(whole).flat_map(|(name, mesh)| {
        [Scheme::Loop, Scheme::Butterfly]
            .map(|scheme| Some((format!("{name} {scheme}"), shapes::under(&mesh, scheme)?)))
    });
    shapes::triangular()
        .into_iter()
        .chain(both.flatten())
        .collect()
}

#[test]
fn triangles_pass_through_six_limits_with_their_normals() {
    let Some(gpu) = Gpu::open() else { return };
    let mut all = Greatest::default();
    for (name, model) in models() {
        let truth = Truth::new(&model);
        for method in promising() {
            let found = captured(&gpu, &model, method);
            // The truth takes its time: of large meshes every so many.
            let step = (found.len() / 1000) | 1;
            let mut greatest = Greatest::default();
            for found in found.iter().step_by(step) {
                let (face, place) = (found.face, found.place);
                assert!(
                    truth.holds(found, &mut greatest),
                    "{name} {}: place {place} of face {face}: {greatest:?}",
                    method.name
                );
            }
            println!("{name:40} {greatest:?}");
            all.places += greatest.places;
            all.normals += greatest.normals;
        }
    }
    // Where a bound says nothing there is little: folds, and faces without area.
    assert!(all.places > 10_000, "{all:?}");
    assert!(all.normals * 10 > all.places * 9, "{all:?}");
    gpu.finish();
}

/// The paper's listing: the corners that belong to u, v and 1 - u - v, and the three edge vertices that it is given.
fn printed(h: [Vec3; 6], [u, v]: [f32; 2], corners: [usize; 3], edges: [usize; 3]) -> Vec3 {
    let edge = |e: Vec3, a: Vec3, b: Vec3| (4.0 * e - a - b) * 0.5;
    let [p0, p1, p2] = corners.map(|corner| h[corner]);
    let [e0, e1, e2] = edges.map(|edge| h[3 + edge]);
    let w = 1.0 - u - v;
    let (n110, n101, n011) = (edge(e0, p0, p1), edge(e2, p0, p2), edge(e1, p1, p2));
    w * (p0 * w + n110 * 2.0 * u) + u * (p1 * u + n011 * 2.0 * v) + v * (p2 * v + n101 * 2.0 * w)
}

/// How many triangles a version of the listing gets wrong, of how many.
fn wrong(model: &Model, corners: [usize; 3], edges: [usize; 3]) -> [usize; 2] {
    let truth = Truth::new(model);
    let method = promising().next().expect("there is such a method");
    let prepared: Prepared = prepare(model, method.name);
    let points = prepared.controls(model.positions()).points;
    let pass = &prepared.passes[0];
    let is_wrong = |patch: &&hullform::abi::Patch| {
        let controls = &pass.controls[patch.controls as usize..][..6];
        let of = |part: fn(&hullform::abi::Point) -> [f32; 3]| -> [Vec3; 6] {
            std::array::from_fn(|i| part(&points[controls[i] as usize]).into())
        };
        let (positions, normals) = (of(|point| point.position), of(|point| point.normal));
        let holds = |place: usize| {
            let uv = PLACES[place].map(|x| x as f32);
            let found = Found {
                face: patch.ptex,
                place,
                position: printed(positions, uv, corners, edges),
                normal: printed(normals, uv, corners, edges).normalize_or_zero(),
            };
            truth.holds(&found, &mut Greatest::default())
        };
        !(0..6).all(holds)
    };
    let wrong = pass.patches.iter().filter(is_wrong).count();
    [wrong, pass.patches.len()]
}

/// Without this, that the device holds would prove nothing. The listing gives the vertex of an edge twice (`pe0, pe2, pe2`); mended, it holds; and
/// it fails again where u belongs to another corner.
#[test]
fn the_printed_listing_is_found_out() {
    let mesh = builtin("pole-7").expect("it is built in");
    for scheme in [Scheme::Loop, Scheme::Butterfly] {
        let model = shapes::under(&mesh, scheme).expect("it has no tags");
        let [wrong_as_printed, all] = wrong(&model, [0, 1, 2], [0, 2, 2]);
        assert_eq!(wrong_as_printed, all, "{scheme}");
        assert_eq!(wrong(&model, [0, 1, 2], [0, 1, 2]), [0, all], "{scheme}");
        assert_eq!(wrong(&model, [1, 2, 0], [1, 2, 0]), [all, all], "{scheme}");
    }
}
