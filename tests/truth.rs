//! The truth against OpenSubdivision's limits of the shared shapes.

mod common;

use glam::DVec3;
use hullform::mesh::{ControlMesh, read_obj};
use hullform::subdivision::{LimitSurface, Scheme};

/// One line of a reference: ptex face, parameters, and what OpenSubdiv found there.
struct Reference {
    face: usize,
    uv: [f64; 2],
    limit: Option<[DVec3; 3]>,
}

fn references(path: &std::path::Path) -> Vec<Reference> {
    let text = std::fs::read_to_string(path.with_extension("limit.txt"))
        .expect("each shape has its reference");
    text.lines().map(parse).collect()
}

fn parse(line: &str) -> Reference {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words[i].parse::<f64>().expect("references hold numbers");
    let vector = |i: usize| DVec3::new(number(i), number(i + 1), number(i + 2));
    let limit = (words[3] != "none").then(|| [vector(3), vector(6), vector(9)]);
    Reference {
        face: number(0) as usize,
        uv: [number(1), number(2)],
        limit,
    }
}

/// How far our limit of a shape is from the reference: positions over the diagonal, and normals in degrees.
fn compare(name: &str, mesh: &ControlMesh, references: &[Reference], scheme: Scheme) -> (f64, f64) {
    let surface = LimitSurface::of_scheme(mesh, scheme);
    let diagonal = common::diagonal(mesh);
    let mut worst = (0.0f64, 0.0f64);
    for reference in references {
        let [u, v] = reference.uv;
        let sample = surface.evaluate(reference.face, u, v);
        let (Some(sample), Some([position, du, dv])) = (sample, reference.limit) else {
            assert_eq!(
                sample.is_none(),
                reference.limit.is_none(),
                "{name} face {} ({u}, {v})",
                reference.face
            );
            continue;
        };
        let distance = sample.position.distance(position) / diagonal;
        let normal = du.normalize().cross(dv.normalize());
        let angle = if normal.length() < 1e-6 {
            0.0
        } else {
            sample.normal().angle_between(normal).to_degrees()
        };
        if std::env::var("VERBOSE").is_ok() && (distance > 1e-9 || angle > 1e-3) {
            eprintln!(
                "{name} face {} ({u}, {v}): {distance:.1e}, {angle:.4} degrees",
                reference.face
            );
        }
        worst = (worst.0.max(distance), worst.1.max(angle));
    }
    worst
}

#[test]
fn limits_agree_with_opensubdiv() {
    for path in common::obj_files("shapes") {
        let name = common::stem(&path);
        let scheme = if name.starts_with("bilinear") {
            Scheme::Bilinear
        } else {
            Scheme::CatmullClark
        };
        let Ok(mesh) = read_obj(&path) else {
            eprintln!("refused {name}");
            continue;
        };
        if name.starts_with("loop") {
            continue;
        }
        let (distance, angle) = compare(&name, &mesh, &references(&path), scheme);
        eprintln!("{name:32} {distance:.1e} {angle:.1e}");
    }
}
