//! Patches that are drawn with one set of shaders, and how they read on the CPU.

use std::ops::Range;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::abi;
use crate::method::cell::Cell;
use crate::method::ptex;
use crate::method::stage::Stage;
use crate::method::surface::{Controls, SurfacePoint};
use crate::method::table::Table;
use crate::tessellation::{Domain, cells};

/// Patches that are drawn with one set of shaders.
#[derive(Clone, Debug)]
pub struct Pass {
    /// The file in `glsl/method` that evaluates them.
    pub shader: &'static str,
    /// The shape of all of them.
    pub domain: Domain,
    /// The file that evaluates them where their control points are cached; None where they need no ring.
    pub cached: Option<&'static str>,
    /// Control points a patch, 1..=32, that go through the vertex shader; 1 where they are cached.
    pub control_points: u32,
    /// The patches.
    pub patches: Vec<abi::Patch>,
    /// The numbers of control vertices that the patches point into.
    pub controls: Vec<u32>,
    /// The side of the [`Outline`](crate::method::Outline) to which each patch's edge from corner i to corner i + 1 belongs; a triangle's last one twice. Filled in by
    /// [`Method::prepare`](crate::method::Method::prepare).
    pub sides: Vec<[u32; 4]>,
    /// Texture coordinates of each patch's four corners.
    pub texture: Vec<[[f32; 2]; 4]>,
    /// The method's own tables, `TABLES` at most.
    pub tables: Vec<Table>,
    /// The points that a patch needs in the scratch ring at levels 0..=10, by its plan; empty when there is no ring.
    pub scratch_points: Vec<[u32; abi::HIGHEST_LEVEL as usize + 1]>,
    /// The products of a weight and a vertex that these take.
    pub scratch_products: Vec<[u64; abi::HIGHEST_LEVEL as usize + 1]>,
    /// The deepest level that is evaluated exactly; tess factors stay at or below 2 to this.
    pub max_level: u32,
    /// What the evaluation shader computes, on the CPU.
    pub twin: Twin,
    /// Whether all patches are end caps, of which only the corners are on the limit.
    pub caps: bool,
    /// The derivatives of what it computes; None where there are none.
    pub(super) tangents: Option<TangentsAt>,
    /// Tells by which cell the inside of a patch is evaluated; None where patches have no plans.
    pub(super) cell: Option<CellAt>,
    /// Tells which face of a macro face has a point; None where there are none.
    pub(super) face_at: Option<FaceAt>,
    /// How many control vertices bound a patch; None where they do not, see [`Pass::hull`].
    pub(super) hull: Option<fn(&Pass, usize) -> u32>,
    /// What bounds a macro face; None where there are none.
    pub(super) bounds: Option<fn(&Pass, usize) -> Bounds>,
    /// Whether these are the control points of a bicubic B-spline, row by row along u.
    pub(super) is_spline: bool,
    /// When each patch is drawn; empty where all always are.
    pub(super) stages: Vec<Stage>,
    /// Of how many control vertices and points it was made. Filled in by [`Method::prepare`](crate::method::Method::prepare).
    pub(super) needs: [usize; 2],
}

/// A patch evaluated on the CPU in f32, from the bytes that the GPU gets: control vertices and points, patch, and where in its domain.
pub type Twin = fn(&Pass, &Controls, usize, Vec2) -> SurfacePoint;

/// The derivatives by a patch's own u and v, of a patch that is drawn at a plan level.
pub(super) type TangentsAt = fn(&Pass, &Controls, usize, Vec2, u32) -> [Vec3; 2];

/// The cell at (u, v) of a patch.
pub(super) type CellAt = fn(&Pass, usize, Vec2) -> Option<Cell>;

/// What bounds a macro face.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    /// The control vertices in whose convex hull it is: those of its faces, and behind them the others. None where that is not known.
    pub(super) vertices: Vec<u32>,
    /// How many are its faces'.
    pub(super) own: usize,
    /// The control points of its cells, row by row along its own u, where all are bicubic B-splines; else none.
    pub(super) splines: Vec<[u32; 16]>,
}

