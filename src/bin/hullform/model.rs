//! The model that a subcommand works on.

use hullform::mesh::{BUILTINS, ControlMesh, builtin, read_obj_bytes};
use hullform::{Error, Result};

/// Loads MODEL: the path of an OBJ file, `builtin:NAME`, or if absent the first built-in shape.
pub fn load(model: Option<&str>) -> Result<ControlMesh> {
    match model {
        None => builtin(first_builtin()?),
        Some(model) => match model.strip_prefix("builtin:") {
            Some(name) => builtin(name),
            None => load_file(model),
        },
    }
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
