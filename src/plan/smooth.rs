//! Quads around which all is smooth and quads, and no vertex is met twice: their corners' valences tell the whole configuration, and their rings are read
//! off arrays, without walks, search or hashing.

use std::borrow::Cow;

use crate::mesh::sharpness::is_sharp;
use crate::mesh::topology::Topology;

/// Instead of a side: there is none.
const NONE: u32 = u32::MAX;

/// Rings of more vertices are left to [`Ring::of_quad`](crate::plan::Ring::of_quad).
const MOST: usize = 32;

/// What is smooth in a topology. A side of a quad is a number, 4 times the face and the corner at which it begins.
pub struct SmoothQuads<'a> {
    topology: &'a Topology,
    /// The vertices at which sides begin.
    vertices: Cow<'a, [u32]>,
    /// For each side, that of the one quad beyond, which runs the other way.
    beyond: Vec<u32>,
    /// The valence of each vertex that is smooth, inside and among quads; 0 of others.
    valences: Vec<u8>,
}

/// Where the ring of a smooth quad begins, so that turned and mirrored faces have the same configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SmoothStart {
    /// The corners' valences from there on, a byte each: faces of equal keys have equal configurations.
    pub key: u32,
    /// As [`Ring::start`](crate::plan::Ring::start).
    pub corner: u32,
    /// As [`Ring::mirrored`](crate::plan::Ring::mirrored).
    pub mirrored: bool,
}

/// The ring of a smooth quad.
#[derive(Clone, Copy, Debug)]
pub struct SmoothRing {
    vertices: [u32; MOST],
    order: [u8; MOST],
    count: usize,
}

impl SmoothRing {
    /// As [`Ring::vertices`](crate::plan::Ring::vertices).
    pub fn vertices(&self) -> &[u32] {
        &self.vertices[..self.count]
    }

    /// The places of the vertices, by their numbers in the mesh.
    pub fn order(&self) -> &[u8] {
        &self.order[..self.count]
    }
}

impl<'a> SmoothQuads<'a> {
    /// Finds what is smooth.
    pub fn new(topology: &'a Topology) -> SmoothQuads<'a> {
        let faces = 0..topology.face_count() as u32;
        let vertices = match topology.quads() {
            Some(quads) => Cow::Borrowed(quads),
            None => {
                let all = faces.clone().flat_map(|face| match topology.face(face) {
                    &[a, b, c, d] => [a, b, c, d],
                    _ => [NONE; 4],
                });
                Cow::Owned(all.collect())
            }
        };
        SmoothQuads {
            topology,
            beyond: beyond(topology, &vertices),
            valences: valences(topology),
            vertices,
        }
    }

    /// The topology that it is of.
    pub fn topology(&self) -> &'a Topology {
        self.topology
    }

    /// The side after one in its face, or so many after.
    pub fn after(side: u32, steps: u32) -> u32 {
        side & !3 | side.wrapping_add(steps) & 3
    }

    fn vertex(&self, side: u32) -> u32 {
        self.vertices[side as usize]
    }

    /// The valence of a vertex that is smooth, inside and among quads.
    pub fn valence(&self, vertex: u32) -> Option<usize> {
        let valence = self.valences[vertex as usize];
        (valence > 0).then_some(valence.into())
    }

    /// The valences of a quad's corners, if all are smooth.
    fn corners(&self, face: u32) -> Option<[u8; 4]> {
        let vertices = &self.vertices[4 * face as usize..][..4];
        if vertices[0] == NONE {
            return None;
        }
        let valences: [u8; 4] =
            std::array::from_fn(|corner| self.valences[vertices[corner] as usize]);
        (!valences.contains(&0)).then_some(valences)
    }

    /// Whether a face is a B-spline of its control vertices.
    pub fn is_regular(&self, face: u32) -> bool {
        self.corners(face) == Some([4; 4])
    }

    /// The sixteen control vertices of a face that is a B-spline, number x + 4 y. None of others.
    pub fn regular(&self, face: u32) -> Option<[u32; 16]> {
        /// Where a corner's vertex stands, and those beyond: along the face's edge, across the vertex, beside the other edge.
        const PLACES: [[usize; 4]; 4] =
            [[5, 4, 0, 1], [6, 2, 3, 7], [10, 11, 15, 14], [9, 13, 12, 8]];
        if !self.is_regular(face) {
            return None;
        }
        let mut points = [0; 16];
        for (corner, [own, along, diagonal, beside]) in (0..).zip(PLACES) {
            let side = 4 * face + corner;
            let opposite = self.around(self.around(side));
            points[own] = self.vertex(side);
            points[along] = self.vertex_after(opposite, 1);
            points[diagonal] = self.vertex_after(opposite, 2);
            points[beside] = self.vertex_after(opposite, 3);
        }
        Some(points)
    }

    /// The vertex at which the side begins that comes so many after one in its face.
    pub fn vertex_after(&self, side: u32, steps: u32) -> u32 {
        self.vertex(Self::after(side, steps))
    }