/// The slot of the face that has (u, v) of a macro face, and where in its own patch.
pub(super) type FaceAt = fn(&Pass, usize, Vec2) -> (usize, Vec2);

impl Pass {
    /// A pass without patches.
    pub(super) fn new(
        shader: &'static str,
        domain: Domain,
        control_points: u32,
        twin: Twin,
    ) -> Pass {
        Pass {
            shader,
            domain,
            cached: None,
            control_points,
            patches: Vec::new(),
            controls: Vec::new(),
            sides: Vec::new(),
            texture: Vec::new(),
            tables: Vec::new(),
            scratch_points: Vec::new(),
            scratch_products: Vec::new(),
            max_level: abi::HIGHEST_LEVEL,
            twin,
            caps: false,
            tangents: None,
            cell: None,
            face_at: None,
            hull: None,
            bounds: None,
            is_spline: false,
            stages: Vec::new(),
            needs: [0; 2],
        }
    }

    /// The same with tangents.
    pub(super) fn with_tangents(self, tangents: TangentsAt) -> Pass {
        Pass {
            tangents: Some(tangents),
            ..self
        }
    }

    /// Whether fragment shaders can have tangents of it.
    pub fn has_tangents(&self) -> bool {
        self.tangents.is_some()
    }

    /// What fragment shaders get that ask for tangents: dP/du and dP/dv in local units, by the (u, v) of the ptex face, at `uv` of the domain of patch `patch`, which is
    /// drawn at tess level `level` (1..=1024; of it only corners of irregular `quadtree` patches take notice, see the manual, *Shaders*). Without displacement. Zero where there is no
    /// surface, as for [`evaluate`](Self::evaluate); None where patches have no tangents.
    pub fn tangents(
        &self,
        controls: &Controls,
        patch: usize,
        uv: Vec2,
        level: f32,
    ) -> Option<[Vec3; 2]> {
        let tangents = self.tangents?;
        if !self.can_evaluate(controls, patch, uv) {
            return Some([Vec3::ZERO; 2]);
        }
        let uv = self.domain.nearest(uv.to_array()).into();
        let plan_level = (level.clamp(1.0, 1024.0).ceil() as u32)
            .next_power_of_two()
            .ilog2();
        let own = tangents(self, controls, patch, uv, plan_level);
        Some(ptex::to_ptex_tangents(&self.patches[patch], own))
    }

    /// Evaluates patch `patch` at `uv` of its own domain; what lies outside of that is moved to its edge. Where there is no such patch, (u, v) is
    /// no number, or the controls are of another number of vertices or points, there is no surface: position and normal are zero.
    pub fn evaluate(&self, controls: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
        if !self.can_evaluate(controls, patch, uv) {
            return SurfacePoint::default();
        }
        (self.twin)(
            self,
            controls,
            patch,
            self.domain.nearest(uv.to_array()).into(),
        )
    }

    fn can_evaluate(&self, controls: &Controls, patch: usize, uv: Vec2) -> bool {
        let given = [controls.vertices.len(), controls.points.len()];
        !self.is_vacant(patch) && !uv.is_nan() && given == self.needs
    }

    /// The same at many places, each a patch and (u, v), in parallel in rayon's current pool.
    pub fn evaluate_all(&self, controls: &Controls, places: &[(u32, Vec2)]) -> Vec<SurfacePoint> {
        let places = places.par_iter().with_min_len(256);
        let evaluate = |&(patch, uv): &(u32, Vec2)| self.evaluate(controls, patch as usize, uv);
        places.map(evaluate).collect()
    }

    /// The cell by which patch `patch` is evaluated at `uv` of its own domain, if that lies inside. None where patches have no plans, and where there is
    /// no such patch or place.
    pub fn cell(&self, patch: usize, uv: Vec2) -> Option<Cell> {
        let cell = self
            .cell
            .filter(|_| !self.is_vacant(patch) && !uv.is_nan())?;
        cell(self, patch, self.domain.nearest(uv.to_array()).into())
    }

