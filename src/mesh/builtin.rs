//! Shapes of our own, by name.

mod hull;
mod shapes;
mod sketch;

use crate::error::{Error, Result};
use crate::mesh::ControlMesh;

/// The names of the built-in shapes, each with a line that tells what it shows.
///
/// In `cubes-XxYxZ` and `pole-N` the capital letters stand for numbers, as in `cubes-12x12x10` and `pole-64`.
pub const BUILTINS: &[(&str, &str)] = &[
    (
        "hull",
        "a tugboat: creases, n-gons and an open funnel (the default)",
    ),
    ("cube", "a plain cube"),
    (
        "creased-torus",
        "a torus with three loops of semi-sharp crease",
    ),
    ("sheet", "a wavy sheet with sharp corners and two holes"),
    (
        "ngons",
        "a ball of pentagons, hexagons, quads and triangles",
    ),
    (
        "cubes-XxYxZ",
        "a lattice of separate cubes, a million at most",
    ),
    (
        "pole-N",
        "a fan of 3 to 1000 triangles around one vertex, in a ring of quads",
    ),
];

/// The name of the shape to show when the user names none.
pub const DEFAULT_BUILTIN: &str = "hull";

/// The most cubes in a lattice.
const MOST_CUBES: u64 = 1_000_000;

/// The built-in shape `name`, one of [`BUILTINS`].
///
/// ```
/// let mesh = hullform::mesh::builtin("cubes-2x3x4")?;
/// assert_eq!(mesh.face_count(), 2 * 3 * 4 * 6);
/// # Ok::<(), hullform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Option`] for a name that is not among them, or a number out of range.
pub fn builtin(name: &str) -> Result<ControlMesh> {
    match name {
        "hull" => hull::hull(),
        "cube" => shapes::cube(),
        "creased-torus" => shapes::creased_torus(),
        "sheet" => shapes::sheet(),
        "ngons" => shapes::ngons(),
        _ => {
            if let Some(size) = name.strip_prefix("cubes-") {
                shapes::cubes(lattice(size)?)
            } else if let Some(valence) = name.strip_prefix("pole-") {
                shapes::pole(pole_valence(valence)?)
            } else {
                Err(unknown(name))
            }
        }
    }
}

fn lattice(size: &str) -> Result<[u32; 3]> {
    let counts: Vec<u32> = size
        .split('x')
        .map_while(|count| count.parse().ok())
        .collect();
    let total = |counts: &[u32]| {
        counts
            .iter()
            .try_fold(1u64, |product, &count| product.checked_mul(count.into()))
    };
    match (<[u32; 3]>::try_from(counts), size.split('x').count()) {
        (Ok(counts), 3) if total(&counts).is_some_and(|n| (1..=MOST_CUBES).contains(&n)) => {
            Ok(counts)
        }
        _ => Err(bad(
            format!("\"{size}\" is not the size of a lattice"),
            format!(
                "write cubes-XxYxZ with 1 to {MOST_CUBES} cubes in all, such as cubes-12x12x10"
            ),
        )),
    }
}

fn pole_valence(valence: &str) -> Result<u32> {
    match valence.parse() {
        Ok(valence @ 3..=1000) => Ok(valence),
        _ => Err(bad(
            format!("\"{valence}\" is not the valence of a pole"),
            "write pole-N with N from 3 to 1000, such as pole-64".to_string(),
        )),
    }
}

fn unknown(name: &str) -> Error {
    let names: Vec<&str> = BUILTINS.iter().map(|(name, _)| *name).collect();
    bad(
        format!("there is no shape \"{name}\""),
        format!("the shapes are {}", names.join(", ")),
    )
}

