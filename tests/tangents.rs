//! What fragment shaders get that ask for tangents, on the CPU's twins: the limit's derivatives where a method draws the limit, and of each method those of
//! what it draws.

mod common;

use glam::{DVec3, Vec2, Vec3};
use hullform::mesh::{Model, Scheme, Triangulation, builtin, read_obj, triangulated};
use hullform::method::{METHODS, MethodOptions, Pass, to_ptex};
use hullform::subdivision::{LimitSample, LimitSurface};
use hullform::tessellation::Domain;

/// The level at which corners are looked at.
const LEVEL: u32 = 16;

fn models() -> Vec<(String, Model)> {
    let own = ["hull", "cube", "creased-torus", "sheet", "ngons", "pole-7"];
    let own = own.map(|name| (name.to_owned(), builtin(name).expect("it is built in")));
    let shared = common::obj_files("shapes").into_iter();
    let shared = shared.filter_map(|file| Some((common::stem(&file), read_obj(&file).ok()?)));
    let all = own.into_iter().chain(shared);
    all.map(|(name, mesh)| (name, Model::new(mesh))).collect()
}

/// Everywhere on a lattice of a patch.
fn places(domain: Domain) -> impl Iterator<Item = Vec2> {
    let along = (0..=LEVEL).step_by(4).map(|i| i as f32 / LEVEL as f32);
    let all = along
        .clone()
        .flat_map(move |u| along.clone().map(move |v| Vec2::new(u, v)));
    all.filter(move |uv| domain == Domain::Quads || uv.x + uv.y <= 1.0)
}

fn is_corner(uv: Vec2) -> bool {
    [uv.x, uv.y].iter().all(|&x| x == 0.0 || x == 1.0)
}

/// How far apart two vectors are, for the longer; none where both are next to nothing.
fn apart(own: Vec3, right: DVec3, least: f64) -> f64 {
    let own = own.as_dvec3();
    let size = own.length().max(right.length());
    if size < least {
        0.0
    } else {
        own.distance(right) / size
    }
}

/// The limit beside a corner along either edge, from where directions are looked at.
fn beside(surface: &LimitSurface, ptex: usize, [u, v]: [f64; 2]) -> Option<[LimitSample; 2]> {
    const NEAR: f64 = 1.0 / 65536.0;
    let inwards = |x: f64| if x > 0.5 { x - NEAR } else { x + NEAR };
    let by_u = surface.evaluate(ptex, inwards(u), v)?;
    Some([by_u, surface.evaluate(ptex, u, inwards(v))?])
}

/// By the references' (u, v): those of the truth, which is held to the references. At corners of irregular patches directions by differences,
/// which get better with the level; everything else to rounding.
#[test]
fn tangents_of_the_quadtree_are_the_limits_derivatives() {
    let (mut worst, mut seen) = (0.0f64, 0);
    // At two levels: tangents at corners, those that are farther off than ten degrees, and the sum of all angles.
    let mut far = [(0u32, 0usize, 0.0f64); 2];
    for (name, model) in models() {
        let Ok(prepared) = METHODS[0].prepare(&model, MethodOptions::default()) else {
            continue;
        };
        let surface = LimitSurface::new(model.mesh());
        let controls = prepared.controls(model.positions());
        let placement = model.placement();
        let local = |by: DVec3| placement.local(by) - placement.local(DVec3::ZERO);
        for (pass, patch, uv) in all(&prepared.passes) {
            let record = &pass.patches[patch];
            let ptex = record.ptex as usize;
            let own = pass.tangents(&controls, patch, uv, LEVEL as f32);
            let own = own.expect("it has tangents");
            let [u, v] = to_ptex(record, uv.to_array()).map(f64::from);
            let Some(right) = surface.evaluate(ptex, u, v) else {
                continue;
            };
            // Corners of others are limits, as those are whose points a cache has.
            let irregular = pass.cached.is_some();
            if is_corner(uv) && irregular {
                let Some(beside) = beside(&surface, ptex, [u, v]) else {
                    continue;
                };
                let right = [local(beside[0].du), local(beside[1].dv)];
                for (level, share) in [16.0, 64.0].into_iter().zip(&mut far) {
                    let own = pass.tangents(&controls, patch, uv, level);
                    for (own, right) in own.expect("it has tangents").into_iter().zip(right) {
                        let own = own.as_dvec3();
                        if own.length().min(right.length()) > 1e-4 {
                            let angle = own.angle_between(right).to_degrees();
                            share.0 += 1;
                            share.1 += usize::from(angle > 10.0);
                            share.2 += angle;
                        }
                    }
                }
                continue;
            }
            let least = 1e-3 * (local(right.du).length() + local(right.dv).length());
            for (own, right) in own.into_iter().zip([local(right.du), local(right.dv)]) {
                let off = apart(own, right, least);
                assert!(
                    off < 1e-3,
                    "{name}, {} {patch} at {uv}: {own} is {right}",
                    pass.shader
                );
                worst = worst.max(off);
                seen += 1;
            }
        }
    }
    println!("{seen} tangents, {worst:.1e} at most; at corners {far:?}");
    assert!(seen > 10_000);
    for ((all, far, sum), [share, mean]) in far.into_iter().zip([[0.04, 2.0], [0.015, 0.6]]) {
        assert!(
            all > 500 && (far as f64) < share * f64::from(all),
            "{far} of {all}"
        );
        assert!(
            sum < mean * f64::from(all),
            "{} degrees",
            sum / f64::from(all)
        );
    }
}

