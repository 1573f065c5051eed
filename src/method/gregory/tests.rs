//! The published closed forms, in f64.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2};

use super::{Domain, METHOD, net};
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::edge_field::Numbers;
use crate::method::spokes::tests::{ball, triangular_ball};
use crate::plan::PlanOptions;

/// The vertex at a corner of a face with what surrounds it, counter-clockwise from the edge that leaves the corner.
struct Around {
    vertex: DVec3,
    middles: Vec<DVec3>,
    centres: Vec<DVec3>,
}

fn around(model: &Model, topology: &Topology, face: u32, corner: u32) -> Around {
    let at = |vertex: u32| {
        model
            .placement()
            .local(model.mesh().positions()[vertex as usize])
    };
    let fan = topology.fan(face, corner);
    assert!(fan.closed);
    let n = fan.edges.len();
    let in_turn = |i: usize| (fan.at + i) % n;
    let vertex = at(fan.vertex);
    let middle = |i: usize| {
        let end = topology.edge(fan.edges[in_turn(i)]).other(fan.vertex);
        0.5 * (vertex + at(end))
    };
    let centre = |i: usize| {
        let corners = topology.face(fan.faces[in_turn(i)]);
        corners.iter().map(|&v| at(v)).sum::<DVec3>() / corners.len() as f64
    };
    Around {
        vertex,
        middles: (0..n).map(middle).collect(),
        centres: (0..n).map(centre).collect(),
    }
}

impl Around {
    fn n(&self) -> f64 {
        self.middles.len() as f64
    }

    /// Section 3.1.
    fn p(&self) -> DVec3 {
        let n = self.n();
        let sum: DVec3 = self.middles.iter().chain(&self.centres).sum();
        (n - 3.0) / (n + 5.0) * self.vertex + 4.0 / (n * (n + 5.0)) * sum
    }

    /// The point next to it along edge `towards`.
    fn e(&self, towards: usize) -> DVec3 {
        let n = self.n();
        let sigma = 1.0 / (4.0 + (PI / n).cos().powi(2)).sqrt();
        let lambda =
            (5.0 + (TAU / n).cos() + (PI / n).cos() * (18.0 + 2.0 * (TAU / n).cos()).sqrt()) / 16.0;
        let term = |i: usize| {
            let turn = TAU * (i as f64 - towards as f64) / n;
            (1.0 - sigma * (PI / n).cos()) * turn.cos() * self.middles[i]
                + 2.0 * sigma * (turn + PI / n).cos() * self.centres[i]
        };
        let q = 2.0 / n * (0..self.middles.len()).map(term).sum::<DVec3>();
        self.p() + 2.0 / 3.0 * lambda * q
    }

    /// Section 3.2: r of edge i; on the left of the edge for the face that it leaves, on the right for the one before.
    fn r(&self, i: usize) -> DVec3 {
        let n = self.middles.len();
        let [next, last] = [(i + 1) % n, (i + n - 1) % n];
        (self.middles[next] - self.middles[last]) / 3.0
            + 2.0 / 3.0 * (self.centres[i] - self.centres[last])
    }

    fn c(&self) -> f64 {
        (TAU / self.n()).cos()
    }
}

