//! Triangles as PLY, binary: a tenth of the text's size, and bits as they came from the device.

use crate::output::Surface;
use rayon::prelude::*;
use std::io::{self, Write};

/// A vertex's properties, in the order of the bytes.
const VERTEX: [&str; 11] = [
    "double x",
    "double y",
    "double z",
    "float nx",
    "float ny",
    "float nz",
    "float u",
    "float v",
    "float s",
    "float t",
    "uint face",
];

/// Header, vertices and triangles, little endian.
pub fn write(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    write_header(out, surface)?;
    in_parts(out, &surface.points, |point, bytes| {
        for number in point.position {
            bytes.extend(number.to_le_bytes());
        }
        for number in point.normal.iter().chain(&point.uv).chain(&point.texture) {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(point.face.to_le_bytes());
    })?;
    in_parts(out, &surface.triangles, |triangle, bytes| {
        bytes.push(3);
        for point in triangle {
            bytes.extend(point.to_le_bytes());
        }
    })
}

/// So many items are turned to bytes at once, and by one core.
const AT_ONCE: usize = 1 << 19;
const PART: usize = 1 << 13;

/// Writes items one after another; their bytes are made in parallel.
fn in_parts<T: Sync>(
    out: &mut dyn Write,
    items: &[T],
    item: impl Fn(&T, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let part = |items: &[T]| {
        let mut bytes = Vec::with_capacity(64 * items.len());
        items.iter().for_each(|one| item(one, &mut bytes));
        bytes
    };
    for items in items.chunks(AT_ONCE) {
        let parts: Vec<Vec<u8>> = items.par_chunks(PART).map(part).collect();
        parts.iter().try_for_each(|bytes| out.write_all(bytes))?;
    }
    Ok(())
}

fn write_header(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "comment written by hullform")?;
    writeln!(out, "element vertex {}", surface.points.len())?;
    for property in VERTEX {
        writeln!(out, "property {property}")?;
    }
    writeln!(out, "element face {}", surface.triangles.len())?;
    writeln!(out, "property list uchar uint vertex_indices\nend_header")
}

#[cfg(test)]
mod tests {
    use crate::output::tests::triangle;

    #[test]
    fn the_body_is_as_long_as_the_header_says() {
        let mut bytes = Vec::new();
        super::write(&mut bytes, &triangle()).expect("memory does not fail");
        let end = b"end_header\n";
        let body = bytes.windows(end.len()).position(|part| part == end);
        let body = &bytes[body.expect("a header") + end.len()..];
        assert_eq!(body.len(), 3 * (3 * 8 + 7 * 4 + 4) + (1 + 3 * 4));
        assert_eq!(body[8..16], (-0.1f64).to_le_bytes());
        assert_eq!(body[52..56], 7u32.to_le_bytes());
        assert_eq!(body[3 * 56..][..5], [3, 0, 0, 0, 0]);
        let header = String::from_utf8_lossy(&bytes);
        assert!(header.contains("element vertex 3\n") && header.contains("element face 1\n"));
    }
}