fn all(passes: &[Pass]) -> impl Iterator<Item = (&Pass, usize, Vec2)> {
    passes.iter().flat_map(|pass| {
        let patches = (0..pass.patches.len()).filter(|&patch| !pass.is_vacant(patch));
        patches.flat_map(move |patch| places(pass.domain).map(move |uv| (pass, patch, uv)))
    })
}

/// Of every method, away from its borders: differences of the positions that it draws. The tangents of `acc` are those that its normals come from.
#[test]
fn tangents_are_derivatives_of_what_is_drawn() {
    const STEP: f32 = 1.0 / 512.0;
    let mut seen = std::collections::BTreeMap::<&str, usize>::new();
    let under_each = |(name, model): (String, Model)| {
        let under = move |scheme: Scheme| {
            let mesh = match scheme.is_triangular() {
                true => triangulated(model.mesh(), Triangulation::default()).ok()?,
                false => model.mesh().clone(),
            };
            Some((
                format!("{name} {scheme}"),
                Model::new(mesh.with_scheme(scheme).ok()?),
            ))
        };
        [Scheme::CatmullClark, Scheme::Loop]
            .into_iter()
            .filter_map(under)
    };
    for (name, model) in models().into_iter().take(6).flat_map(under_each) {
        let able = METHODS
            .iter()
            .filter(|method| method.check_model(&model).is_ok());
        for method in able {
            let prepared = method.prepare(&model, MethodOptions::default());
            let prepared = prepared.expect("it draws the model");
            let controls = prepared.controls(model.positions());
            for (pass, patch, uv) in all(&prepared.passes) {
                // Off the lines of lattices.
                let uv = uv + Vec2::new(0.013, 0.021);
                if uv.x + uv.y > 0.95
                    && (pass.domain == Domain::Triangles || uv.max_element() > 0.95)
                {
                    continue;
                }
                let Some(own) = pass.tangents(&controls, patch, uv, LEVEL as f32) else {
                    continue;
                };
                let at = |uv: Vec2| {
                    let point = pass.evaluate(&controls, patch, uv);
                    point.position.as_dvec3()
                };
                let slope = |axis: Vec2| {
                    (at(uv + STEP * axis) - at(uv - STEP * axis)) / f64::from(2.0 * STEP)
                };
                let slopes = [Vec2::X, Vec2::Y].map(slope);
                let right = in_ptex(&pass.patches[patch], slopes);
                let least = 1e-2 * (right[0].length() + right[1].length()).max(1e-2);
                // Positions are rounded, and of small pieces differences are small.
                let piece = in_ptex(&pass.patches[patch], [DVec3::X, DVec3::Y]);
                let rounding = f64::from(f32::EPSILON / STEP) * piece[0].length();
                for (own, right) in own.into_iter().zip(right) {
                    if method.name == "acc" {
                        continue;
                    }
                    let off = apart(own, right, least);
                    assert!(
                        off < 2e-2 || own.as_dvec3().distance(right) < 2.0 * rounding,
                        "{name}, {} {patch} at {uv}: {own} is {right}",
                        pass.shader
                    );
                    *seen.entry(pass.shader).or_default() += 1;
                }
                if method.name == "acc" {
                    let normal = own[0].cross(own[1]).normalize_or_zero();
                    let right = pass.evaluate(&controls, patch, uv).normal;
                    assert!(
                        normal.distance(right) < 1e-3 || normal == Vec3::ZERO,
                        "{name} {patch} at {uv}"
                    );
                    *seen.entry(pass.shader).or_default() += 1;
                }
            }
        }
    }
    println!("{seen:?}");
    assert!(seen.len() >= 10, "{seen:?}");
}

/// By the chain rule, as the ptex face's (u, v) are linear in the patch's own.
fn in_ptex(patch: &hullform::abi::Patch, [du, dv]: [DVec3; 2]) -> [DVec3; 2] {
    let at = |uv: [f32; 2]| glam::DVec2::from(to_ptex(patch, uv).map(f64::from));
    let origin = at([0.0, 0.0]);
    let own = glam::DMat2::from_cols(at([1.0, 0.0]) - origin, at([0.0, 1.0]) - origin);
    let ptex = own.inverse();
    [ptex.x_axis, ptex.y_axis].map(|by| by.x * du + by.y * dv)
}
