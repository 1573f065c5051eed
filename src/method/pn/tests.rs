//! The published closed forms, in f64.

use glam::DVec3;

use super::METHOD;
use crate::method::vertices::reference::{Face, NEAR, TURNED, worst};

/// Control points and their weights, of positions and of normals.
struct Net {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
}

/// Vlachos, Peters, Boyd, Mitchell 2001, section 3.1: the point at a third of the edge from i to j.
fn b(face: &Face, i: usize, j: usize) -> DVec3 {
    let (p, n) = (&face.corners, &face.normals);
    let w = (p[j] - p[i]).dot(n[i]);
    (2.0 * p[i] + p[j] - w * n[i]) / 3.0
}

/// Section 3.3: the normal in the middle of an edge.
fn h(face: &Face, i: usize, j: usize) -> DVec3 {
    let (p, n) = (&face.corners, &face.normals);
    let along = p[j] - p[i];
    let v = 2.0 * along.dot(n[i] + n[j]) / along.dot(along);
    (n[i] + n[j] - v * along).normalize()
}

fn sum(points: &[DVec3], weights: &[f64]) -> DVec3 {
    assert_eq!(points.len(), weights.len());
    points.iter().zip(weights).map(|(&p, &w)| w * p).sum()
}

/// The ten points b300, b030, b003, b210, b120, b021, b012, b102, b201, b111 and the six normals n200, n020, n002, n110, n011, n101.
fn triangle(face: &Face) -> Net {
    let p = &face.corners;
    let edges = [(0, 1), (1, 0), (1, 2), (2, 1), (2, 0), (0, 2)].map(|(i, j)| b(face, i, j));
    let e = edges.iter().sum::<DVec3>() / 6.0;
    let v = p.iter().sum::<DVec3>() / 3.0;
    let b111 = e + (e - v) / 2.0;
    let between = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| h(face, i, j));
    Net {
        positions: [p, &edges[..], &[b111]].concat(),
        normals: [&face.normals[..], &between].concat(),
    }
}

fn at_triangle(net: &Net, [u, v]: [f64; 2]) -> (DVec3, DVec3) {
    let w = 1.0 - u - v;
    let cubic = [
        w * w * w,
        u * u * u,
        v * v * v,
        3.0 * w * w * u,
        3.0 * w * u * u,
        3.0 * u * u * v,
        3.0 * u * v * v,
        3.0 * w * v * v,
        3.0 * w * w * v,
        6.0 * u * v * w,
    ];
    // As it is printed, without binomial factors.
    let quadratic = [w * w, u * u, v * v, w * u, u * v, w * v];
    (sum(&net.positions, &cubic), sum(&net.normals, &quadratic))
}

/// Peters 2008: the sixteen points row by row, v first, and the nine normals.
fn quad(face: &Face) -> Net {
    let p = &face.corners;
    let [b10, b20] = [b(face, 0, 1), b(face, 1, 0)];
    let [b31, b32] = [b(face, 1, 2), b(face, 2, 1)];
    let [b23, b13] = [b(face, 2, 3), b(face, 3, 2)];
    let [b02, b01] = [b(face, 3, 0), b(face, 0, 3)];
    let q = b10 + b20 + b31 + b32 + b23 + b13 + b02 + b01;
    let inner = |i: usize, near: [DVec3; 2], opposite: [DVec3; 2]| {
        let e = (2.0 * (near[0] + near[1] + q) - (opposite[0] + opposite[1])) / 18.0;
        let v = (4.0 * p[i] + 2.0 * (p[(i + 1) % 4] + p[(i + 3) % 4]) + p[(i + 2) % 4]) / 9.0;
        e + (e - v) / 2.0
    };
    let b11 = inner(0, [b10, b01], [b32, b23]);
    let b21 = inner(1, [b20, b31], [b13, b02]);
    let b22 = inner(2, [b32, b23], [b10, b01]);
    let b12 = inner(3, [b13, b02], [b20, b31]);
    let n = &face.normals;
    let [n10, n21, n12, n01] = [(0, 1), (1, 2), (2, 3), (3, 0)].map(|(i, j)| h(face, i, j));
    let n11 = (2.0 * (n10 + n21 + n12 + n01) + n.iter().sum::<DVec3>()) / 12.0;
    Net {
        positions: vec![
            p[0], b10, b20, p[1], b01, b11, b21, b31, b02, b12, b22, b32, p[3], b13, b23, p[2],
        ],
        normals: vec![n[0], n10, n[1], n01, n11, n21, n[3], n12, n[2]],
    }
}

fn at_quad(net: &Net, [u, v]: [f64; 2]) -> (DVec3, DVec3) {
    let cubic = |t: f64| {
        let s = 1.0 - t;
        vec![s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let quadratic = |t: f64| vec![(1.0 - t) * (1.0 - t), t * (1.0 - t), t * t];
    let products = |in_u: Vec<f64>, in_v: Vec<f64>| -> Vec<f64> {
        let rows = in_v.iter();
        rows.flat_map(|&y| in_u.iter().map(move |&x| x * y))
            .collect()
    };
    (
        sum(&net.positions, &products(cubic(u), cubic(v))),
        sum(&net.normals, &products(quadratic(u), quadratic(v))),
    )
}

/// Holds the method to nets, and sees each of their points move.
fn hold(
    corners: usize,
    net: fn(&Face) -> Net,
    at: fn(&Net, [f64; 2]) -> (DVec3, DVec3),
    [positions, normals]: [usize; 2],
) {
    let [off, turned] = worst(&METHOD, corners, |face, uv| at(&net(face), uv));
    println!("{corners} corners: {off:.1e} of the diagonal, {turned:.1e} radians");
    assert!(off <= NEAR && turned <= TURNED, "{off} {turned}");
    let moved = DVec3::new(3e-4, -2e-4, 1e-4);
    for number in 0..positions {
        let [off, _] = worst(&METHOD, corners, |face, uv| {
            let mut net = net(face);
            net.positions[number] += moved;
            at(&net, uv)
        });
        assert!(off > NEAR, "nobody sees control point {number} move");
    }
    for number in 0..normals {
        let [_, turned] = worst(&METHOD, corners, |face, uv| {
            let mut net = net(face);
            net.normals[number] += 10.0 * moved;
            at(&net, uv)
        });
        assert!(turned > TURNED, "nobody sees normal {number} move");
    }
}

#[test]
fn triangles_have_the_published_control_points() {
    hold(3, triangle, at_triangle, [10, 6]);
}

#[test]
fn quads_have_the_published_control_points() {
    hold(4, quad, at_quad, [16, 9]);
}

/// What the published inner points do to a unit square, see [`super::inner_points`].
#[test]
fn inner_points_of_a_square_are_pulled_in() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let square = Face {
        corners: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
        normals: vec![DVec3::Z; 4],
    };
    let net = quad(&square);
    assert!(net.positions.iter().all(|point| point.z == 0.0));
    for (number, at) in [(5, [5.0, 5.0]), (6, [7.0, 5.0]), (10, [7.0, 7.0])] {
        let [x, y] = at.map(|twelfths: f64| twelfths / 12.0);
        assert!(net.positions[number].distance(DVec3::new(x, y, 0.0)) < 1e-12);
    }
}
