//! The model that a subcommand works on.

use crate::options::Shape;
use hullform::mesh::topology::Topology;
use hullform::mesh::{
    BUILTINS, BoundaryInterpolation, ControlMesh, Scheme, builtin, read_obj, triangulated,
};
use hullform::{Error, Result};
use std::path::Path;

/// Loads MODEL: the path of an OBJ file, `builtin:NAME`, or if absent the first built-in shape; under the scheme that `--scheme` names or
/// else its file's name speaks of, triangulated when that scheme takes triangles.
pub fn load(model: Option<&Path>, shape: &Shape) -> Result<ControlMesh> {
    named(model, load_unnamed(model, shape))
}

/// What came of work on MODEL; an error speaks of its file.
pub fn named<T>(model: Option<&Path>, result: Result<T>) -> Result<T> {
    result.map_err(|error| error.in_file(&name(model)))
}

/// What messages call MODEL.
pub fn name(model: Option<&Path>) -> String {
    match (model, BUILTINS.first()) {
        (Some(model), _) => model.display().to_string(),
        (None, first) => format!("builtin:{}", first.map_or("", |&(name, _)| name)),
    }
}

fn load_unnamed(model: Option<&Path>, shape: &Shape) -> Result<ControlMesh> {
    let (mesh, of_file) = match model {
        None => (builtin(first_builtin()?)?, None),
        Some(model) => match builtin_name(model) {
            Some(name) => (builtin(name)?, None),
            None => (read_obj(model)?, Scheme::of_file(model)),
        },
    };
    let own = of_file.unwrap_or(mesh.options().scheme);
    let scheme = shape.scheme.as_deref().map_or(Ok(own), str::parse)?;
    let polygons = mesh.faces().filter(|face| face.len() > 3).count();
    let mesh = if scheme.is_triangular() && polygons > 0 {
        tracing::warn!(
            "{}: the scheme {scheme} takes triangles: {polygons} of {} faces are triangulated",
            name(model),
            mesh.face_count()
        );
        triangulated(&mesh, shape.triangulate.into())?
    } else {
        mesh
    };
    let mesh = mesh.with_scheme(scheme)?;
    if has_holes(&mesh) && !Topology::new(&mesh).has_surface() {
        tracing::warn!(
            "{}: there is no surface: every face is a hole, or touches a boundary where `interpolateboundary 0` leaves none",
            name(model)
        );
    }
    Ok(mesh)
}

/// The file that MODEL names.
pub fn file(model: Option<&Path>) -> Option<&Path> {
    model.filter(|model| builtin_name(model).is_none())
}

/// The NAME of `builtin:NAME`.
pub fn builtin_name(model: &Path) -> Option<&str> {
    model.to_str()?.strip_prefix("builtin:")
}

/// Whether a face may be a hole.
fn has_holes(mesh: &ControlMesh) -> bool {
    !mesh.holes().is_empty() || mesh.options().boundary == BoundaryInterpolation::None
}

fn first_builtin() -> Result<&'static str> {
    let first = BUILTINS.first().map(|&(name, _)| name);
    first.ok_or_else(|| Error::Option {
        option: "MODEL",
        problem: "there is no built-in shape".into(),
        remedy: "name an OBJ file".into(),
    })
}
