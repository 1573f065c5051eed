//! OBJ with subdivision tags.
//!
//! `tobj` reads the format, and a scan of the same text gives what `tobj` leaves out: the number of the line for every
//! message, the `t` tags, and the file's own numbering. `tobj` numbers vertices by their first use and splits the file
//! by group and material. The scan therefore hands it only the `v`, `vt` and `f` statements, and [`in_file_order`]
//! puts one polygon before them that uses every vertex in order.

mod file;
mod lines;
mod scan;
mod tags;

use std::path::Path;

use crate::error::{Error, Place, Result};
use crate::mesh::control_mesh::{GREATEST_COORDINATE, GREATEST_TEXTURE_COORDINATE};
use crate::mesh::{ControlMesh, FaceVarying};
use glam::DVec2;
use lines::Line;
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
    let scan = Scan::new(name, text_of(name, bytes)?)?;
    let geometry = in_file_order(&scan);
    let options = tobj::LoadOptions::default();
    let (models, _) = tobj::load_obj_buf(&mut geometry.as_bytes(), &options, |_| {
        Ok(Default::default())
    })
    .map_err(|error| disagreement(Place::File(name.to_string()), error.to_string()))?;
    match models.as_slice() {
        [model] => assemble(name, &scan, &model.mesh),
        models => Err(disagreement(
            Place::File(name.to_string()),
            format!("it finds {} models instead of one", models.len()),
        )),
    }
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

/// The statements for `tobj`, after a polygon that uses all vertices and texture coordinates in the order of the file.
fn in_file_order(scan: &Scan) -> String {
    let (vertices, textures) = (scan.vertices, scan.textures);
    let mut text = String::from("f");
    for number in 1..=opening_size(scan) {
        text.push_str(&match textures {
            0 => format!(" {number}"),
            _ => format!(" {}/{}", number.min(vertices), number.min(textures)),
        });
    }
    text.push('\n');
    text + &scan.geometry
}

fn opening_size(scan: &Scan) -> usize {
    scan.vertices.max(scan.textures)
}

fn assemble(name: &str, scan: &Scan, read: &tobj::Mesh) -> Result<ControlMesh> {
    let opening = opening_size(scan);
    let (positions, _) = read.positions.as_chunks::<3>();
    let indices = read.indices.get(opening..).unwrap_or_default();
    let sizes = face_sizes(name, scan, read)?;
    if positions.len() != scan.vertices {
        let problem = format!("it finds {} vertices", positions.len());
        return Err(disagreement(Place::File(name.to_string()), problem));
    }
    check_range(name, scan, read)?;
    let mut builder = ControlMesh::builder(positions, sizes, indices).options(scan.tags.options);
    for &(_, crease) in &scan.tags.creases {
        builder = builder.crease(crease.vertices[0], crease.vertices[1], crease.sharpness);
    }
    for &(_, corner) in &scan.tags.corners {
        builder = builder.corner(corner.vertex, corner.sharpness);
    }
    for &(_, hole) in &scan.tags.holes {
        builder = builder.hole(hole);
    }
    if scan.textured {
        let (values, _) = read.texcoords.as_chunks::<2>();
        builder = builder.texture(FaceVarying {
            values: values.iter().copied().map(DVec2::from).collect(),
            indices: read
                .texcoord_indices
                .get(opening..)
                .unwrap_or_default()
                .to_vec(),
        });
    }
    builder
        .build()
        .map_err(|error| with_line(name, scan, error))
}

/// Refuses what [`ControlMesh`] would refuse too, by the line where it stands.
fn check_range(name: &str, scan: &Scan, read: &tobj::Mesh) -> Result<()> {
    let used = |indices: &[u32], values: &[f64], width: usize, greatest: f64| {
        let faces = indices.get(opening_size(scan)..).unwrap_or_default();
        let is_large = |&&index: &&u32| {
            let value = &values[width * index as usize..][..width];
            value.iter().any(|x| x.abs() > greatest)
        };
        faces.iter().find(is_large).map(|&index| index as usize)
    };
    let at = |number: usize, problem: &str, remedy: &str| {
        Err(Line { file: name, number }.error(problem, remedy))
    };
    if let Some(vertex) = used(&read.indices, &read.positions, 3, GREATEST_COORDINATE) {
        return at(
            scan.vertex_lines[vertex],
            "a coordinate is beyond what double precision can calculate with",
            "coordinates go up to 1e300: scale the mesh down",
        );
    }
    let greatest = GREATEST_TEXTURE_COORDINATE;
    let texture = || used(&read.texcoord_indices, &read.texcoords, 2, greatest);
    match scan.textured.then(texture).flatten() {
        None => Ok(()),
        Some(texture) => at(
            scan.texture_lines[texture],
            "a texture coordinate is beyond what single precision can interpolate",
            "texture coordinates go up to 1e30",
        ),
    }
}

/// The arity of each face as `tobj` read it, compared with what the scan counted.
fn face_sizes<'a>(name: &str, scan: &'a Scan, read: &tobj::Mesh) -> Result<&'a [u32]> {
    // No arities at all is how `tobj` says that everything is a triangle, the opening polygon too.
    let read_sizes = match read.face_arities.as_slice() {
        [] => vec![3; scan.face_sizes.len()],
        [_, sizes @ ..] => sizes.to_vec(),
    };
    if read_sizes == scan.face_sizes {
        return Ok(&scan.face_sizes);
    }
    let first = scan
        .face_sizes
        .iter()
        .zip(&read_sizes)
        .position(|(scanned, read)| scanned != read);
    let place = match first {
        Some(face) => Place::Line(name.to_string(), scan.face_lines[face]),
        None => Place::File(name.to_string()),
    };
    let problem = format!("it finds {} faces of other sizes", read_sizes.len());
    Err(disagreement(place, problem))
}

/// Puts the line in front of what [`ControlMesh`] says about a face, a vertex or an edge.
fn with_line(name: &str, scan: &Scan, error: Error) -> Error {
    let Error::Input {
        ref place,
        ref problem,
        ref remedy,
    } = error
    else {
        return error;
    };
    match scan.line_of(place) {
        Some(number) => Line { file: name, number }.error(format!("{place}: {problem}"), remedy),
        None => error.in_file(name),
    }
}

fn disagreement(place: Place, problem: String) -> Error {
    Error::input(
        place,
        format!("the OBJ parser reads this differently: {problem}"),
        "please report this file as a bug of hullform",
    )
}
