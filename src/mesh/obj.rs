//! OBJ with subdivision tags.

use crate::error::Result;
use crate::mesh::ControlMesh;
use std::path::Path;

/// Reads an OBJ file with its subdivision tags.
pub fn read_obj(_path: &Path) -> Result<ControlMesh> {
    unreachable!("written next")
}

/// Reads OBJ text; `name` is what messages call it.
pub fn read_obj_bytes(_name: &str, _bytes: &[u8]) -> Result<ControlMesh> {
    unreachable!("written next")
}
