//! Random meshes that lie in a plane, with everything that makes the tangents at a vertex cancel: straight creases and what ends on them, corners,
//! boundaries, faces with straight corners. Turned, scaled and moved.

use glam::{DQuat, DVec3};

use super::{Draft, Parts, sheet, under};
use crate::conformance::random::Random;
use crate::error::Result;
use crate::mesh::{
    BoundaryInterpolation, ControlMesh, CreaseMethod, Scheme, SchemeOptions, TriangleSubdivision,
};

/// A mesh in a plane.
pub struct Planar {
    /// The mesh.
    pub mesh: ControlMesh,
    /// The side from which its faces are counter-clockwise; of unit length.
    pub normal: DVec3,
}

/// A random mesh of a scheme in a plane that `able` takes: of tags that it does not take it has none, and where even so it takes none, it is a sheet of
/// quads.
///
/// # Errors
/// None, unless this file is wrong.
pub fn planar(
    random: &mut Random,
    scheme: Scheme,
    able: impl Fn(&ControlMesh) -> bool,
) -> Result<Planar> {
    for _ in 0..20 {
        let even = random.below(2) == 0;
        let (parts, normal) = placed(Draft::plane(random, even), random);
        let (options, tags) = (options(random), Tags::new(random, &parts));
        for whole in [tags.put_on(&parts, options), parts.build()] {
            if let Ok(mesh) = under(whole?, scheme)
                && able(&mesh)
            {
                return Ok(Planar { mesh, normal });
            }
        }
    }
    let mut flat = sheet(5);
    for position in &mut flat.positions {
        position[2] = 0.0;
    }
    let (parts, normal) = placed(flat, random);
    let mesh = parts.open(scheme, able)?;
    Ok(Planar { mesh, normal })
}

/// Turned anyhow, from 2^-12 to 2^12 as large, and up to a thousand times as far from the origin.
fn placed(mut parts: Parts, random: &mut Random) -> (Parts, DVec3) {
    let mut between = |low, high| random.between(low, high);
    let axis = DVec3::new(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
    let turn = DQuat::from_axis_angle(axis.normalize_or(DVec3::X), between(0.0, 6.3));
    let scale = between(-12.0, 12.0).exp2();
    let far = 10f64.powf(between(-1.0, 3.0));
    let offset = DVec3::new(between(-far, far), between(-far, far), between(-far, far));
    for position in &mut parts.positions {
        *position = (scale * (turn * DVec3::from(*position) + offset)).to_array();
    }
    (parts, turn * DVec3::Z)
}

fn options(random: &mut Random) -> SchemeOptions {
    use BoundaryInterpolation::{EdgeAndCorner, EdgeOnly, None};
    use CreaseMethod::{Chaikin, Uniform};
    use TriangleSubdivision::{CatmullClark, Smooth};
    SchemeOptions {
        boundary: *random.one_of(&[EdgeOnly, EdgeOnly, EdgeAndCorner, EdgeAndCorner, None]),
        creasing: *random.one_of(&[Uniform, Uniform, Chaikin]),
        triangles: *random.one_of(&[CatmullClark, Smooth]),
        ..Default::default()
    }
}

/// Creases and corners, mostly infinite ones.
struct Tags {
    edges: Vec<(u32, u32, f32)>,
    corners: Vec<(u32, f32)>,
}

impl Tags {
    fn new(random: &mut Random, parts: &Parts) -> Tags {
        const SHARPNESS: [f32; 8] = [10.0, 10.0, 10.0, 10.0, 10.0, 0.7, 1.5, 3.2];
        let faces = &parts.faces;
        let (mut edges, mut corners) = (Vec::new(), Vec::new());
        for _ in 0..random.below(14) {
            let face = random.one_of(faces);
            let i = random.below(face.len() as u32) as usize;
            let ends = (face[i], face[(i + 1) % face.len()]);
            edges.push((ends.0, ends.1, *random.one_of(&SHARPNESS)));
        }
        for _ in 0..random.below(5) {
            let face = random.one_of(faces);
            let vertex = *random.one_of(face);
            corners.push((vertex, *random.one_of(&SHARPNESS)));
        }
        Tags { edges, corners }
    }

    fn put_on(&self, parts: &Parts, options: SchemeOptions) -> Result<ControlMesh> {
        parts.tagged(|builder| {
            let builder = builder.options(options);
            let edges = self.edges.iter();
            let builder = edges.fold(builder, |builder, &(a, b, s)| builder.crease(a, b, s));
            let corners = self.corners.iter();
            corners.fold(builder, |builder, &(vertex, s)| builder.corner(vertex, s))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planar_meshes_lie_in_their_plane_and_are_tagged() {
        let mut random = Random::new(0, "planar");
        let (mut creases, mut corners, mut arities) = (0, 0, std::collections::BTreeSet::new());
        for _ in 0..300 {
            let Planar { mesh, normal } =
                planar(&mut random, Scheme::CatmullClark, |_| true).expect("it is sound");
            let (low, high) = mesh.bounds();
            let reach = low.abs().max(high.abs()).max_element();
            let off = mesh
                .positions()
                .iter()
                .map(|&p| (p - mesh.positions()[0]).dot(normal));
            assert!(off.map(f64::abs).fold(0.0, f64::max) < 1e-14 * reach);
            creases += mesh.creases().len();
            corners += mesh.corners().len();
            arities.extend(mesh.faces().map(<[u32]>::len));
        }
        assert!(creases > 1000 && corners > 300, "{creases}, {corners}");
        assert!([3, 4, 5, 6].iter().all(|arity| arities.contains(arity)));
    }
}
