//! `fas`: feature-adaptive subdivision (Nießner, Loop, Meyer, DeRose 2012, "Feature-adaptive GPU rendering of Catmull-Clark subdivision surfaces"). The control
//! mesh is refined only around what is no bicubic B-spline, level by level; each level's faces that are one are drawn, others are refined again. Points
//! come from a table of weights a level, over the points of the level before (section 3.1), computed once a pose. Across single semi-sharp creases patches are
//! evaluated directly (Nießner, Loop, Greiner 2012, "Efficient evaluation of semi-smooth creases in Catmull-Clark subdivision surfaces").
//!
//! A patch has half of the tess level of its parent. Where one lies beside two of the next level its edge has twice their segments, so vertices meet;
//! the paper cuts such patches into up to four domains instead (section 3.2), since fractional levels do not halve. What is irregular at the last level has an
//! end cap (`fas/caps.rs`); the paper stops where the tess level is 1, and only corners, which are on the limit, are drawn of it: `IsolationOptions::level_for`.

pub(super) mod caps;
pub(super) mod level;
pub(super) mod levels;

use glam::{Vec2, Vec3};

use crate::abi;
use crate::error::{Error, Place, Result};
use crate::mesh::{Model, Scheme};
use crate::method::bicubic::Bicubic;
use crate::method::blended::{Net, quad_surface};
use crate::method::spline::{bspline, creased};
use crate::method::surface::{Controls, Surface, SurfacePoint, Tangents, UNIT, reach};
use crate::method::{Contract, EndCaps, Method, MethodOptions, Pass, Prepared, Reproduces};
use crate::plan::Database;
use crate::tessellation::Domain;
use levels::Levels;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "fas",
    summary: "feature-adaptive subdivision: B-spline patches of as many levels as it takes, with end caps",
    paper: "Nießner, Loop, Meyer, DeRose 2012",
    schemes: &[Scheme::CatmullClark],
    domains: &[Domain::Quads],
    contract: Contract {
        reproduces: Reproduces::LimitBesideCaps(1e-6),
        normals: Some(0.1),
        interpolates: false,
        watertight: false,
    },
    uses_tables: false,
    isolates: true,
    aggregates: false,
    dynamic: false,
    covers: check,
    prepare,
    edits: None,
};

/// The faces around a vertex, or corners of a face, that are refined: each cap there has sums over all of them.
const MOST_AROUND: usize = 512;

/// Refuses vertices and faces with too much around.
///
/// # Errors
/// [`Error::Input`] with the vertex or face.
pub(super) fn check(model: &Model) -> Result<()> {
    let topology = model.topology();
    let refuse = |place: Place, count: usize, remedy: &str| {
        let problem = format!(
            "{count} patches meet there, and each has sums over all of them: no more than {MOST_AROUND} will be summed"
        );
        Err(Error::input(place, problem, remedy))
    };
    for face in 0..topology.face_count() as u32 {
        let corners = topology.face(face).len();
        if corners > MOST_AROUND {
            let remedy = "cut the face into smaller ones, or choose another method";
            return refuse(Place::Face(face as usize), corners, remedy);
        }
    }
    for vertex in 0..topology.vertex_count() as u32 {
        let faces = topology.vertex_faces(vertex).len();
        if faces > MOST_AROUND {
            let remedy = "divide the fan, or choose another method";
            return refuse(Place::Vertex(vertex as usize), faces, remedy);
        }
    }
    Ok(())
}

fn prepare(model: &Model, options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let isolation = options.isolation.check()?;
    let passes = passes("fas", isolation.caps);
    Ok(Levels::new(model, passes, isolation.caps).refine(isolation.level))
}

/// Passes of B-splines, which `splines` evaluates, of such with corners of their own, of bicubic end caps and of those of a kind.
pub(super) fn passes(splines: &'static str, caps: EndCaps) -> [Pass; 4] {
    let pass = |shader, twin| Pass::new(shader, Domain::Quads, 1, twin);
    let capped = |shader, twin| Pass {
        caps: true,
        ..pass(shader, twin)
    };
    let bicubic = capped("fas_caps", cap).with_tangents(cap_tangents);
    let own = match caps {
        // There are none beside those.
        EndCaps::Bicubic => bicubic.clone(),
        EndCaps::Gregory => capped("fas_gregory", gregory).with_tangents(gregory_tangents),
        EndCaps::Legacy => capped("fas_legacy", legacy).with_tangents(legacy_tangents),
        EndCaps::Bspline => capped(splines, spline).with_tangents(spline_tangents),
    };
    let [splines, cornered] =
        [splines, "fas_corners"].map(|shader| pass(shader, spline).with_tangents(spline_tangents));
    [splines, cornered, bicubic, own]
}

/// The points of a patch.
fn points<const N: usize>(pass: &Pass, given: &Controls, patch: usize) -> [Vec3; N] {
    let controls = &pass.controls[pass.patches[patch].controls as usize..];
    std::array::from_fn(|i| given.points[controls[i] as usize].position.into())
}

pub(super) fn spline(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let points: [Vec3; 16] = points(pass, given, patch);
    let is_cap = false;
    point(
        pass,
        patch,
        uv,
        (&points, is_cap),
        spline_surface(pass, given, patch),
    )
}

