//! A model as the quadtree method prepares it, held against the truth.

use glam::Vec2;
use hullform::mesh::{ControlMesh, Model};
use hullform::method::{Prepared, method, to_ptex};
use hullform::plan::PlanOptions;
use hullform::subdivision::LimitSurface;

use super::meshes::scatter;

/// A model, its plans, and its truth.
pub struct Surfaces {
    pub model: Model,
    pub prepared: Prepared,
    truth: LimitSurface,
    /// In local units.
    diagonal: f64,
}

/// How far plans are off the truth at worst, and where.
#[derive(Debug, Default)]
pub struct Worst {
    /// Distance over the diagonal.
    pub distance: f64,
    /// Angle between normals in degrees.
    pub angle: f64,
    /// How many points were compared.
    pub points: usize,
    /// Where: ptex face and coordinates in the patch.
    pub far: (u32, [f32; 2]),
    /// As `far`, for the angle.
    pub steep: (u32, [f32; 2]),
}

impl Surfaces {
    pub fn of(mesh: ControlMesh, options: PlanOptions) -> Surfaces {
        let method = method("quadtree").expect("it is in the table");
        let model = Model::new(mesh);
        Surfaces {
            prepared: method.prepare(&model, options).expect("sound options"),
            truth: LimitSurface::new(model.mesh()),
            diagonal: model.diagonal(),
            model,
        }
    }

    /// Holds every `stride`-th patch of each pass against the truth, at the given coordinates of the patch's own domain.
    pub fn worst(
        &self,
        stride: usize,
        mut coordinates: impl FnMut(usize) -> Vec<[f32; 2]>,
    ) -> Worst {
        let controls = self.prepared.controls(self.model.positions());
        let mut worst = Worst::default();
        for pass in &self.prepared.passes {
            for number in (0..pass.patches.len()).step_by(stride) {
                let patch = pass.patches[number];
                for uv in coordinates(number) {
                    let [u, v] = to_ptex(&patch, uv).map(f64::from);
                    let point = pass.evaluate(&controls, number, Vec2::from(uv));
                    let truth = self.truth.evaluate(patch.ptex as usize, u, v);
                    let truth = truth.expect("patches are no holes");
                    let placement = self.model.placement();
                    let right = placement.local(truth.position);
                    let distance = point.position.as_dvec3().distance(right) / self.diagonal;
                    // NaN must not pass.
                    if distance > worst.distance || distance.is_nan() {
                        (worst.distance, worst.far) = (distance, (patch.ptex, uv));
                    }
                    let [du, dv] = [truth.du, truth.dv].map(|tangent| tangent / placement.scale);
                    let shortest = du.length().min(dv.length()) / self.diagonal;
                    let (du, dv) = (du.normalize_or_zero(), dv.normalize_or_zero());
                    let angle = point
                        .normal
                        .as_dvec3()
                        .angle_between(truth.normal())
                        .to_degrees();
                    // Derivatives carry the rounding of positions times 64; where the surface folds or stands still, f32 has no normal.
                    let firm = du.cross(dv).length() * shortest > 0.01;
                    if firm && (angle > worst.angle || angle.is_nan()) {
                        (worst.angle, worst.steep) = (angle, (patch.ptex, uv));
                    }
                    worst.points += 1;
                }
            }
        }
        worst
    }
}

impl Worst {
    /// Asserts the contract of the quadtree method.
    pub fn hold(&self, name: &str) {
        assert!(self.points > 0, "{name}: nothing was compared");
        assert!(self.distance <= 1e-6, "{name}: {self:?}");
        assert!(self.angle <= 0.1, "{name}: {self:?}");
    }
}

/// The tess levels that tests look at: powers of two, their neighbours, and odd ones.
pub const LEVELS: [u32; 12] = [1, 2, 3, 5, 7, 8, 13, 16, 31, 33, 63, 64];

/// For each level some tess coordinates: corners, points next to them, and `count` others, on edges and inside.
pub fn tess_coordinates(levels: &[u32], count: u32, seed: usize) -> Vec<[f32; 2]> {
    let mut coordinates = Vec::new();
    for &level in levels {
        let at = |i: u32| i as f32 / level as f32;
        let (one, last) = (at(1), at(level - 1));
        coordinates.extend([[0.0, 0.0], [1.0, 1.0], [one, 0.0], [0.0, last], [last, one]]);
        for i in 0..count {
            let random = scatter(u64::from(level * 1000 + i) ^ (seed as u64) << 20);
            let pick = |x: f64| at(((0.5 * x + 0.5) * f64::from(level + 1)) as u32);
            let [u, v] = [pick(random.x), pick(random.y)];
            let edge = [0.0, 1.0][i as usize / 2 % 2];
            coordinates.push([[u, v], [u, edge], [u, v], [edge, v]][i as usize % 4]);
        }
    }
    coordinates
}
