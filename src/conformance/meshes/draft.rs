//! Random meshes: a sheet of quads, changed by random strokes and tagged at random.

use glam::DVec2;

use super::{Parts, sheet};
use crate::conformance::random::Random;
use crate::error::Result;
use crate::mesh::{
    BoundaryInterpolation, ControlMesh, CreaseMethod, SchemeOptions, TriangleSubdivision,
};

/// A mesh while it changes.
pub struct Draft {
    parts: Parts,
    random: Random,
    /// Whether edges may get more than two faces, or two in the same direction.
    wild: bool,
    /// By how much new vertices miss the middles that they are meant for.
    scatter: f64,
}

impl Draft {
    /// A random mesh.
    ///
    /// # Errors
    /// None, unless this file is wrong: strokes leave a sound mesh.
    pub fn random(random: Random) -> Result<ControlMesh> {
        Draft::drawn(random, true)
    }

    /// A random mesh whose edges have two faces at most, which agree in orientation.
    ///
    /// # Errors
    /// As [`random`](Self::random).
    pub fn manifold(random: Random) -> Result<ControlMesh> {
        Draft::drawn(random, false)
    }

    fn drawn(random: Random, wild: bool) -> Result<ControlMesh> {
        let mut draft = Draft {
            parts: Parts::default(),
            random,
            wild,
            scatter: 0.15,
        };
        draft.parts = sheet(2 + draft.random.below(3)).scattered(0.2);
        for _ in 0..draft.random.below(7) {
            draft.stroke();
        }
        draft.tagged()
    }

    /// A random mesh in the plane z = 0, counter-clockwise seen from above, without tags; `even` if vertices stand in rows, so that edges go
    /// straight on. Faces may have straight corners; everything else about them is far from degenerate.
    pub fn plane(random: &mut Random, even: bool) -> Parts {
        loop {
            let mut draft = Draft {
                parts: sheet(2 + random.below(3)),
                random: random.clone(),
                wild: false,
                scatter: 0.0,
            };
            let by = if even { 0.0 } else { 0.15 };
            let n = 1 + draft.parts.faces.len().isqrt();
            for (i, position) in draft.parts.positions.iter_mut().enumerate() {
                let random = &mut draft.random;
                let [x, y] = [i % n, i / n].map(|x| x as f64 + random.between(-by, by));
                *position = [x, y, 0.0];
            }
            for _ in 0..draft.random.below(6) {
                draft.stroke();
            }
            *random = draft.random;
            if is_fair(&draft.parts) {
                return draft.parts;
            }
        }
    }

    fn stroke(&mut self) {
        let face = self.random.below(self.parts.faces.len() as u32) as usize;
        let arity = self.parts.faces[face].len() as u32;
        let corner = self.random.below(arity) as usize;
        self.parts.faces[face].rotate_left(corner);
        match self.random.below(8) {
            0 => self.split(face),
            1 => self.poke(face),
            // Vertices at the same place would make faces without area.
            2 if self.scatter > 0.0 => self.rays(face),
            3 => self.lens(face),
            4 if self.parts.faces.len() > 3 => drop(self.parts.faces.remove(face)),
            5 if self.wild => self.parts.faces[face].reverse(),
            6 if self.wild => self.fin(face),
            _ => self.merge(face),
        }
    }

    /// Cuts a face in two, from its first corner to its third.
    fn split(&mut self, face: usize) {
        let vertices = self.parts.faces[face].clone();
        if vertices.len() > 3 {
            self.parts.faces[face] = vertices[..3].to_vec();
            let rest = [&vertices[2..], &vertices[..1]].concat();
            self.parts.faces.push(rest);
        }
    }

    /// A vertex in the middle of a face, joined to all corners.
    fn poke(&mut self, face: usize) {
        let middle = self.middle(face);
        let ring = std::mem::take(&mut self.parts.faces[face]);
        let triangle = |i: usize| vec![ring[i], ring[(i + 1) % ring.len()], middle];
        let mut triangles: Vec<Vec<u32>> = (0..ring.len()).map(triangle).collect();
        self.parts.faces[face] = triangles.swap_remove(0);
        self.parts.faces.extend(triangles);
    }

    /// More edges at a corner of a face.
    fn rays(&mut self, face: usize) {
        let count = 1 + self.random.below(3);
        let inner: Vec<u32> = (0..count).map(|_| self.middle(face)).collect();
        let vertices = self.parts.faces[face].clone();
        let [first, .., last] = vertices[1..] else {
            return;
        };
        let rim: Vec<u32> = [&[first], &inner[..], &[last]].concat();
        let outer = vertices[1..].iter().chain(inner.iter().rev()).copied();
        self.parts.faces[face] = outer.collect();
        let fan = rim
            .windows(2)
            .map(|pair| vec![vertices[0], pair[0], pair[1]]);
        self.parts.faces.extend(fan);
    }

    /// A vertex of valence 2 inside a face, between two corners.
    fn lens(&mut self, face: usize) {
        let vertices = self.parts.faces[face].clone();
        if vertices.len() > 3 {
            let middle = self.middle(face);
            self.parts.faces[face] = [&vertices[..3], &[middle]].concat();
            let rest = [&[vertices[0], middle, vertices[2]], &vertices[3..]].concat();
            self.parts.faces.push(rest);
        }
    }

    /// A further face on an edge, which is non-manifold then.
    fn fin(&mut self, face: usize) {
        let [a, b] = [self.parts.faces[face][0], self.parts.faces[face][1]];
        let c = self.vertex(b, 1.0);
        let d = self.vertex(a, 1.0);
        self.parts.faces.push(vec![a, b, c, d]);
    }

