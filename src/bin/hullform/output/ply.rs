//! Triangles as PLY, binary: a tenth of the text's size, and bits as they came from the device.

use crate::output::Surface;
use std::io::{self, Write};

/// A vertex's properties, in the order of the bytes.
const VERTEX: [&str; 9] = [
    "float x",
    "float y",
    "float z",
    "float nx",
    "float ny",
    "float nz",
    "float u",
    "float v",
    "uint face",
];

/// Header, vertices and triangles, little endian.
pub fn write(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    write_header(out, surface)?;
    for point in &surface.points {
        let floats = point.position.iter().chain(&point.normal).chain(&point.uv);
        for number in floats {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(&point.face.to_le_bytes())?;
    }
    for triangle in &surface.triangles {
        out.write_all(&[3])?;
        for point in triangle {
            out.write_all(&point.to_le_bytes())?;
        }
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
        assert_eq!(body.len(), 3 * (8 * 4 + 4) + (1 + 3 * 4));
        assert_eq!(body[4..8], (-0.1f32).to_le_bytes());
        assert_eq!(body[32..36], 7u32.to_le_bytes());
        assert_eq!(body[3 * 36..][..5], [3, 0, 0, 0, 0]);
        let header = String::from_utf8_lossy(&bytes);
        assert!(header.contains("element vertex 3\n") && header.contains("element face 1\n"));
    }
}