    /// The side of the one quad beyond a side, which runs the other way; None at boundaries, beside n-gons, and where faces disagree in orientation.
    pub fn beyond(&self, side: u32) -> Option<u32> {
        let beyond = self.beyond[side as usize];
        (beyond != NONE).then_some(beyond)
    }

    /// From a side to that of the next face around the vertex at which it begins, counter-clockwise. That vertex must be smooth.
    pub fn around(&self, side: u32) -> u32 {
        self.beyond[Self::after(side, 3) as usize]
    }

    /// From a side to those of the faces before and after it around the vertex at which it begins, counter-clockwise. That vertex must be smooth.
    pub fn beside(&self, side: u32) -> [u32; 2] {
        [
            Self::after(self.beyond[side as usize], 1),
            self.around(side),
        ]
    }

    /// From a side to that of the next face around the vertex at which it ends, clockwise.
    fn around_end(&self, side: u32) -> u32 {
        self.beyond[Self::after(side, 1) as usize]
    }

    /// Where the ring of a face begins; None of faces that are not smooth.
    pub fn start(&self, face: u32) -> Option<SmoothStart> {
        let valences = self.corners(face)?;
        if valences.iter().any(|&valence| valence < 3) {
            return None;
        }
        // Corners i, i + 1, ... or i, i - 1, ..., the first of the least.
        let forwards = u32::from_be_bytes(valences);
        let [a, b, c, d] = valences;
        let backwards = u32::from_be_bytes([a, d, c, b]);
        let mut least = SmoothStart {
            key: forwards,
            corner: 0,
            mirrored: false,
        };
        for i in 1..8 {
            let (corner, mirrored) = (i % 4, i >= 4);
            let key = if mirrored {
                backwards.rotate_right(8 * corner)
            } else {
                forwards.rotate_left(8 * corner)
            };
            if key < least.key {
                least = SmoothStart {
                    key,
                    corner,
                    mirrored,
                };
            }
        }
        Some(least)
    }

    /// The ring of a smooth face, in the order of [`Ring::of_quad`](crate::plan::Ring::of_quad); None where a vertex is met twice, or there are many.
    pub fn ring(&self, face: u32, start: SmoothStart) -> Option<SmoothRing> {
        let valences = start.key.to_be_bytes().map(u32::from);
        let count = 2 * valences.iter().sum::<u32>() as usize - 16;
        if count > MOST {
            return None;
        }
        let mut vertices = [NONE; MOST];
        let mut next = 0;
        let mut push = |vertex: u32| {
            vertices[next] = vertex;
            next += 1;
        };
        let corner = |i: u32| match start.mirrored {
            true => 4 * face + (start.corner + 4 - i) % 4,
            false => 4 * face + (start.corner + i) % 4,
        };
        (0..4).for_each(|i| push(self.vertex(corner(i))));
        for i in 0..4 {
            // Around each corner from the edge before it on. Faces that corners before have met come first, and last at the fourth corner.
            let met = [0, 1, 1, 1][i as usize];
            let faces = valences[i as usize] - [1, 1, 1, 2][i as usize];
            let mut at = match start.mirrored {
                true => self.beyond[corner(i) as usize],
                false => self.around(corner(i)),
            };
            for number in 0..faces {
                // The two vertices that follow in the face, of which the second is in the next face too.
                let pair = match start.mirrored {
                    true => [3, 2],
                    false => [2, 3],
                };
                if number >= met {
                    let is_last = number + 1 == faces;
                    // The last face around corner 2 may be beside the first around corner 0.
                    if !(is_last && i == 2 && valences[3] == 3) {
                        push(self.vertex_after(at, pair[0]));
                    }
                    if !is_last {
                        push(self.vertex_after(at, pair[1]));
                    }
                }
                at = match start.mirrored {
                    true => self.around_end(at),
                    false => self.around(at),
                };
            }
        }
        assert_eq!(next, count, "a face and two vertices for each beyond four");
        let order = order(&vertices, count)?;
        Some(SmoothRing {
            vertices,
            order,
            count,
        })
    }

    /// The place of a face around the smooth vertex at a corner of it, counted counter-clockwise from the first that the topology lists.
    pub fn place_around(&self, face: u32, corner: u32) -> u32 {
        let vertex = self.vertex(4 * face + corner);
        let first = self.topology.vertex_faces(vertex)[0];
        let (mut at, mut place) = (4 * first.face + first.corner, 0);
        while at / 4 != face {
            at = self.around(at);
            place += 1;
        }
        place
    }

    /// Whether no vertex around a smooth one is met twice.
    pub fn is_simple_star(&self, vertex: u32) -> bool {
        let (Some(valence), Some(first)) = (
            self.valence(vertex),
            self.topology.vertex_faces(vertex).first(),
        ) else {
            return false;
        };
        if valence < 3 || 2 * valence >= MOST {
            return false;
        }
        let mut vertices = [NONE; MOST];
        vertices[0] = vertex;
        let mut at = 4 * first.face + first.corner;
        for pair in vertices[1..=2 * valence].chunks_exact_mut(2) {
            pair[0] = self.vertex_after(at, 1);
            pair[1] = self.vertex_after(at, 2);
            at = self.around(at);
        }
        order(&vertices, 2 * valence + 1).is_some()
    }
}

