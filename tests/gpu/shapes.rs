//! Meshes to test with.

use hullform::mesh::{ControlMesh, Model, Scheme, Triangulation, builtin, read_obj, triangulated};

use crate::common;
use crate::common::meshes::tagged_as;

/// The built-in shapes that have a name of their own, and one each of those with numbers.
pub const BUILTINS: [&str; 8] = [
    "hull",
    "cube",
    "creased-torus",
    "sheet",
    "ngons",
    "cubes-2x1x1",
    "pole-64",
    "pole-360",
];

/// A built-in shape as a model.
pub fn built_in(name: &str) -> Model {
    Model::new(builtin(name).expect("it is one of the built-in shapes"))
}

/// The shared Catmull-Clark shapes, where they are.
pub fn catmark() -> Vec<(String, Model)> {
    let files = common::obj_files("shapes").into_iter();
    let named = files.map(|file| (common::stem(&file), file));
    named
        .filter(|(name, _)| name.starts_with("catmark"))
        .filter_map(|(name, file)| Some((name, Model::new(read_obj(&file).ok()?))))
        .collect()
}

/// The built-in shapes and the shared ones.
pub fn all() -> Vec<(String, Model)> {
    let own = BUILTINS.map(|name| (format!("builtin:{name}"), built_in(name)));
    own.into_iter().chain(catmark()).collect()
}

/// A mesh under a scheme, cut into triangles if that takes no others; None where the scheme knows nothing of its tags.
pub fn under(mesh: &ControlMesh, scheme: Scheme) -> Option<Model> {
    let mesh = match scheme.is_triangular() {
        true => triangulated(mesh, Triangulation::default()).expect("a sound mesh"),
        false => mesh.clone(),
    };
    mesh.with_scheme(scheme).ok().map(Model::new)
}

/// The built-in shapes cut into triangles, and the shared ones that are made of triangles, under Loop's scheme and, where it knows their tags,
/// the butterfly's.
pub fn triangular() -> Vec<(String, Model)> {
    let own = BUILTINS.map(|name| (format!("builtin:{name}"), builtin(name).expect("built in")));
    let shared = common::obj_files("shapes").into_iter().filter_map(|file| {
        let name = common::stem(&file);
        Some((name, read_obj(&file).ok()?)).filter(|(name, _)| name.starts_with("loop"))
    });
    let under_both = |(name, mesh): (String, ControlMesh)| {
        [Scheme::Loop, Scheme::Butterfly]
            .map(|scheme| Some((format!("{name} {scheme}"), under(&mesh, scheme)?)))
    };
    own.into_iter()
        .chain(shared)
        .flat_map(under_both)
        .flatten()
        .collect()
}

/// A torus of quads without tags: nothing but regular faces.
pub fn torus() -> Model {
    const AROUND: u32 = 8;
    const ACROSS: u32 = 5;
    let angle = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let position = |i: u32, j: u32| {
        let (around, across) = (angle(i, AROUND), angle(j, ACROSS));
        let radius = 2.0 + across.cos();
        [radius * around.cos(), radius * around.sin(), across.sin()]
    };
    let vertex = |i: u32, j: u32| i % AROUND * ACROSS + j % ACROSS;
    let places = || (0..AROUND).flat_map(|i| (0..ACROSS).map(move |j| (i, j)));
    let positions: Vec<[f64; 3]> = places().map(|(i, j)| position(i, j)).collect();
    let faces: Vec<u32> = places()
        .flat_map(|(i, j)| {
            [
                vertex(i, j),
                vertex(i + 1, j),
                vertex(i + 1, j + 1),
                vertex(i, j + 1),
            ]
        })
        .collect();
    let sizes = [4; (AROUND * ACROSS) as usize];
    let mesh = ControlMesh::builder(&positions, &sizes, &faces).build();
    Model::new(mesh.expect("a torus is sound"))
}

/// A mesh scaled and moved, its tags and faces as before.
pub fn moved(mesh: &ControlMesh, scale: f64, by: [f64; 3]) -> ControlMesh {
    let positions: Vec<[f64; 3]> = mesh
        .positions()
        .iter()
        .map(|&position| (scale * position + glam::DVec3::from(by)).to_array())
        .collect();
    let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
    let vertices: Vec<u32> = mesh.faces().flatten().copied().collect();
    tagged_as(mesh, ControlMesh::builder(&positions, &sizes, &vertices))
}
