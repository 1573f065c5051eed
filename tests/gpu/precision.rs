//! How far captured vertices are from where they should be.

use glam::{DVec3, Vec2, Vec3};
use hullform::abi::Captured;
use hullform::mesh::Model;
use hullform::method::{Method, Pass, Prepared, Reproduces, to_ptex};
use hullform::subdivision::{LimitSurface, Scheme};

use crate::common::gpu::Frame;

/// The greatest deviations seen: positions over the diagonal, normals in degrees.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    pub position: f64,
    pub normal: f64,
}

impl Worst {
    pub fn take(&mut self, other: Worst) {
        self.position = self.position.max(other.position);
        self.normal = self.normal.max(other.normal);
    }

    fn add(&mut self, position: f64, normal: f64) {
        self.take(Worst { position, normal });
    }
}

/// Against the CPU's twin, every `step`th vertex.
pub fn from_twin(model: &Model, prepared: &Prepared, frame: &Frame, step: usize) -> Worst {
    let controls = prepared.controls(model.positions());
    let diagonal = model.diagonal();
    let mut worst = Worst::default();
    for (pass, vertex) in sampled(prepared, frame, step) {
        let uv = Vec2::from(vertex.uv);
        let twin = pass.evaluate(&controls, vertex.patch_number as usize, uv);
        let distance = Vec3::from(vertex.position).distance(twin.position);
        let angle = degrees(vertex.normal, twin.normal.as_dvec3());
        worst.add(f64::from(distance) / diagonal, angle);
    }
    worst
}

/// Against the truth of a method's contract (linear faces where it promises no limit), every `step`th vertex. Of one that promises the limit on
/// a lattice only the vertices there, and no normals; none of end caps.
pub fn from_truth(
    model: &Model,
    method: &Method,
    prepared: &Prepared,
    frame: &Frame,
    step: usize,
) -> Worst {
    let own = model.mesh().options().scheme;
    let on_lattice = matches!(method.contract.reproduces, Reproduces::LimitOnLattice(_));
    let scheme = match method.contract.reproduces {
        Reproduces::Limit(_) | Reproduces::LimitOnLattice(_) | Reproduces::LimitBesideCaps(_) => {
            own
        }
        Reproduces::Faces(_) if own == Scheme::CatmullClark => Scheme::Bilinear,
        // No truth in f64, or in few places, which have a test of their own: the twin will do.
        Reproduces::LimitOnHexagon(_) | Reproduces::Faces(_) | Reproduces::Itself => {
            return from_twin(model, prepared, frame, step);
        }
    };
    let truth = LimitSurface::of_scheme(model.mesh(), scheme).expect("it takes the mesh");
    let diagonal = model.diagonal();
    let mut worst = Worst::default();
    for (pass, vertex) in sampled(prepared, frame, step) {
        if on_lattice && !pass.is_on_lattice(vertex.uv) {
            continue;
        }
        // End caps are held to the twin.
        if pass.caps {
            continue;
        }
        let patch = &pass.patches[vertex.patch_number as usize];
        let [u, v] = to_ptex(patch, vertex.uv).map(f64::from);
        let sample = truth.evaluate(patch.ptex as usize, u, v);
        let sample = sample.expect("holes are not drawn");
        let position = Vec3::from(vertex.position).as_dvec3();
        let right = model.placement().local(sample.position);
        let angle = if on_lattice {
            0.0
        } else {
            degrees(vertex.normal, sample.normal())
        };
        worst.add(position.distance(right) / diagonal, angle);
    }
    worst
}

fn sampled<'a>(
    prepared: &'a Prepared,
    frame: &'a Frame,
    step: usize,
) -> impl Iterator<Item = (&'a Pass, &'a Captured)> {
    let passes = prepared.passes.iter().zip(&frame.passes);
    passes
        .flat_map(|(pass, vertices)| vertices.iter().map(move |vertex| (pass, vertex)))
        .step_by(step)
}

/// The angle between a captured normal and the right one; 0 where the right one is zero, for there every direction will do.
fn degrees(captured: [f32; 3], right: DVec3) -> f64 {
    let captured = Vec3::from(captured).as_dvec3();
    if right == DVec3::ZERO {
        return 0.0;
    }
    assert!(captured.is_finite(), "a normal of {captured}");
    captured
        .cross(right)
        .length()
        .atan2(captured.dot(right))
        .to_degrees()
}