fn bad(problem: String, remedy: String) -> Error {
    Error::Option {
        option: "builtin",
        problem,
        remedy,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{HashMap, HashSet};

    use super::*;
    use crate::mesh::BoundaryInterpolation;

    /// The directed edges, after a check that no two faces share one: all are oriented alike, none is non-manifold.
    fn directed_edges(mesh: &ControlMesh) -> HashSet<[u32; 2]> {
        let mut edges = HashSet::new();
        for face in mesh.faces() {
            for i in 0..face.len() {
                let edge = [face[i], face[(i + 1) % face.len()]];
                assert!(
                    edges.insert(edge),
                    "edge {edge:?} has two faces on one side"
                );
            }
        }
        edges
    }

    fn boundary_edges(mesh: &ControlMesh) -> usize {
        let edges = directed_edges(mesh);
        edges
            .iter()
            .filter(|&&[a, b]| !edges.contains(&[b, a]))
            .count()
    }

    fn sizes(mesh: &ControlMesh) -> HashMap<usize, usize> {
        mesh.faces().fold(HashMap::new(), |mut sizes, face| {
            *sizes.entry(face.len()).or_default() += 1;
            sizes
        })
    }

    /// Six times the volume, positive where faces are counter-clockwise from outside.
    fn volume(mesh: &ControlMesh) -> f64 {
        let p = mesh.positions();
        let fan = |face: &[u32]| {
            let [first, rest @ ..] = face else { return 0.0 };
            let first = p[*first as usize];
            rest.windows(2)
                .map(|pair| first.dot(p[pair[0] as usize].cross(p[pair[1] as usize])))
                .sum::<f64>()
        };
        mesh.faces().map(fan).sum()
    }

    fn shape(name: &str) -> ControlMesh {
        builtin(name).expect(name)
    }

    /// Faces, creases and boundary edges.
    fn counts(mesh: &ControlMesh) -> [usize; 3] {
        [
            mesh.face_count(),
            mesh.creases().len(),
            boundary_edges(mesh),
        ]
    }

    #[test]
    fn plain_shapes() {
        assert_eq!(counts(&shape("cube")), [6, 0, 0]);
        assert_eq!(counts(&shape("creased-torus")), [128, 48, 0]);
        assert_eq!(counts(&shape("sheet")), [64, 0, 32]);
        assert_eq!(counts(&shape("cubes-3x2x1")), [36, 0, 0]);
        assert_eq!(counts(&shape("pole-3")), [6, 0, 3]);
        assert_eq!(counts(&shape("pole-1000")), [2000, 0, 1000]);
        for name in ["cube", "creased-torus", "cubes-3x2x1", "ngons", "hull"] {
            assert!(volume(&shape(name)) > 0.0, "{name} is inside out");
        }
        for name in ["sheet", "pole-7"] {
            let mesh = shape(name);
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions()[mesh.face(0)[i] as usize]);
            assert!((b - a).cross(c - a).y > 0.0, "{name} faces down");
        }
        let sheet = shape("sheet");
        assert_eq!(sheet.holes().len(), 2);
        assert_eq!(
            sheet.options().boundary,
            BoundaryInterpolation::EdgeAndCorner
        );
    }

    #[test]
    fn ngons_has_four_kinds_of_face() {
        let mesh = shape("ngons");
        assert_eq!(
            sizes(&mesh),
            HashMap::from([(3, 36), (4, 14), (5, 12), (6, 7)])
        );
        assert_eq!(counts(&mesh), [69, 60, 0]);
        let edges = directed_edges(&mesh).len() / 2;
        assert_eq!(mesh.vertex_count() + mesh.face_count() - edges, 2);
    }

    #[test]
    fn hull_has_everything() {
        let mesh = shape(DEFAULT_BUILTIN);
        let sizes = sizes(&mesh);
        assert_eq!(boundary_edges(&mesh), 8);
        assert_eq!((sizes[&8], sizes[&3]), (6, 24));
        assert!((500..1000).contains(&mesh.face_count()), "{sizes:?}");
        let is_infinite = |sharpness: f32| sharpness >= crate::mesh::INFINITE_SHARPNESS;
        assert!(
            mesh.creases()
                .iter()
                .any(|crease| is_infinite(crease.sharpness))
        );
        assert!(
            mesh.creases()
                .iter()
                .any(|crease| !is_infinite(crease.sharpness))
        );
        let used: HashSet<u32> = mesh.faces().flatten().copied().collect();
        assert_eq!(used.len(), mesh.vertex_count());
        let edges = directed_edges(&mesh);
        let undirected = edges
            .iter()
            .filter(|&&[a, b]| a < b || !edges.contains(&[b, a]));
        // One shell with one opening: a disc.
        assert_eq!(
            mesh.vertex_count() + mesh.face_count() - undirected.count(),
            1
        );
    }

    #[test]
    fn every_listed_name_works() {
        for (name, _) in BUILTINS {
            shape(&name.replace("XxYxZ", "1x2x3").replace('N', "8"));
        }
    }

    #[test]
    fn bad_names_are_told_what_is_right() {
        let names = [
            "",
            "Cube",
            "cubes-",
            "cubes-2x2",
            "cubes-0x2x2",
            "cubes-1x2x3x4",
            "cubes-101x100x100",
            "cubes-4294967295x4294967295x4294967295",
            "cubes-2x-2x2",
            "pole-",
            "pole-2",
            "pole-1001",
            "pole-x",
        ];
        for name in names {
            let message = builtin(name).expect_err(name).to_string();
            assert!(message.starts_with("builtin: "), "{message}");
        }
        let message = builtin("teapot").expect_err("no teapot").to_string();
        assert!(message.contains("hull, cube, creased-torus"), "{message}");
    }
}