/// Positions at (u, v), by the paper's twenty points.
fn published(around: &[Around; 4], u: f64, v: f64) -> DVec3 {
    let n = |i: usize| around[i].middles.len();
    let p: [DVec3; 4] = std::array::from_fn(|i| around[i].p());
    // The edge before the one that leaves the corner is the next around the vertex.
    let plus: [DVec3; 4] = std::array::from_fn(|i| around[i].e(0));
    let minus: [DVec3; 4] = std::array::from_fn(|i| around[i].e(1 % n(i)));
    let c: [f64; 4] = std::array::from_fn(|i| around[i].c());
    let f = |own: usize, other: usize, [e, beyond]: [DVec3; 2], r: DVec3| {
        (c[other] * p[own] + (3.0 - 2.0 * c[own] - c[other]) * e + 2.0 * c[own] * beyond + r) / 3.0
    };
    let f_plus: [DVec3; 4] = std::array::from_fn(|i| {
        let j = (i + 1) % 4;
        f(i, j, [plus[i], minus[j]], around[i].r(0))
    });
    let f_minus: [DVec3; 4] = std::array::from_fn(|i| {
        let j = (i + 3) % 4;
        f(i, j, [minus[i], plus[j]], -around[i].r(1 % n(i)))
    });
    let (s, t) = (1.0 - u, 1.0 - v);
    let blend = |i: usize, a: f64, b: f64| (a * f_plus[i] + b * f_minus[i]) / (a + b);
    let inner = [
        blend(0, u, v),
        blend(1, v, s),
        blend(2, s, t),
        blend(3, t, u),
    ];
    let rows = [
        [p[0], plus[0], minus[1], p[1]],
        [minus[0], inner[0], inner[1], plus[1]],
        [plus[3], inner[3], inner[2], minus[2]],
        [p[3], minus[3], plus[2], p[2]],
    ];
    let cubic = |s: f64, t: f64| [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
    let (by_u, by_v) = (cubic(s, u), cubic(t, v));
    let row = |row: &[DVec3; 4]| -> DVec3 { (0..4).map(|k| by_u[k] * row[k]).sum() };
    (0..4).map(|j| by_v[j] * row(&rows[j])).sum()
}

#[test]
fn quads_have_the_published_points_and_their_own_normals() {
    let model = ball();
    let topology = model.topology();
    let prepared = METHOD
        .prepare(&model, PlanOptions::default())
        .expect("it is smooth");
    let controls = prepared.controls(model.positions());
    let pass = &prepared.passes[0];
    let (mut off, mut turned, mut valences) = (0.0f64, 0.0f64, [0; 8]);
    for face in 0..topology.face_count() as u32 {
        let around: [Around; 4] = std::array::from_fn(|i| around(&model, topology, face, i as u32));
        valences[around[0].middles.len()] += 1;
        for [u, v] in [
            [0.5, 0.5],
            [0.25, 0.125],
            [0.875, 0.25],
            [0.75, 0.875],
            [0.125, 0.5],
        ] {
            let point = pass.evaluate(&controls, face as usize, Vec2::new(u as f32, v as f32));
            let at = |u: f64, v: f64| published(&around, u, v);
            let h = 1e-5;
            let normal = (at(u + h, v) - at(u - h, v)).cross(at(u, v + h) - at(u, v - h));
            off = off.max(point.position.as_dvec3().distance(at(u, v)) / model.diagonal());
            turned = turned.max(point.normal.as_dvec3().angle_between(normal));
        }
    }
    println!("{off:.1e} of the diagonal, {turned:.1e} radians, {valences:?}");
    assert!(off < 1e-6 && turned < 1e-4, "{off} {turned}");
    assert!(
        valences[3] > 0 && valences[5] > 0 && valences[6] > 0,
        "{valences:?}"
    );
}

/// Section 3.3, of the patch's own fifteen points.
#[test]
fn triangles_are_quartics_with_their_own_normals() {
    let model = triangular_ball();
    let prepared = METHOD
        .prepare(&model, PlanOptions::default())
        .expect("it is smooth");
    let controls = prepared.controls(model.positions());
    let pass = &prepared.passes[0];
    assert_eq!(pass.domain, Domain::Triangles);
    let (mut off, mut turned) = (0.0f64, 0.0f64);
    for patch in 0..pass.patches.len() {
        let numbers = Numbers::new(pass, &controls, patch, [3, super::PER_EDGE]);
        let net = net::<3>(pass, &numbers, patch);
        let wide = |points: [glam::Vec3; 3]| points.map(|p| p.as_dvec3());
        let (p, near, far) = (wide(net.corners), wide(net.near), wide(net.far));
        let (before, behind) = (wide(net.before), wide(net.behind));
        let at = |v: f64, w: f64| {
            let b = [1.0 - v - w, v, w];
            let mut sum = DVec3::ZERO;
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                let f = (b[j] * before[i] + b[k] * behind[k]) / (b[j] + b[k]);
                sum += b[i].powi(3) * p[i]
                    + 3.0 * b[i] * b[j] * (b[i] + b[j]) * (b[i] * near[i] + b[j] * far[i])
                    + 12.0 * b[0] * b[1] * b[2] * b[i] * f;
            }
            sum
        };
        for [v, w] in [[0.25, 0.25], [0.125, 0.5], [0.75, 0.125], [0.375, 0.375]] {
            let point = pass.evaluate(&controls, patch, Vec2::new(v as f32, w as f32));
            let h = 1e-5;
            let normal = (at(v + h, w) - at(v - h, w)).cross(at(v, w + h) - at(v, w - h));
            off = off.max(point.position.as_dvec3().distance(at(v, w)) / model.diagonal());
            turned = turned.max(point.normal.as_dvec3().angle_between(normal));
        }
    }
    println!("{off:.1e} of the diagonal, {turned:.1e} radians");
    assert!(off < 1e-6 && turned < 1e-4, "{off} {turned}");
}