/// The places of the first numbers, least first; None where one is there twice. The rest are greater.
fn order(numbers: &[u32; MOST], count: usize) -> Option<[u8; MOST]> {
    let mut order = [0; MOST];
    let mut met = 0u32;
    // As many as vector instructions take at a time; none of the rest is less.
    let all = &numbers[..count.next_multiple_of(8)];
    for (place, &number) in numbers[..count].iter().enumerate() {
        // How many are less, which vector instructions count.
        let rank: u32 = all.iter().map(|&other| u32::from(other < number)).sum();
        order[rank as usize] = place as u8;
        met |= 1 << rank;
    }
    (met.count_ones() as usize == count).then_some(order)
}

/// For each side, that of the one quad beyond.
fn beyond(topology: &Topology, vertices: &[u32]) -> Vec<u32> {
    let mut beyond = vec![NONE; vertices.len()];
    let mut first = vec![NONE; topology.edge_count()];
    for face in 0..topology.face_count() as u32 {
        let &[a, b, c, d] = topology.face_edges(face) else {
            continue;
        };
        for (corner, edge) in (0..).zip([a, b, c, d]) {
            let side = 4 * face + corner;
            let known = std::mem::replace(&mut first[edge as usize], side);
            if known == NONE || topology.edge_faces(edge).len() != 2 {
                continue;
            }
            if vertices[known as usize] != vertices[side as usize] {
                beyond[known as usize] = side;
                beyond[side as usize] = known;
            }
        }
    }
    beyond
}

/// The valences of smooth vertices among quads. Boundaries and what is not manifold are sharp, so they are inside.
fn valences(topology: &Topology) -> Vec<u8> {
    let of = |vertex: u32| {
        let is_sharp = is_sharp(topology.vertex_sharpness(vertex));
        let valence = topology.vertex_faces(vertex).len();
        if is_sharp {
            0
        } else {
            u8::try_from(valence).unwrap_or(0)
        }
    };
    let mut valences: Vec<u8> = (0..topology.vertex_count() as u32).map(of).collect();
    for edge in topology
        .edges()
        .iter()
        .filter(|edge| is_sharp(edge.sharpness))
    {
        for vertex in edge.vertices {
            valences[vertex as usize] = 0;
        }
    }
    if topology.quads().is_none() {
        let faces = (0..topology.face_count() as u32).map(|face| topology.face(face));
        for &vertex in faces.filter(|face| face.len() != 4).flatten() {
            valences[vertex as usize] = 0;
        }
    }
    valences
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ControlMesh, Scheme, builtin};
    use crate::plan::Ring;
    use crate::subdivision::{ControlPoint, bspline_patch, refine_all};

    /// So narrow around that rings meet themselves.
    fn narrow_torus() -> ControlMesh {
        let (n, m) = (3, 7);
        let vertex = |x: u32, y: u32| x % n + n * (y % m);
        let places = (0..n).flat_map(|x| (0..m).map(move |y| (x, y)));
        let faces = places.flat_map(|(x, y)| {
            [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| vertex(x, y))
        });
        let faces: Vec<u32> = faces.collect();
        let count = (n * m) as usize;
        let mesh = ControlMesh::builder(&vec![[0.0; 3]; count], &vec![4; count], &faces);
        mesh.build().expect("a sound mesh")
    }

    #[test]
    fn smooth_rings_are_those_that_walks_find() {
        let mut met = [0; 3];
        let names = [
            "hull",
            "cubes-2x2x2",
            "cubes-3x2x1",
            "creased-torus",
            "cube",
            "ngons",
            "pole-7",
            "sheet",
        ];
        let named = names.map(|name| builtin(name).expect("it is built in"));
        let all = named.into_iter().chain([narrow_torus()]);
        let topologies = all.flat_map(|mesh| {
            let own = Topology::new(&mesh);
            let next = refine_all(&own, Scheme::CatmullClark).topology;
            [own, next]
        });
        for topology in topologies {
            let smooth = SmoothQuads::new(&topology);
            for face in 0..topology.face_count() as u32 {
                let plain = bspline_patch(&topology, face);
                let plain = plain.filter(|patch| patch.crease.is_none() && !patch.mirrored);
                let regular = smooth.regular(face);
                let points = regular.map(|points| points.map(ControlPoint::Vertex));
                assert_eq!(points, plain.map(|patch| patch.points), "face {face}");
                met[0] += usize::from(points.is_some());
                let Some(start) = smooth.start(face) else {
                    continue;
                };
                let Some(ring) = smooth.ring(face, start) else {
                    met[1] += 1;
                    continue;
                };
                met[2] += 1;
                let walked = Ring::of_quad(&topology, face).expect("a quad");
                assert_eq!(ring.vertices(), walked.vertices, "face {face}");
                let found = (start.corner, start.mirrored);
                assert_eq!(found, (walked.start, walked.mirrored), "face {face}");
                let ordered = ring.order().iter().map(|&at| ring.vertices()[at as usize]);
                assert!(ordered.is_sorted(), "face {face}");
            }
        }
        assert!(met.iter().all(|&met| met > 20), "{met:?}");
    }
}
