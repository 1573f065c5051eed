//! Points as comma-separated values.

use crate::output::Surface;
use std::io::{self, Write};

/// A header and a line a point. Numbers are the shortest that read back as the same bits.
pub fn write(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    writeln!(out, "face,u,v,px,py,pz,nx,ny,nz")?;
    for point in &surface.points {
        let ([u, v], [px, py, pz], [nx, ny, nz]) = (point.uv, point.position, point.normal);
        writeln!(out, "{},{u},{v},{px},{py},{pz},{nx},{ny},{nz}", point.face)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::output::tests::triangle;

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        let surface = triangle();
        let mut bytes = Vec::new();
        super::write(&mut bytes, &surface).expect("memory does not fail");
        let text = String::from_utf8(bytes).expect("text");
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("face,u,v,px,py,pz,nx,ny,nz"));
        assert_eq!(lines.clone().next(), Some("7,0,0,0,-0.1,0.000000001,0,0,1"));
        for (line, point) in lines.by_ref().zip(&surface.points) {
            let numbers: Vec<f64> = line
                .split(',')
                .map(|number| number.parse().expect("a number"))
                .collect();
            let single = |range: std::ops::Range<usize>| {
                numbers[range].iter().map(|&x| x as f32).collect::<Vec<_>>()
            };
            assert_eq!(single(1..3), point.uv);
            assert_eq!(numbers[3..6], point.position);
            assert_eq!(single(6..9), point.normal);
        }
        assert_eq!(text.lines().count(), 4);
    }
}
