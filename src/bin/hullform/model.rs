//! The model that a subcommand works on.

use crate::options::Shape;
use hullform::mesh::{BUILTINS, ControlMesh, Scheme, builtin, read_obj_bytes, triangulated};
use hullform::{Error, Result};
use std::path::Path;

/// Loads MODEL: the path of an OBJ file, `builtin:NAME`, or if absent the first built-in shape; under the scheme that `--scheme` names or
/// else its file's name speaks of, triangulated when that scheme takes triangles.
pub fn load(model: Option<&str>, shape: &Shape) -> Result<ControlMesh> {
    let (mesh, of_file) = match model {
        None => (builtin(first_builtin()?)?, None),
        Some(model) => match model.strip_prefix("builtin:") {
            Some(name) => (builtin(name)?, None),
            None => (load_file(model)?, Scheme::of_file(model)),
        },
    };
    let own = of_file.unwrap_or(mesh.options().scheme);
    let scheme = shape.scheme.as_deref().map_or(Ok(own), str::parse)?;
    let polygons = mesh.faces().filter(|face| face.len() > 3).count();
    if !scheme.is_triangular() || polygons == 0 {
        return mesh.with_scheme(scheme);
    }
    tracing::warn!(
        "the scheme {scheme} takes triangles: {polygons} of {} faces are triangulated",
        mesh.face_count()
    );
    triangulated(&mesh, shape.triangulate.into())?.with_scheme(scheme)
}

/// The file that MODEL names.
pub fn file(model: Option<&str>) -> Option<&Path> {
    let file = model.filter(|model| !model.starts_with("builtin:"));
    file.map(Path::new)
}

fn load_file(path: &str) -> Result<ControlMesh> {
    let bytes = std::fs::read(path).map_err(|source| Error::File {
        path: path.into(),
        source,
    })?;
    read_obj_bytes(path, &bytes)
}

fn first_builtin() -> Result<&'static str> {
    let first = BUILTINS.first().map(|&(name, _)| name);
    first.ok_or_else(|| Error::Option {
        option: "MODEL",
        problem: "there is no built-in shape".into(),
        remedy: "name an OBJ file".into(),
    })
}
