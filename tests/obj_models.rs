//! Reads the shared models and shapes, where the folder exists.

use std::path::{Path, PathBuf};

use hullform::mesh::{BoundaryInterpolation, read_obj};

/// The OBJ files of `../shared/FOLDER`; none, and a word about it, where the folder is missing.
fn shared(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared")
        .join(folder);
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: there is no {}", folder.display());
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "obj"))
        .collect();
    files.sort();
    files
}

fn stem(path: &Path) -> &str {
    path.file_stem()
        .and_then(|stem| stem.to_str())
        .expect("a name")
}

#[test]
fn models_have_their_counts() {
    // Faces, vertices and creases, as their own lines count.
    let expected = [
        ("armorguy", 8639, 10022, 7101),
        ("bigguy", 1450, 1452, 0),
        ("car", 1575, 1642, 314),
        ("monsterfrog", 1292, 1308, 0),
    ];
    let files = shared("models");
    for (path, (name, faces, vertices, creases)) in files.iter().zip(expected) {
        assert_eq!(stem(path), name);
        let mesh = read_obj(path).expect(name);
        let counts = (mesh.face_count(), mesh.vertex_count(), mesh.creases().len());
        assert_eq!(counts, (faces, vertices, creases), "{name}");
    }
}

/// The numbering is the file's: compared with a reading of `v` and `f` lines that knows nothing else.
#[test]
fn order_is_that_of_the_file() {
    for path in shared("models").iter().chain(&shared("shapes")) {
        let Ok(mesh) = read_obj(path) else { continue };
        let text = std::fs::read_to_string(path).expect("text");
        let lines = |keyword: &'static str| {
            text.lines()
                .filter_map(move |line| line.strip_prefix(keyword)?.strip_prefix(' '))
        };
        let positions: Vec<[f64; 3]> = lines("v")
            .map(|line| {
                let mut words = line
                    .split_whitespace()
                    .map(|word| word.parse().expect(word));
                std::array::from_fn(|_| words.next().expect("three coordinates"))
            })
            .collect();
        let faces: Vec<Vec<u32>> = lines("f")
            .map(|line| {
                let first = |word: &str| word.split('/').next().and_then(|v| v.parse::<u32>().ok());
                line.split_whitespace()
                    .map(|word| first(word).expect(word) - 1)
                    .collect()
            })
            .collect();
        let read: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
        assert_eq!(read, positions, "{}", path.display());
        assert!(
            mesh.faces().eq(faces.iter().map(Vec::as_slice)),
            "{}",
            path.display()
        );
    }
}

/// Shapes with a face that names a vertex twice, and what the refusal says.
const REFUSED: [(&str, &str); 2] = [
    (
        "catmark_nonman_edges",
        "catmark_nonman_edges.obj:161: the face names vertex 52 twice",
    ),
    (
        "catmark_nonman_quadpole8",
        "catmark_nonman_quadpole8.obj:19: the face names vertex 5 twice",
    ),
];

fn refused(name: &str) -> Option<&'static str> {
    REFUSED
        .iter()
        .find(|(refused, _)| *refused == name)
        .map(|(_, message)| *message)
}

#[test]
fn shapes_load_but_for_those_with_a_vertex_twice() {
    for path in shared("shapes") {
        let name = stem(&path);
        match (refused(name), read_obj(&path)) {
            (Some(expected), Err(error)) => {
                let message = error.to_string();
                assert!(message.contains(expected), "{message}");
            }
            (Some(_), Ok(_)) => panic!("{name} was accepted"),
            (None, Err(error)) => panic!("{name}: {error}"),
            (None, Ok(_)) => {}
        }
    }
}

#[test]
fn tags_arrive() {
    for path in shared("shapes") {
        let name = stem(&path);
        if refused(name).is_some() {
            continue;
        }
        let mesh = read_obj(&path).expect(name);
        match name {
            "catmark_hole_test1" => assert_eq!(mesh.holes(), [1]),
            "catmark_hole_test3" => assert_eq!(mesh.holes(), [15, 2, 7, 8, 9, 5, 13, 14]),
            "catmark_edgenone" => {
                assert_eq!(mesh.options().boundary, BoundaryInterpolation::None);
            }
            "catmark_edgecorner" => {
                assert_eq!(
                    mesh.options().boundary,
                    BoundaryInterpolation::EdgeAndCorner
                );
            }
            "catmark_cube_corner2" => assert!(!mesh.corners().is_empty()),
            "catmark_fvar_bound2" => assert!(mesh.texture().is_some()),
            _ => {}
        }
    }
}
