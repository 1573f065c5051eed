//! `tobj`, which shares no line with our reader, reads the same models and finds the same.

use std::path::{Path, PathBuf};

use hullform::mesh::{ControlMesh, read_obj, read_obj_bytes};

/// The OBJ files of `../shared/models` and `../shared/shapes`; none where the folder is missing.
fn shared() -> Vec<PathBuf> {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let folders = ["models", "shapes"].map(|folder| std::fs::read_dir(shared.join(folder)));
    let entries = folders.into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.expect("a readable folder").path());
    let mut files: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|extension| extension == "obj"))
        .collect();
    files.sort();
    if files.is_empty() {
        println!("skipped: there is no {}", shared.display());
    }
    files
}

/// Texture coordinates of a face corner, as far as all corners have one.
type Corner = ([f64; 3], Option<[f64; 2]>);

/// What each corner of each face is like. `tobj` numbers vertices anew, and hands out a model a group or material.
fn witnessed(text: &[u8]) -> Vec<Vec<Corner>> {
    let options = tobj::LoadOptions::default();
    let read = tobj::load_obj_buf(&mut &*text, &options, |_| Ok(Default::default()));
    let (models, _) = read.expect("it reads what we read");
    let mut faces = Vec::new();
    for tobj::Model { mesh, .. } in models {
        // No arities at all is how it says that everything is a triangle.
        let arities = match mesh.face_arities.is_empty() {
            true => vec![3; mesh.indices.len() / 3],
            false => mesh.face_arities.clone(),
        };
        let mut at = 0;
        for arity in arities {
            let corners = at..at + arity as usize;
            at = corners.end;
            let corner = |i: usize| {
                let vertex = 3 * mesh.indices[i] as usize;
                let position = std::array::from_fn(|axis| mesh.positions[vertex + axis]);
                let texture = mesh
                    .texcoord_indices
                    .get(i)
                    .map(|&index| 2 * index as usize);
                let value = |at: usize| [mesh.texcoords[at], mesh.texcoords[at + 1]];
                (position, texture.map(value))
            };
            faces.push(corners.map(corner).collect());
        }
    }
    faces
}

fn ours(mesh: &ControlMesh) -> Vec<Vec<Corner>> {
    let face = |face: usize| {
        let corners = mesh.face(face).iter().zip(mesh.corner_range(face));
        let corner = |(&vertex, corner): (&u32, usize)| {
            let position = mesh.positions()[vertex as usize].to_array();
            let value = |texture: &hullform::mesh::FaceVarying| {
                texture.values[texture.indices[corner] as usize].to_array()
            };
            (position, mesh.texture().map(value))
        };
        corners.map(corner).collect()
    };
    (0..mesh.face_count()).map(face).collect()
}

/// Faces in the order of their corners: where there are several materials, `tobj` may hand out one's faces after another's.
fn sorted(mut faces: Vec<Vec<Corner>>) -> Vec<Vec<Corner>> {
    faces.sort_by(|a, b| a.partial_cmp(b).expect("coordinates are numbers"));
    faces
}

#[test]
fn another_reader_finds_the_same_faces() {
    let mut compared = 0;
    for path in shared() {
        let text = std::fs::read(&path).expect("it was listed");
        let Ok(mesh) = read_obj(&path) else { continue };
        let witnessed = witnessed(&text);
        assert_eq!(witnessed.len(), mesh.face_count(), "{}", path.display());
        assert!(
            sorted(witnessed) == sorted(ours(&mesh)),
            "{}",
            path.display()
        );
        compared += 1;
    }
    assert!(
        compared > 50 || shared().is_empty(),
        "{compared} were compared"
    );
}

#[test]
fn numbers_counted_from_either_end_colours_and_line_ends_are_read_alike() {
    let text = "v 0 0 0 1 0.5 0\nv 1.25 0 -0\r\nv 1e0 1 0.1\nvt 0.5 1 0\nvt 0 .25\nvn 0 0 1\nf 1/1 2/2 -1/-1\n\
        v -3 2. 1E-2\ng some\nf -4/-2/1 4/2/1 2/1/1\nf 1/2/1 \\\n 2/1/1 4/2/1 3/1/1\n";
    let mesh = read_obj_bytes("mixed.obj", text.as_bytes()).expect("it is sound");
    assert_eq!(mesh.face_count(), 3);
    let joined = text.replace("\\\n", "").replace(" 1 0.5 0\n", "\n");
    assert!(sorted(witnessed(joined.as_bytes())) == sorted(ours(&mesh)));
}
