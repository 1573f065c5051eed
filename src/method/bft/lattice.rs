//! The points of a face cut 2^level times along each edge, as rows of a table, and which rows a point between them is taken from.
//!
//! Corners come first, then the inner points of edge 0 from its first corner on, of edge 1 and so on, then what is inside. So whoever
//! shares an edge need not know the shape of the face that it is evaluated on.

use crate::tessellation::Domain;

/// The lattice of a face.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// Corners of the face.
    pub corners: u32,
    /// Segments of an edge.
    pub segments: u32,
}

/// Rows with their shares, which sum to 1; unused ones have none.
pub type Shares = [(u32, f32); 4];

impl Lattice {
    /// The lattice of a shape with 2^`level` segments.
    pub fn new(domain: Domain, level: u32) -> Lattice {
        Lattice {
            corners: domain.corners() as u32,
            segments: 1 << level,
        }
    }

    /// How many points.
    pub fn rows(self) -> u32 {
        let inside = self.segments - 1;
        let inner = match self.corners {
            3 => inside * inside.saturating_sub(1) / 2,
            _ => inside * inside,
        };
        self.corners * self.segments + inner
    }

    /// Point `step` of an edge, counted from its first corner; the last is the next corner.
    pub fn edge_row(self, side: u32, step: u32) -> u32 {
        if step == 0 {
            side
        } else if step == self.segments {
            (side + 1) % self.corners
        } else {
            self.corners + side * (self.segments - 1) + step - 1
        }
    }

    /// The point at column i and line j.
    pub fn row(self, i: u32, j: u32) -> u32 {
        let (n, triangle) = (self.segments, self.corners == 3);
        if j == 0 {
            return self.edge_row(0, i);
        }
        if i == 0 {
            return self.edge_row(self.corners - 1, n - j);
        }
        let first = self.corners * n;
        if triangle {
            if i + j >= n {
                return self.edge_row(1, j);
            }
            return first + (j - 1) * (n - 1) - j * (j - 1) / 2 + i - 1;
        }
        if i == n {
            return self.edge_row(1, j);
        }
        if j == n {
            return self.edge_row(2, n - i);
        }
        first + (j - 1) * (n - 1) + i - 1
    }

    /// Between two points of an edge, counted in segments from its first corner.
    pub fn along(self, side: u32, at: f32) -> Shares {
        let step = (at as u32).min(self.segments - 1);
        let part = at - step as f32;
        [
            (self.edge_row(side, step), 1.0 - part),
            (self.edge_row(side, step + 1), part),
            (0, 0.0),
            (0, 0.0),
        ]
    }

    /// What the shares of a point [inside](Self::inside) change by with u and v: those of its triangle or quad, which are its neighbour's on the other side of a line.
    /// Twin of `lattice_changes` in `glsl/lib/lattice.glsl`.
    pub fn changes(self, uv: [f32; 2]) -> [[f32; 4]; 2] {
        let n = self.segments;
        let at = uv.map(|x| x * n as f32);
        let i = (at[0] as u32).min(n - 1);
        let j = (at[1] as u32).min(if self.corners == 3 { n - 1 - i } else { n - 1 });
        let [x, y] = [at[0] - i as f32, at[1] - j as f32];
        let own = if self.corners == 4 {
            [[y - 1.0, 1.0 - y, y, -y], [x - 1.0, -x, x, 1.0 - x]]
        } else if (x + y) - 1.0 <= 0.0 || i + j + 2 > n {
            [[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0]]
        } else {
            [[1.0, -1.0, 0.0, 0.0], [1.0, 0.0, -1.0, 0.0]]
        };
        own.map(|changes| changes.map(|change| n as f32 * change))
    }

    /// Between the corners of the finest triangle or quad around a point inside: the paper's linear geomorph, with all vertices on a virtual
    /// mesh of the maximum level (section II-C).
    pub fn inside(self, uv: [f32; 2]) -> Shares {
        let n = self.segments;
        let at = uv.map(|x| x * n as f32);
        let i = (at[0] as u32).min(n - 1);
        let j = (at[1] as u32).min(if self.corners == 3 { n - 1 - i } else { n - 1 });
        let [x, y] = [at[0] - i as f32, at[1] - j as f32];
        if self.corners == 4 {
            return [
                (self.row(i, j), (1.0 - x) * (1.0 - y)),
                (self.row(i + 1, j), x * (1.0 - y)),
                (self.row(i + 1, j + 1), x * y),
                (self.row(i, j + 1), (1.0 - x) * y),
            ];
        }
        let beyond = (x + y) - 1.0;
        if beyond <= 0.0 || i + j + 2 > n {
            return [
                (self.row(i, j), (1.0 - x) - y),
                (self.row(i + 1, j), x),
                (self.row(i, j + 1), y),
                (0, 0.0),
            ];
        }
        [
            (self.row(i + 1, j + 1), beyond),
            (self.row(i, j + 1), 1.0 - x),
            (self.row(i + 1, j), 1.0 - y),
            (0, 0.0),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_belongs_to_one_point() {
        for (domain, level) in [Domain::Triangles, Domain::Quads]
            .into_iter()
            .flat_map(|domain| (1..=6).map(move |level| (domain, level)))
        {
            let lattice = Lattice::new(domain, level);
            let n = lattice.segments;
            let points = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
            let points = points.filter(|(i, j)| domain == Domain::Quads || i + j <= n);
            let mut rows: Vec<u32> = points.map(|(i, j)| lattice.row(i, j)).collect();
            rows.sort_unstable();
            assert_eq!(rows, (0..lattice.rows()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn shares_sum_to_one_and_a_point_of_the_lattice_has_one_row() {
        for domain in [Domain::Triangles, Domain::Quads] {
            let lattice = Lattice::new(domain, 3);
            for uv in [[1.0 / 3.0; 2], [0.3, 0.65], [0.05, 0.9], [0.125, 0.75]] {
                let shares = lattice.inside(uv);
                let sum: f32 = shares.iter().map(|(_, share)| share).sum();
                assert!((sum - 1.0).abs() < 1e-6);
            }
            let exact = lattice.inside([0.25, 0.5]);
            assert_eq!(exact[0], (lattice.row(2, 4), 1.0));
            assert!(exact[1..].iter().all(|(_, share)| *share == 0.0));
        }
    }
}
