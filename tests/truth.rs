//! The truth against the reference limits of the shared shapes, point by point.
//!
//! Positions and derivatives agree to the references' own precision. Normals at ptex corners are compared apart: the references
//! differentiate numerically there, after nine refinements. See [`Corner::slow`] for where that is not yet the limit.

mod common;

use std::path::Path;

use common::fan_at;
use glam::DVec3;
use hullform::mesh::sharpness::is_infinite;
use hullform::mesh::topology::Topology;
use hullform::mesh::{ControlMesh, Scheme, read_obj};
use hullform::subdivision::LimitSurface;

/// Shapes whose faces name a vertex twice; the reader refuses them.
const REFUSED: [&str; 2] = ["catmark_nonman_quadpole8", "catmark_nonman_edges"];

/// One line of a reference: ptex face, parameters, and position and derivatives there, if there is a limit at all.
struct Reference {
    ptex: usize,
    uv: [f64; 2],
    limit: Option<Limit>,
}

struct Limit {
    position: DVec3,
    du: DVec3,
    dv: DVec3,
}

fn references(path: &Path) -> Vec<Reference> {
    let text = std::fs::read_to_string(path.with_extension("limit.txt"))
        .expect("each shape has its reference");
    text.lines().map(parse).collect()
}

fn parse(line: &str) -> Reference {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words[i].parse::<f64>().expect("references hold numbers");
    let vector = |i: usize| DVec3::new(number(i), number(i + 1), number(i + 2));
    let limit = (words[3] != "none").then(|| Limit {
        position: vector(3),
        du: vector(6),
        dv: vector(9),
    });
    Reference {
        ptex: number(0) as usize,
        uv: [number(1), number(2)],
        limit,
    }
}

/// The corner of a ptex face.
#[derive(Default)]
struct Corner {
    /// The end of an infinitely sharp crease inside the mesh.
    dart: bool,
    /// An interior vertex of two faces.
    valence_two: bool,
    /// Where the references' normals have not converged: at darts; and at corners in a sector of several faces, where the surface has a
    /// cusp or two modes contract alike, so that the normal approaches its limit as 0.65^level or 1 / level.
    slow: bool,
    /// Where derivatives have no length of their own.
    extraordinary: bool,
    /// The corner of a single face, whose normal is that of the surroundings where the limit's differs.
    alone: bool,
}

fn is_whole_triangle(topology: &Topology, face: u32) -> bool {
    topology.face(face).len() == 3 && topology.options().scheme.is_whole(3)
}

/// The control vertex at a corner of a ptex face, if one is there: an n-gon's part has one at (0, 0) only.
fn vertex_at(topology: &Topology, (face, corner): (u32, u32), uv: [f64; 2]) -> Option<(u32, u32)> {
    let quad = topology.face(face).len() == 4;
    let triangle = is_whole_triangle(topology, face);
    match uv {
        [0.0, 0.0] => Some((face, corner)),
        [1.0, 0.0] if triangle => Some((face, 1)),
        [0.0, 1.0] if triangle => Some((face, 2)),
        [1.0, 0.0] if quad => Some((face, 1)),
        [1.0, 1.0] if quad => Some((face, 2)),
        [0.0, 1.0] if quad => Some((face, 3)),
        _ => None,
    }
}

fn corner(surface: &LimitSurface, ptex: usize, uv: [f64; 2]) -> Corner {
    let topology = surface.topology();
    let at = surface.face_corner(ptex);
    let at = at.and_then(|at| vertex_at(topology, at, uv));
    let Some((face, corner)) = at else {
        // The centre of an n-gon, the middle of one of its edges, or no corner at all.
        return Corner {
            extraordinary: uv == [1.0, 1.0],
            ..Corner::default()
        };
    };
    let vertex = topology.face(face)[corner as usize];
    let edges = topology.sharp_edges(vertex);
    // What is semi-sharp has decayed in the limit.
    let sharp = edges
        .filter(|&edge| is_infinite(topology.edges()[edge as usize].sharpness))
        .count();
    let sharp_vertex = is_infinite(topology.vertex_sharpness(vertex));
    let faces = fan_at(topology, face, corner).faces.len();
    let dart = sharp == 1 && !sharp_vertex;
    let (inside, beside) = match is_whole_triangle(topology, face) {
        true => (6, 3),
        false => (4, 2),
    };
    let regular = match sharp {
        _ if sharp_vertex => 1,
        0 => inside,
        2 => beside,
        _ => 1,
    };
    Corner {
        dart,
        valence_two: sharp == 0 && topology.vertex_edges(vertex).len() == 2,
        slow: dart || (sharp_vertex || sharp > 2) && faces > 1,
        extraordinary: dart || faces != regular,
        alone: faces == 1,
    }
}

