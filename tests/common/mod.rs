//! What several tests share: the models and shapes beside the project, where they are.
#![allow(dead_code, unused_imports)]

#[cfg(feature = "cli")]
pub mod cli;
pub mod flow;
#[cfg(feature = "host")]
pub mod gpu;
pub mod meshes;
pub mod planar;
pub mod spirv;
pub mod surfaces;

use std::path::PathBuf;

use hullform::mesh::topology::{FaceCorner, Fan, Topology};
use hullform::mesh::{ControlMesh, read_obj};

/// The folder beside the project that holds models and conformance shapes; None elsewhere than where it is developed.
fn shared(folder: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../shared")
        .join(folder);
    if !path.is_dir() {
        eprintln!("skipped: there is no ../shared/{folder} beside the project");
        return None;
    }
    Some(path)
}

/// The OBJ files of a shared folder, sorted by name.
pub fn obj_files(folder: &str) -> Vec<PathBuf> {
    let Some(folder) = shared(folder) else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(folder).expect("a folder can be listed");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    files
}

/// A shared model by name, or None where the models are not.
pub fn model(name: &str) -> Option<ControlMesh> {
    let path = shared("models")?.join(format!("{name}.obj"));
    Some(read_obj(&path).expect("the shared models are sound"))
}

/// The fan at a corner that there is.
pub fn fan_at(topology: &Topology, face: u32, corner: u32) -> Fan {
    let fan = topology.fan_at(FaceCorner { face, corner });
    fan.expect("the face has the corner")
}

/// The diagonal of a mesh's bounding box.
pub fn diagonal(mesh: &ControlMesh) -> f64 {
    let (low, high) = mesh.bounds();
    low.distance(high)
}

/// A file's name without folder and ending.
pub fn stem(path: &std::path::Path) -> String {
    path.file_stem()
        .expect("a file has a name")
        .to_string_lossy()
        .into_owned()
}