    /// Joins a face with the one beyond its first edge.
    fn merge(&mut self, face: usize) {
        let own = self.parts.faces[face].clone();
        let [a, b] = [own[0], own[1]];
        let beyond = (0..self.parts.faces.len()).find_map(|other| {
            let vertices = &self.parts.faces[other];
            let follows = |&i: &usize| vertices[i] == b && vertices[(i + 1) % vertices.len()] == a;
            Some((other, (0..vertices.len()).find(follows)?))
        });
        let Some((other, at)) = beyond else { return };
        let mut joined = self.parts.faces[other].clone();
        joined.rotate_left(at + 1);
        // From b around to a, then the other's way back from a to b, without its ends.
        let whole = [&own[1..], &own[..1], &joined[1..joined.len() - 1]].concat();
        let mut sorted = whole.clone();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.len() == whole.len() && whole.len() <= 8 {
            self.parts.faces[face] = whole;
            self.parts.faces.remove(other);
        }
    }

    /// A vertex near the middle of a face.
    fn middle(&mut self, face: usize) -> u32 {
        let corners = &self.parts.faces[face];
        let count = corners.len() as f64;
        let mean = |axis: usize| {
            let all = corners
                .iter()
                .map(|&v| self.parts.positions[v as usize][axis]);
            all.sum::<f64>() / count
        };
        let middle = [mean(0), mean(1), mean(2)];
        self.add(middle)
    }

    /// A vertex above another.
    fn vertex(&mut self, over: u32, height: f64) -> u32 {
        let [x, y, z] = self.parts.positions[over as usize];
        self.add([x, y, z + height])
    }

    fn add(&mut self, position: [f64; 3]) -> u32 {
        let by = self.scatter;
        let scattered = position.map(|x| x + self.random.between(-by, by));
        self.parts.positions.push(scattered);
        self.parts.positions.len() as u32 - 1
    }

    fn tagged(mut self) -> Result<ControlMesh> {
        let options = self.options();
        let random = &mut self.random;
        let faces = &self.parts.faces;
        let mut edges = Vec::new();
        for _ in 0..random.below(6) {
            let face = random.one_of(faces);
            let i = random.below(face.len() as u32) as usize;
            let sharpness = *random.one_of(&[0.5, 1.0, 1.7, 2.0, 3.3, 10.0]);
            edges.push((face[i], face[(i + 1) % face.len()], sharpness));
        }
        let corner = random.one_of(faces)[0];
        let corner_sharpness = *random.one_of(&[0.0, 0.0, 1.5, 10.0]);
        let hole = random.below(4 * faces.len() as u32);
        self.parts.tagged(|mut builder| {
            builder = builder.options(options).corner(corner, corner_sharpness);
            if (hole as usize) < faces.len() {
                builder = builder.hole(hole);
            }
            edges
                .into_iter()
                .fold(builder, |builder, (a, b, s)| builder.crease(a, b, s))
        })
    }

    fn options(&mut self) -> SchemeOptions {
        use BoundaryInterpolation::{EdgeAndCorner, EdgeOnly};
        let random = &mut self.random;
        SchemeOptions {
            boundary: *random.one_of(&[EdgeOnly, EdgeAndCorner]),
            creasing: *random.one_of(&[
                CreaseMethod::Uniform,
                CreaseMethod::Uniform,
                CreaseMethod::Chaikin,
            ]),
            triangles: *random.one_of(&[
                TriangleSubdivision::CatmullClark,
                TriangleSubdivision::Smooth,
            ]),
            ..SchemeOptions::default()
        }
    }
}

/// Whether no face of a mesh in the plane z = 0 is narrow or concave: corners are convex, or exactly straight.
fn is_fair(parts: &Parts) -> bool {
    let at = |vertex: u32| DVec2::from_slice(&parts.positions[vertex as usize][..2]);
    parts.faces.iter().all(|face| {
        let n = face.len();
        let corner = |i: usize| [i, (i + 1) % n, (i + 2) % n].map(|i| at(face[i]));
        let turn = |[a, b, c]: [DVec2; 3]| ((b - a).perp_dot(c - b), (b - a).dot(c - b));
        let turns: Vec<(f64, f64)> = (0..n).map(|i| turn(corner(i))).collect();
        let convex = |&(turn, _): &(f64, f64)| turn > 0.05;
        let straight = |&(turn, on): &(f64, f64)| turn.abs() < 1e-12 && on > 0.05;
        turns.iter().filter(|turn| convex(turn)).count() > 2
            && turns.iter().all(|turn| convex(turn) || straight(turn))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Model;

    #[test]
    fn manifold_meshes_have_two_faces_an_edge_at_most() {
        for seed in 0..100 {
            let mesh = Draft::manifold(Random::new(seed, "draft"));
            let model = Model::new(mesh.unwrap_or_else(|error| panic!("seed {seed}: {error}")));
            let topology = model.topology();
            let mut edges = 0..topology.edge_count() as u32;
            assert!(edges.all(|edge| topology.edge_faces(edge).len() <= 2));
        }
    }

    #[test]
    fn strokes_leave_sound_meshes_and_all_kinds_of_faces() {
        let mut arities = std::collections::BTreeSet::new();
        for seed in 0..300 {
            let mesh = Draft::random(Random::new(seed, "draft"));
            let mesh = mesh.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
            arities.extend(mesh.faces().map(<[u32]>::len));
        }
        assert!([3, 4, 5, 6].iter().all(|arity| arities.contains(arity)));
    }
}
