//! A mesh in the making: faces are added, pulled out and cut away, and edges are creased.

use std::collections::{BTreeSet, HashMap};

use glam::DVec3;

use crate::error::Result;
use crate::mesh::{ControlMesh, SchemeOptions};

/// Points, faces (counter-clockwise from outside) and tags. A face that was cut away is empty.
#[derive(Default)]
pub(super) struct Sketch {
    points: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    creases: Vec<([u32; 2], f32)>,
    holes: Vec<usize>,
    pub options: SchemeOptions,
}

impl Sketch {
    /// Adds a point and hands out its number.
    pub fn point(&mut self, x: f64, y: f64, z: f64) -> u32 {
        self.points.push(DVec3::new(x, y, z));
        self.points.len() as u32 - 1
    }

    /// Adds a face and hands out its number.
    pub fn face(&mut self, vertices: &[u32]) -> usize {
        self.faces.push(vertices.to_vec());
        self.faces.len() - 1
    }

    /// Creases one edge.
    pub fn crease(&mut self, edge: [u32; 2], sharpness: f32) {
        self.creases.push((edge, sharpness));
    }

    /// Creases the edges from each vertex to the next, and from the last to the first.
    pub fn crease_loop(&mut self, vertices: &[u32], sharpness: f32) {
        for (i, &vertex) in vertices.iter().enumerate() {
            self.crease([vertex, vertices[(i + 1) % vertices.len()]], sharpness);
        }
    }

    /// Creases the edges that part `region` from the rest.
    pub fn crease_outline(&mut self, region: &[usize], sharpness: f32) {
        for edge in self.outline(region) {
            self.crease(edge, sharpness);
        }
    }

    /// Makes a face a hole.
    pub fn hole(&mut self, face: usize) {
        self.holes.push(face);
    }

    /// Takes the faces of `region` away.
    pub fn cut(&mut self, region: &[usize]) {
        for &face in region {
            self.faces[face].clear();
        }
    }

    /// The middle of the corners of `region`.
    pub fn centre(&self, region: &[usize]) -> DVec3 {
        let corners = || region.iter().flat_map(|&face| &self.faces[face]);
        let sum: DVec3 = corners().map(|&vertex| self.points[vertex as usize]).sum();
        sum / corners().count() as f64
    }

    /// The outward unit normal of a face.
    pub fn normal(&self, face: usize) -> DVec3 {
        directed_edges(&self.faces[face])
            .map(|[a, b]| self.points[a as usize].cross(self.points[b as usize]))
            .sum::<DVec3>()
            .normalize()
    }

    /// The directed edges of `region` whose other side is not in it.
    fn outline(&self, region: &[usize]) -> Vec<[u32; 2]> {
        let edges = || {
            region
                .iter()
                .flat_map(|&face| directed_edges(&self.faces[face]))
        };
        let inside: BTreeSet<[u32; 2]> = edges().collect();
        edges()
            .filter(|&[a, b]| !inside.contains(&[b, a]))
            .collect()
    }

    /// Moves the vertices of `region`; along its outline new ones are moved and joined to the old by a wall of quads.
    /// Hands out the wall's faces.
    pub fn extrude(&mut self, region: &[usize], moved: impl Fn(DVec3) -> DVec3) -> Vec<usize> {
        let outline = self.outline(region);
        let mut twins = HashMap::new();
        for &[vertex, _] in &outline {
            let twin = self.points.len() as u32;
            if *twins.entry(vertex).or_insert(twin) == twin {
                self.points.push(self.points[vertex as usize]);
            }
        }
        let mut touched = BTreeSet::new();
        for &face in region {
            for vertex in &mut self.faces[face] {
                *vertex = twins.get(vertex).copied().unwrap_or(*vertex);
                touched.insert(*vertex as usize);
            }
        }
        for vertex in touched {
            self.points[vertex] = moved(self.points[vertex]);
        }
        outline
            .iter()
            .map(|[a, b]| self.face(&[*a, *b, twins[b], twins[a]]))
            .collect()
    }

    /// Turns a quad into a regular octagon of `radius` amid quads and triangles. The quad's number stays the octagon's.
    pub fn octagon(&mut self, quad: usize, radius: f64) {
        let corners = self.faces[quad].clone();
        let centre = self.centre(&[quad]);
        let [a, b] = [0, 1].map(|i| self.points[corners[i] as usize]);
        let normal = self.normal(quad);
        let along = (b - a).reject_from_normalized(normal).normalize();
        let across = normal.cross(along);
        let rim: Vec<u32> = (0..8)
            .map(|i| {
                // Corner a lies at 225 degrees: the octagon starts just past it, with side a-b.
                let angle = (f64::from(i) * 45.0 + 247.5).to_radians();
                let p = centre + (along * angle.cos() + across * angle.sin()) * radius;
                self.point(p.x, p.y, p.z)
            })
            .collect();
        for i in 0..4 {
            let (here, next) = (corners[i], corners[(i + 1) % 4]);
            self.face(&[here, next, rim[2 * i + 1], rim[2 * i]]);
            self.face(&[next, rim[(2 * i + 2) % 8], rim[2 * i + 1]]);
        }
        self.faces[quad] = rim;
    }

    /// Checks the mesh and hands it out, without points that no face uses.
    pub fn build(self) -> Result<ControlMesh> {
        let mut numbers = vec![u32::MAX; self.points.len()];
        for &vertex in self.faces.iter().flatten() {
            numbers[vertex as usize] = 0;
        }
        let mut positions = Vec::new();
        for (number, point) in numbers.iter_mut().zip(&self.points) {
            if *number == 0 {
                *number = positions.len() as u32;
                positions.push(point.to_array());
            }
        }
        let faces = || self.faces.iter().filter(|face| !face.is_empty());
        let sizes: Vec<u32> = faces().map(|face| face.len() as u32).collect();
        let vertices: Vec<u32> = faces().flatten().map(|&v| numbers[v as usize]).collect();
        let mut builder = ControlMesh::builder(&positions, &sizes, &vertices).options(self.options);
        for ([a, b], sharpness) in self.creases {
            builder = builder.crease(numbers[a as usize], numbers[b as usize], sharpness);
        }
        for hole in self.holes {
            let cut = self.faces[..hole].iter().filter(|face| face.is_empty());
            builder = builder.hole((hole - cut.count()) as u32);
        }
        builder.build()
    }
}

/// The edges of a face in its own direction.
fn directed_edges(face: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]])
}