    /// The slot, and the place there, that stand for `uv` of patch `patch`: of a macro face those of one of its faces, which tell the ptex face; else the same.
    pub fn face_at(&self, patch: usize, uv: [f32; 2]) -> (usize, [f32; 2]) {
        match self.face_at {
            Some(face_at) if !self.is_vacant(patch) && !Vec2::from(uv).is_nan() => {
                let (slot, own) = face_at(self, patch, self.domain.nearest(uv).into());
                (slot, own.to_array())
            }
            _ => (patch, uv),
        }
    }

    /// The slots of the faces of patch `patch`: of a macro face those behind all others, of which nothing is drawn by itself, row by row; else its own.
    pub fn faces_of(&self, patch: usize) -> Range<usize> {
        match self.face_at {
            Some(face_at) if !self.is_vacant(patch) => {
                let [columns, rows] = cells(&self.patches[patch]);
                let (first, _) = face_at(self, patch, Vec2::ZERO);
                first..first + (columns * rows) as usize
            }
            _ => patch..patch + 1,
        }
    }

    /// Texture coordinates at `uv` of the domain of patch `patch`, linear between its corners. Twin of `texture_coordinates` in
    /// `glsl/lib/vertex.glsl`. Zero where there is no such patch.
    pub fn texture_coordinates(&self, patch: usize, uv: [f32; 2]) -> [f32; 2] {
        let (patch, uv) = self.face_at(patch, uv);
        let corners = self.texture.get(patch).copied().unwrap_or_default();
        linear(self.domain, corners, uv)
    }

    /// Whether a point of a patch's domain is a corner of the finest grid that the pass has tables for; see [`Reproduces::LimitOnLattice`](crate::method::Reproduces::LimitOnLattice).
    pub fn is_on_lattice(&self, uv: [f32; 2]) -> bool {
        let segments = (1u32 << self.max_level.saturating_sub(1).min(31)) as f32;
        uv.iter().all(|x| (x * segments).fract() == 0.0)
    }

    /// Whether nothing is drawn of a patch's slot: there is no such slot, or an edit has left it vacant, see [`Editable`](super::Editable).
    pub fn is_vacant(&self, patch: usize) -> bool {
        let record = self.patches.get(patch);
        record.is_none_or(|record| record.flags & abi::PATCH_VACANT != 0)
    }

    /// How many slots lead up to the last that is not vacant.
    pub fn extent(&self) -> usize {
        let is_drawn = |record: &abi::Patch| record.flags & abi::PATCH_VACANT == 0;
        let last = self.patches.iter().rposition(is_drawn);
        last.map_or(0, |last| last + 1)
    }

    /// The points that patch `patch` needs in the ring at `level`, from 10 on as at 10; none where there is no such patch.
    pub fn points(&self, patch: usize, level: u32) -> u32 {
        let points = self.by_plan(&self.scratch_points, patch);
        points.map_or(0, |points| points[level.min(abi::HIGHEST_LEVEL) as usize])
    }

    /// The products of a weight and a vertex that these points take.
    pub fn products(&self, patch: usize, level: u32) -> u64 {
        let products = self.by_plan(&self.scratch_products, patch);
        products.map_or(0, |products| {
            products[level.min(abi::HIGHEST_LEVEL) as usize]
        })
    }

    /// What a list has for a patch's plan.
    fn by_plan<'a, T>(&self, list: &'a [T], patch: usize) -> Option<&'a T> {
        let plan = self.patches.get(patch)?.plan;
        list.get(plan as usize).filter(|_| !self.is_vacant(patch))
    }
}

/// Linear between the corners of a domain.
pub(super) fn linear(domain: Domain, corners: [[f32; 2]; 4], uv: [f32; 2]) -> [f32; 2] {
    let [a, b, c, d] = corners.map(Vec2::from);
    let [u, v] = uv;
    match domain {
        Domain::Quads => a.lerp(b, u).lerp(d.lerp(c, u), v),
        Domain::Triangles => (1.0 - u - v) * a + u * b + v * c,
    }
    .to_array()
}

/// Whether a point of a triangle is a corner or the middle of an edge; see [`Reproduces::LimitOnHexagon`](crate::method::Reproduces::LimitOnHexagon).
pub fn is_on_hexagon(uv: [f32; 2]) -> bool {
    uv.iter().all(|x| (2.0 * x).fract() == 0.0)
}
