//! Triangles as Wavefront OBJ.

use crate::output::Surface;
use std::io::{self, Write};

/// Positions, texture coordinates, normals and triangles; numbers are the shortest that read back as the same bits.
pub fn write(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    for point in &surface.points {
        let [x, y, z] = point.position;
        writeln!(out, "v {x} {y} {z}")?;
    }
    for point in &surface.points {
        let [s, t] = point.texture;
        writeln!(out, "vt {s} {t}")?;
    }
    for point in &surface.points {
        let [x, y, z] = point.normal;
        writeln!(out, "vn {x} {y} {z}")?;
    }
    for &triangle in &surface.triangles {
        // OBJ counts from 1, and u32::MAX + 1 must still be a number.
        let [a, b, c] = triangle.map(|point| u64::from(point) + 1);
        writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::output::tests::triangle;

    #[test]
    fn a_triangle() {
        let mut bytes = Vec::new();
        super::write(&mut bytes, &triangle()).expect("memory does not fail");
        let expected = "v 0 -0.1 0.000000001\nv 1 0 16777216\nv 0 1.5 0\n\
                        vt 0 0\nvt 1 0\nvt 0.33333334 1\n\
                        vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1/1/1 2/2/2 3/3/3\n";
        assert_eq!(String::from_utf8_lossy(&bytes), expected);
    }
}
