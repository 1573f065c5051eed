//! The published closed forms, in f64.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2};

use super::METHOD;
use crate::mesh::Model;
use crate::method::spokes::tests::ball;
use crate::plan::PlanOptions;

/// The vertex at a corner of a face with what surrounds it, counter-clockwise from the edge that leaves the corner.
struct Around {
    vertex: DVec3,
    ends: Vec<DVec3>,
    fars: Vec<DVec3>,
}

fn around(model: &Model, face: u32, corner: u32) -> Around {
    let topology = model.topology();
    let at = |vertex: u32| {
        model
            .placement()
            .local(model.mesh().positions()[vertex as usize])
    };
    let fan = topology.fan(face, corner);
    assert!(fan.closed);
    let n = fan.edges.len();
    let in_turn = |i: usize| (fan.at + i) % n;
    let end = |i: usize| at(topology.edge(fan.edges[in_turn(i)]).other(fan.vertex));
    let far = |i: usize| {
        let corners = topology.face(fan.faces[in_turn(i)]);
        let own = corners
            .iter()
            .position(|&v| v == fan.vertex)
            .expect("it is one");
        at(corners[(own + 2) % 4])
    };
    Around {
        vertex: at(fan.vertex),
        ends: (0..n).map(end).collect(),
        fars: (0..n).map(far).collect(),
    }
}

impl Around {
    fn n(&self) -> usize {
        self.ends.len()
    }

    /// Section 3: the point inside of face i.
    fn inner(&self, i: usize) -> DVec3 {
        let n = self.n();
        (n as f64 * self.vertex + 2.0 * (self.ends[i] + self.ends[(i + 1) % n]) + self.fars[i])
            / (n as f64 + 5.0)
    }

    /// On edge i.
    fn on_edge(&self, i: usize) -> DVec3 {
        0.5 * (self.inner(i) + self.inner((i + self.n() - 1) % self.n()))
    }

    fn corner(&self) -> DVec3 {
        (0..self.n()).map(|i| self.inner(i)).sum::<DVec3>() / self.n() as f64
    }

    /// Section 4: the tangent along edge `towards`.
    fn tangent(&self, towards: usize) -> DVec3 {
        let n = self.n() as f64;
        let root = (4.0 + (PI / n).cos().powi(2)).sqrt();
        let term = |i: usize| {
            let turn = TAU * (i as f64 - towards as f64) / n;
            let alpha = (1.0 / n + (PI / n).cos() / (n * root)) * turn.cos();
            let beta = (turn + PI / n).cos() / (n * root);
            alpha * self.ends[i] + beta * self.fars[i]
        };
        (0..self.n()).map(term).sum()
    }

    fn c(&self) -> f64 {
        (TAU / self.n() as f64).cos()
    }
}

/// Sixteen points, v by v.
type Net = [[DVec3; 4]; 4];

fn net(around: &[Around; 4]) -> Net {
    let p: Vec<DVec3> = around.iter().map(Around::corner).collect();
    let plus: Vec<DVec3> = around.iter().map(|a| a.on_edge(0)).collect();
    let minus: Vec<DVec3> = around.iter().map(|a| a.on_edge(1)).collect();
    let b: Vec<DVec3> = around.iter().map(|a| a.inner(0)).collect();
    [
        [p[0], plus[0], minus[1], p[1]],
        [minus[0], b[0], b[1], plus[1]],
        [plus[3], b[3], b[2], minus[2]],
        [p[3], minus[3], plus[2], p[2]],
    ]
}

/// The tangents by u, three by four, as section 4 has them: `around` begins at the corner (0, 0), and goes counter-clockwise.
fn by_u(b: &Net, around: &[Around; 4]) -> [[DVec3; 3]; 4] {
    let mut u: [[DVec3; 3]; 4] =
        std::array::from_fn(|j| std::array::from_fn(|i| 3.0 * (b[j][i + 1] - b[j][i])));
    u[0][0] = around[0].tangent(0);
    u[0][2] = -around[1].tangent(1);
    u[3][2] = -around[2].tangent(0);
    u[3][0] = around[3].tangent(1);
    // Across the sides where u is 0 and 1: their own tangents run up in v, and x is as the bicubic points have it.
    for (side, [low, high], [from, to]) in [(0, [0, 3], [1, 0]), (2, [1, 2], [0, 1])] {
        let column = if side == 0 { 0 } else { 3 };
        let first = around[low].tangent(from);
        let last = -around[high].tangent(to);
        let middle = 3.0 * (b[2][column] - b[1][column]);
        let (c0, c1) = (around[low].c(), around[high].c());
        // The sum over both faces, halved, points to the left on one of the sides and to the right on the other.
        let sign = if side == 0 { 1.0 } else { -1.0 };
        u[1][side] += sign * (2.0 * c0 * middle - c1 * first) / 3.0;
        u[2][side] += sign * (c0 * last - 2.0 * c1 * middle) / 3.0;
    }
    u
}

fn bernstein<const N: usize>(t: f64) -> [f64; N] {
    let s = 1.0 - t;
    match N {
        3 => std::array::from_fn(|i| [s * s, 2.0 * s * t, t * t][i]),
        _ => std::array::from_fn(|i| [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t][i]),
    }
}

fn at<const N: usize>(rows: &[[DVec3; N]; 4], u: f64, v: f64) -> DVec3 {
    let (in_u, in_v) = (bernstein::<N>(u), bernstein::<4>(v));
    let row = |j: usize| -> DVec3 { (0..N).map(|i| in_u[i] * rows[j][i]).sum() };
    (0..4).map(|j| in_v[j] * row(j)).sum()
}

#[test]
fn patches_have_the_published_points_and_tangents() {
    let model = ball();
    let prepared = METHOD
        .prepare(&model, PlanOptions::default())
        .expect("it is smooth");
    let controls = prepared.controls(model.positions());
    let pass = &prepared.passes[0];
    let (mut off, mut turned) = (0.0f64, 0.0f64);
    for face in 0..model.topology().face_count() as u32 {
        let corners = [0, 1, 2, 3].map(|i| around(&model, face, i));
        let b = net(&corners);
        let u_patch = by_u(&b, &corners);
        // By v is by u of the patch that is turned by a quarter: its u is v, and its v is 1 - u.
        let [first, second, third, fourth] = corners;
        let turned_corners = [second, third, fourth, first];
        let turned_net: Net = std::array::from_fn(|j| std::array::from_fn(|i| b[i][3 - j]));
        let v_patch = by_u(&turned_net, &turned_corners);
        for [u, v] in [
            [0.5, 0.5],
            [0.25, 0.125],
            [0.875, 0.25],
            [0.75, 0.875],
            [0.125, 0.5],
        ] {
            let point = pass.evaluate(&controls, face as usize, Vec2::new(u as f32, v as f32));
            let normal = at(&u_patch, u, v).cross(at(&v_patch, v, 1.0 - u));
            off = off.max(point.position.as_dvec3().distance(at(&b, u, v)) / model.diagonal());
            turned = turned.max(point.normal.as_dvec3().angle_between(normal));
        }
    }
    println!("{off:.1e} of the diagonal, {turned:.1e} radians");
    assert!(off < 1e-6 && turned < 1e-4, "{off} {turned}");
}