fn spline_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let Surface { du, dv, .. } = spline_surface(pass, given, patch)(uv);
    [du, dv]
}

/// A B-spline patch. Behind the points stands the sharpness of the crease, if it has one.
fn spline_surface(pass: &Pass, given: &Controls, patch: usize) -> impl Fn(Vec2) -> Surface {
    let points: [Vec3; 16] = points(pass, given, patch);
    let abi::Patch { controls, plan, .. } = pass.patches[patch];
    let (edge, sharpness) = match plan >> abi::PIECE_CREASE_SHIFT & 7 {
        0 => (0, 0.0),
        edge => {
            let bits = pass.controls[controls as usize + 16];
            (edge - 1, f32::from_bits(bits))
        }
    };
    move |uv| {
        let (u, v) = creased(uv, edge, sharpness);
        bspline(u, v, 1.0, |x, y| points[x + 4 * y])
    }
}

/// A point of a surface. At the corner of a single face, and at a cusp, the normal counts only if that at (1/64, 1/64) of the ptex face from there is like
/// it, as the truth has it (`subdivision/normals.rs`), and if it is not what rounding made of tangents that cancel; at those of a cap whose tangents span no plane, that
/// nearby stands for it.
fn point(
    pass: &Pass,
    patch: usize,
    uv: Vec2,
    (points, is_cap): (&[Vec3], bool),
    surface: impl Fn(Vec2) -> Surface,
) -> SurfacePoint {
    let found = surface(uv);
    let own = found.point();
    let corner = match uv.to_array() {
        [0.0, 0.0] => 0,
        [1.0, 0.0] => 1,
        [1.0, 1.0] => 2,
        [0.0, 1.0] => 3,
        _ => return own,
    };
    let patch = &pass.patches[patch];
    let is_none = is_cap && own.normal == Vec3::ZERO;
    if patch.flags & (abi::PATCH_NEARBY_CORNER << corner) == 0 && !is_none {
        return own;
    }
    let away = (1u32 << (patch.plan >> abi::PIECE_DEPTH_SHIFT)) as f32 / 64.0;
    let nearby = surface(uv + away * (1.0 - 2.0 * uv)).normal();
    let greatest = points.iter().copied().map(reach).fold(0.0, f32::max);
    let tangents = Tangents {
        sums: [found.du, found.dv],
        errors: [16.0 * UNIT * greatest; 2],
    };
    if nearby == Vec3::ZERO || Tangents::are_near(tangents.normal(), nearby) {
        return own;
    }
    SurfacePoint {
        normal: nearby,
        ..own
    }
}

fn cap(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    let points: [Vec3; 16] = points(pass, given, patch);
    let bicubic = bicubic(pass, given, patch);
    point(pass, patch, uv, (&points, true), |uv| bicubic.surface(uv))
}

fn cap_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let Surface { du, dv, .. } = bicubic(pass, given, patch).surface(uv);
    [du, dv]
}

/// An end cap: corners, the points next to each on its edge, those next to the other end, and those inside.
fn bicubic(pass: &Pass, given: &Controls, patch: usize) -> Bicubic {
    let points: [Vec3; 16] = points(pass, given, patch);
    let four = |first: usize| std::array::from_fn(|i| points[first + i]);
    Bicubic {
        corners: four(0),
        near: four(4),
        far: four(8),
        inner: four(12),
    }
}

fn gregory(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    blended_cap(pass, patch, uv, points(pass, given, patch))
}

fn gregory_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let Surface { du, dv, .. } = quad_surface(&net(points(pass, given, patch)), uv);
    [du, dv]
}

/// What the control shader sums for each patch.
fn summed(pass: &Pass, given: &Controls, patch: usize) -> [Vec3; 20] {
    let words = &pass.controls[pass.patches[patch].controls as usize..];
    std::array::from_fn(|i| {
        let terms = &words[words[i] as usize..words[i + 1] as usize];
        terms.chunks_exact(2).fold(Vec3::ZERO, |sum, term| {
            let point: Vec3 = given.points[term[0] as usize].position.into();
            sum + f32::from_bits(term[1]) * point
        })
    })
}

fn legacy(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    blended_cap(pass, patch, uv, summed(pass, given, patch))
}

fn legacy_tangents(pass: &Pass, given: &Controls, patch: usize, uv: Vec2, _: u32) -> [Vec3; 2] {
    let Surface { du, dv, .. } = quad_surface(&net(summed(pass, given, patch)), uv);
    [du, dv]
}

fn blended_cap(pass: &Pass, patch: usize, uv: Vec2, points: [Vec3; 20]) -> SurfacePoint {
    let net = net(points);
    point(pass, patch, uv, (&points[..16], true), |uv| {
        quad_surface(&net, uv)
    })
}

/// A Gregory cap: as a bicubic one, with two points inside of each corner.
fn net(points: [Vec3; 20]) -> Net<4> {
    let four = |first: usize| std::array::from_fn(|i| points[first + i]);
    Net {
        corners: four(0),
        near: four(4),
        far: four(8),
        before: four(12),
        behind: four(16),
    }
}

#[cfg(test)]
mod tests;
