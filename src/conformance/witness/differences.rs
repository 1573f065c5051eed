//! Normals stand upright on the surface, as differences of what was captured tell it.

use glam::DVec3;

use super::drawn::{Patch, diagonal, each_patch, noise_at_corners, normal, position};
use super::{Looked, Rule, Subject};
use crate::abi::Captured;
use crate::conformance::{Check, Context};
use crate::error::Result;
use crate::mesh::Scheme;
use crate::method::{Method, MethodOptions, Reproduces, TableNormals, TableOptions};
use crate::tessellation::Domain;

pub(super) const RULE: Rule = Rule {
    name: "differences",
    rule: "normals are at right angles to central differences of the positions beside them, within half the greatest second difference there",
    source: "Taylor's theorem",
    concerns: has_rows,
    options: own_normals,
    look,
};

/// Whether normals are those of the surface itself, and not made to look smooth.
pub(super) fn has_own_normals(method: &Method, _: Scheme) -> bool {
    matches!(
        method.contract.reproduces,
        Reproduces::Limit(_)
            | Reproduces::LimitOnLattice(_)
            | Reproduces::LimitBesideCaps(_)
            | Reproduces::Faces(_)
    )
}

/// The same, where a face is one patch with as many rows as are asked for. Of pieces the smallest have two, which tell no second difference.
fn has_rows(method: &Method, scheme: Scheme) -> bool {
    has_own_normals(method, scheme) && !method.isolates
}

/// Options that make them so.
pub(super) fn own_normals(_: &Method) -> MethodOptions {
    let normals = TableNormals::Geometric;
    TableOptions {
        normals,
        ..Default::default()
    }
    .into()
}

/// Tables have rows for this level, so that nothing is taken between them.
const LEVEL: f32 = 16.0;

fn look(context: &Context, subject: &Subject<'_>, check: &mut Check) -> Result<Looked> {
    let mut looked = Looked::default();
    let scale = diagonal(subject.model);
    each_patch(context, subject, LEVEL, turned, |patch| {
        // Parts of faces have half of the segments, and edges may have one more than the inside: then there are fewer rows.
        let bottom = patch.vertices.iter().filter(|vertex| vertex.uv[1] == 0.0);
        let segments = bottom.count() as u32 - 1;
        let grid = patch.grid(segments);
        let (name, ptex) = (subject.method.name, patch.ptex());
        let mut rows = 0;
        for line in lines(patch.pass.domain, segments) {
            let line: Option<Vec<&Captured>> =
                line.iter().map(|place| grid.get(place).copied()).collect();
            let Some(line) = line else { continue };
            rows += 1;
            looked.add(hold_line(check, subject, patch, &line, scale));
        }
        check.hold(rows > 0, || {
            format!("{name}, ptex face {ptex}: no row of vertices is whole")
        });
        Ok(())
    })?;
    Ok(looked)
}

/// The rows and columns of a square, the edges of a triangle, whose inside has no rows.
fn lines(domain: Domain, segments: u32) -> Vec<Vec<[u32; 2]>> {
    let steps = || 0..=segments;
    let line = |place: &dyn Fn(u32) -> [u32; 2]| steps().map(place).collect::<Vec<_>>();
    match domain {
        Domain::Quads => steps()
            .flat_map(|k| [line(&|i| [i, k]), line(&|i| [k, i])])
            .collect(),
        Domain::Triangles => vec![
            line(&|i| [i, 0]),
            line(&|i| [0, i]),
            line(&|i| [i, segments - i]),
        ],
    }
}

/// Holds the normals inside of a row to the chord between the vertices on both sides.
///
/// With unit steps, P(i + 1) - P(i - 1) = 2 P'(i) + the integral of (P'' (t) (1 - |t - i|)) taken with opposite signs on both sides. The second
/// difference at i is the same integral with equal signs, so half of it bounds the difference between the chord's half and the tangent wherever
/// one side bends and the other does not, which is the worst; where both bend in opposite ways, the second differences beside it tell.
fn hold_line(
    check: &mut Check,
    subject: &Subject<'_>,
    patch: &Patch<'_>,
    line: &[&Captured],
    scale: f64,
) -> Looked {
    let points: Vec<DVec3> = line.iter().map(|vertex| position(vertex)).collect();
    let seconds: Vec<f64> = points
        .windows(3)
        .map(|p| (p[2] - 2.0 * p[1] + p[0]).length())
        .collect();
    let degrees = subject.method.contract.normals.unwrap_or(0.1);
    let mut looked = Looked::default();
    for i in 1..points.len() - 1 {
        let chord = 0.5 * (points[i + 1] - points[i - 1]);
        let beside = &seconds[i.saturating_sub(2)..(i + 1).min(seconds.len())];
        let bend = 0.5 * beside.iter().copied().fold(0.0, f64::max);
        // Positions are good to a part in a million of the model, and normals to the contract's angle.
        let bound = bend + 2e-6 * scale + chord.length() * degrees.to_radians().sin();
        let off = normal(line[i]).dot(chord).abs();
        check.hold(off <= bound, || {
            let Subject { method, .. } = subject;
            let (uv, ptex) = (line[i].uv, patch.ptex());
            let sine = off / chord.length();
            let most = bound / chord.length();
            format!("{}, {uv:?} of ptex face {ptex}: a normal and a chord have a cosine of {sine:.3e}, above {most:.3e}", method.name)
        });
        looked.at(off / scale);
    }
    looked
}

/// Noise at corners would not be seen here: it is the inside that is looked at.
fn turned(vertex: &mut Captured) {
    noise_at_corners(vertex);
    let [x, y, z] = vertex.normal;
    vertex.normal = [y, z, x];
}
