//! OBJ with subdivision tags.
//!
//! The text is gone through once. Lines of the kinds that a file nearly always consists of are read straight from its bytes ([`plain`]); any other is
//! first made a statement ([`lines`]) and then read word by word ([`scan`], [`tags`]). Which line something stands on is looked up again where a message
//! needs it, instead of being kept for every vertex and face.
//!
//! `tobj`, which numbers vertices by their first use, splits files by group and material, and knows no tags, is a witness instead: it reads all models
//! too, and must agree (`tests/obj_witness.rs`).

mod file;
mod lines;
mod plain;
mod scan;
mod tags;

use std::path::Path;

use crate::error::{Error, Place, Result};
use crate::mesh::control_mesh::{
    ControlMeshBuilder, GREATEST_COORDINATE, GREATEST_TEXTURE_COORDINATE,
};
use crate::mesh::{ControlMesh, FaceVarying};
use lines::{Cursor, Line};
use scan::Scan;

/// Reads an OBJ file with its subdivision tags.
///
/// Vertices and faces keep the order and numbers of the file. See [`read_obj_bytes`] for what is read. Files of up to 4 GiB are read, and a GiB
/// from a pipe, which cannot tell how much there will be.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read, [`Error::Input`] for one that is too large, or a device, and with file and line for one
/// that has no meaning.
pub fn read_obj(path: &Path) -> Result<ControlMesh> {
    read_obj_bytes(&path.display().to_string(), &file::read(path)?)
}

/// Reads OBJ text; `name` is what messages call it.
///
/// Read are `v`, `vt`, `f` and the tags `crease` (pairs of vertices), `corner`, `hole`, `interpolateboundary`,
/// `creasemethod` and `smoothtriangles`. Several creases on one edge all stay, in order: the last one counts.
/// Texture coordinates are taken when every corner of every face has one; what one lacks is 0, and so is one that is not finite. Where only some
/// corners have one they are ignored, as are a vertex's weight, hierarchical edits and unknown statements. Each of these is said in a warning. Normals, groups,
/// materials, lines and points are skipped; no other file is opened.
///
/// Lines may end as on Unix, Windows or old Macs. What is skipped may be in any encoding.
///
/// # Errors
/// [`Error::Input`] with file and line for text that has no meaning.
pub fn read_obj_bytes(name: &str, bytes: &[u8]) -> Result<ControlMesh> {
    let text = text_of(name, bytes)?;
    let scan = Scan::new(name, text)?;
    assemble(name, text, scan)
}

/// What follows the mark of UTF-8 that some editors put before a text.
fn text_of<'a>(name: &str, mut bytes: &'a [u8]) -> Result<&'a [u8]> {
    while let Some(rest) = bytes.strip_prefix("\u{feff}".as_bytes()) {
        bytes = rest;
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(Error::input(
            Place::File(name.to_string()),
            "this is UTF-16 text",
            "save the file as UTF-8",
        ));
    }
    Ok(bytes)
}

fn assemble(name: &str, text: &[u8], scan: Scan) -> Result<ControlMesh> {
    check_range(name, text, &scan)?;
    let Scan {
        positions,
        textures,
        face_sizes,
        face_vertices,
        face_textures,
        textured,
        tags,
        ..
    } = scan;
    let faces = face_sizes.len();
    let mut builder = ControlMeshBuilder::of_parts(positions, face_sizes, face_vertices);
    builder = builder.options(tags.options);
    for &(_, crease) in &tags.creases {
        builder = builder.crease(crease.vertices[0], crease.vertices[1], crease.sharpness);
    }
    for &(_, corner) in &tags.corners {
        builder = builder.corner(corner.vertex, corner.sharpness);
    }
    for &(_, hole) in &tags.holes {
        builder = builder.hole(hole);
    }
    if textured {
        builder = builder.texture(FaceVarying {
            values: textures,
            indices: face_textures,
        });
    }
    let line_of = |place: &Place| match *place {
        Place::Face(face) if face < faces => Some(line_of_statement(text, "f", face)),
        _ => tags.line_of(place),
    };
    let built = builder.build();
    built.map_err(|error| with_line(name, line_of, error))
}

/// Refuses what [`ControlMesh`] would refuse too, by the line where it stands.
fn check_range(name: &str, text: &[u8], scan: &Scan) -> Result<()> {
    let at = |keyword: &str, index: u32, problem: &str, remedy: &str| {
        let number = line_of_statement(text, keyword, index as usize);
        Err(Line { file: name, number }.error(problem, remedy))
    };
    let is_large = |&&vertex: &&u32| {
        let position = scan.positions[vertex as usize];
        position.abs().max_element() > GREATEST_COORDINATE
    };
    if let Some(&vertex) = scan.face_vertices.iter().find(is_large) {
        return at(
            "v",
            vertex,
            "a coordinate is beyond what double precision can calculate with",
            "coordinates go up to 1e300: scale the mesh down",
        );
    }
    let is_large = |&&texture: &&u32| {
        let value = scan.textures[texture as usize];
        value.abs().max_element() > GREATEST_TEXTURE_COORDINATE
    };
    let mut used = scan.face_textures.iter();
    match used.find(is_large).filter(|_| scan.textured) {
        None => Ok(()),
        Some(&texture) => at(
            "vt",
            texture,
            "a texture coordinate is beyond what single precision can interpolate",
            "texture coordinates go up to 1e30",
        ),
    }
}

/// Puts the line in front of what [`ControlMesh`] says about a face, a vertex or an edge.
fn with_line(name: &str, line_of: impl Fn(&Place) -> Option<usize>, error: Error) -> Error {
    let Error::Input {
        ref place,
        ref problem,
        ref remedy,
    } = error
    else {
        return error;
    };
    match line_of(place) {
        Some(number) => Line { file: name, number }.error(format!("{place}: {problem}"), remedy),
        None => error.in_file(name),
    }
}

/// The line of the statement of this number, counted from 0, among those that begin with a word; the last line if there are fewer.
fn line_of_statement(text: &[u8], keyword: &str, index: usize) -> usize {
    let mut cursor = Cursor::new("", text);
    let mut left = index;
    while let Some(statement) = cursor.statement() {
        let text = String::from_utf8_lossy(&statement.text);
        if text.split_whitespace().next() == Some(keyword) {
            if left == 0 {
                return statement.line.number;
            }
            left -= 1;
        }
    }
    cursor.number
}