/// The angle between two normals in degrees; none where the reference's tangents are parallel but for rounding.
fn angle(ours: DVec3, reference: &Limit) -> f64 {
    let normal = reference
        .du
        .normalize_or_zero()
        .cross(reference.dv.normalize_or_zero());
    if normal.length() < 1e-6 {
        return 0.0;
    }
    ours.angle_between(normal).to_degrees()
}

/// Holds one reference against the truth; whether it has a limit.
fn hold(name: &str, surface: &LimitSurface, diagonal: f64, reference: &Reference) -> bool {
    let &Reference { ptex, uv, .. } = reference;
    let place = format!("{name}, ptex face {ptex} at {uv:?}");
    let sample = surface.evaluate(ptex, uv[0], uv[1]);
    assert_eq!(
        sample.is_some(),
        reference.limit.is_some(),
        "{place}: a limit or none"
    );
    let (Some(sample), Some(limit)) = (sample, &reference.limit) else {
        return false;
    };
    let corner = corner(surface, ptex, uv);
    let bound = match corner {
        Corner { dart: true, .. } => 2e-5,
        Corner {
            valence_two: true, ..
        } => 5e-7,
        _ => 1e-9,
    };
    let distance = sample.position.distance(limit.position) / diagonal;
    assert!(distance <= bound, "{place}: {distance:.1e} off");
    if uv.iter().all(|x| x.fract() == 0.0) {
        let normal = match corner.alone {
            true => sample.du.normalize().cross(sample.dv.normalize()),
            false => sample.normal(),
        };
        let angle = angle(normal, limit);
        assert!(corner.slow || angle <= 0.01, "{place}: {angle:.4} degrees");
    }
    if !corner.extraordinary {
        for (ours, theirs) in [(sample.du, limit.du), (sample.dv, limit.dv)] {
            let distance = ours.distance(theirs) / diagonal;
            assert!(distance <= 1e-8, "{place}: derivative {distance:.1e} off");
        }
    }
    true
}

fn compare(name: &str, mesh: &ControlMesh, references: &[Reference]) {
    let surface = LimitSurface::new(mesh);
    let points = match mesh.options().scheme.is_triangular() {
        true => 15,
        false => 25,
    };
    assert_eq!(references.len(), points * surface.ptex_count(), "{name}");
    let limits = references
        .iter()
        .filter(|reference| hold(name, &surface, common::diagonal(mesh), reference));
    assert!(limits.count() > 0, "{name} has no limit anywhere");
}

#[test]
fn limits_agree_with_the_references_of_every_shape() {
    let files = common::obj_files("shapes");
    let mut compared = 0;
    for path in &files {
        let name = common::stem(path);
        let scheme = Scheme::of_file(path).expect("shapes are named after their schemes");
        let mesh = read_obj(path).and_then(|mesh| mesh.with_scheme(scheme));
        assert_eq!(
            mesh.is_err(),
            REFUSED.contains(&name.as_str()),
            "{name} is refused, or not"
        );
        if let Ok(mesh) = mesh {
            compare(&name, &mesh, &references(path));
            compared += 1;
        }
    }
    // `obj_files` has said so when the shapes are missing; where they exist, most must have been compared.
    assert!(
        files.is_empty() || compared >= 50,
        "only {compared} shapes were compared"
    );
}
