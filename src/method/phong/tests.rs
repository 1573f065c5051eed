//! The published formula, in f64: p* = (1 - a) p + a (the weights of p over its projections onto the tangent planes), a = 3/4.

use glam::DVec3;

use super::METHOD;
use crate::method::vertices::reference::{Face, NEAR, TURNED, worst};

fn weights(corners: usize, [u, v]: [f64; 2]) -> Vec<f64> {
    match corners {
        3 => vec![1.0 - u - v, u, v],
        _ => vec![(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v],
    }
}

fn phong(face: &Face, weights: &[f64], a: f64) -> (DVec3, DVec3) {
    let each = || weights.iter().zip(face.corners.iter().zip(&face.normals));
    let p: DVec3 = each().map(|(&w, (&corner, _))| w * corner).sum();
    let projected = |corner: DVec3, n: DVec3| p - (p - corner).dot(n) * n;
    let bent: DVec3 = each()
        .map(|(&w, (&corner, &n))| w * projected(corner, n))
        .sum();
    let normal = each().map(|(&w, (_, &n))| w * n).sum();
    ((1.0 - a) * p + a * bent, normal)
}

#[test]
fn points_are_those_of_the_published_formula() {
    for corners in [3, 4] {
        let off = |a: f64| {
            worst(&METHOD, corners, |face, uv| {
                phong(face, &weights(corners, uv), a)
            })
        };
        let [far, turned] = off(0.75);
        println!("{corners} corners: {far:.1e} of the diagonal, {turned:.1e} radians");
        assert!(far <= NEAR && turned <= TURNED, "{far} {turned}");
        let [far, _] = off(0.7501);
        assert!(far > NEAR, "nobody sees another share");
    }
}

#[test]
fn corners_keep_their_normals_and_no_others() {
    for corners in [3, 4] {
        for number in 0..corners {
            let [far, turned] = worst(&METHOD, corners, |face, uv| {
                let mut normals = face.normals.clone();
                normals[number] = (normals[number] + DVec3::new(1e-3, -2e-3, 1e-3)).normalize();
                let corners = face.corners.clone();
                let tilted = Face { corners, normals };
                phong(&tilted, &weights(tilted.corners.len(), uv), 0.75)
            });
            assert!(
                far > NEAR && turned > TURNED,
                "nobody sees normal {number} tilt"
            );
        }
    }
}
