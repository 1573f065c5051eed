//! What is not manifold, and how sharp that makes it.

use smallvec::SmallVec;

use crate::mesh::topology::{FaceCorner, Topology};
use crate::mesh::{BoundaryInterpolation, INFINITE_SHARPNESS};

impl Topology {
    /// Sharp corners and non-manifold places, after OpenSubdiv's `prepareComponentTagsAndSharpness`.
    pub(super) fn sharpen_non_manifold(&mut self) {
        let manifold = self.manifold_edges();
        let mut at_others = vec![false; self.vertex_count()];
        for (edge, _) in self.edges.iter_mut().zip(&manifold).filter(|pair| !pair.1) {
            edge.sharpness = INFINITE_SHARPNESS;
            for vertex in edge.vertices {
                at_others[vertex as usize] = true;
            }
        }
        for vertex in 0..self.vertex_count() as u32 {
            let plain = !at_others[vertex as usize] && self.is_plain_fan(vertex);
            if self.is_interpolated_corner(vertex)
                || !plain && self.is_non_manifold_corner(vertex, &manifold)
            {
                self.vertex_sharpness[vertex as usize] = INFINITE_SHARPNESS;
            }
        }
    }

    /// Whether a vertex is made infinitely sharp, whatever its tag says.
    pub(super) fn is_sharpened(&self, vertex: u32, manifold: &[bool]) -> bool {
        self.is_interpolated_corner(vertex) || self.is_non_manifold_corner(vertex, manifold)
    }

    /// Whether each edge has at most two faces, and two walk it in opposite directions.
    pub(super) fn manifold_edges(&self) -> Vec<bool> {
        // How often each is walked forwards, and in the upper half how often backwards.
        let mut walks = vec![0u8; self.edges.len()];
        for (&from, &edge) in self.faces.vertices().iter().zip(&self.face_edges) {
            let backwards = self.edges[edge as usize].vertices[0] != from;
            let walks = &mut walks[edge as usize];
            let seen = *walks >> (4 * u8::from(backwards)) & 15;
            *walks += if seen < 2 {
                1 << (4 * u8::from(backwards))
            } else {
                0
            };
        }
        let is_manifold = |walks: u8| walks & 15 < 2 && walks >> 4 < 2;
        walks.into_iter().map(is_manifold).collect()
    }

    /// Whether the faces around `vertex`, all of whose edges are manifold, hang together, as far as few faces tell at once.
    fn is_plain_fan(&self, vertex: u32) -> bool {
        let corners = self.vertex_faces.get(vertex);
        let count = corners.len();
        if count > FEW {
            return false;
        }
        // The edges that leave and enter the vertex in each face.
        let mut sides = [[0; FEW]; 2];
        for (place, &FaceCorner { face, corner }) in corners.iter().enumerate() {
            let edges = self.face_edges(face);
            let last = edges.len() - 1;
            let corner = corner as usize;
            let before = if corner == 0 { last } else { corner - 1 };
            (sides[0][place], sides[1][place]) = (edges[corner], edges[before]);
        }
        // From the first face around, and where that does not lead back, from its other side the other way.
        let mut met = count.min(1);
        for side in [0, 1] {
            let (own, others) = (&sides[side], &sides[1 - side][..count]);
            let (mut at, end) = (own[0], others.first().copied());
            while let Some(next) = others.iter().position(|&other| other == at) {
                if Some(at) == end {
                    return met == count;
                }
                at = own[next];
                met += 1;
                if met > count {
                    return false;
                }
            }
        }
        met == count
    }

    fn is_interpolated_corner(&self, vertex: u32) -> bool {
        self.options.boundary == BoundaryInterpolation::EdgeAndCorner
            && self.vertex_faces.get(vertex).len() == 1
            && self.vertex_edges.get(vertex).len() == 2
    }

    /// A non-manifold vertex is a corner, unless it merely lies on a crease inside the mesh: two edges of more than two faces, between which
    /// each fan of faces around the vertex spans. (OpenSubdiv 3.5 only counted faces and edges; pull request 1338 mended it.)
    fn is_non_manifold_corner(&self, vertex: u32, manifold: &[bool]) -> bool {
        let (edges, faces) = (self.vertex_edges.get(vertex), self.vertex_faces.get(vertex));
        let is_boundary = |&edge: &u32| self.edge_faces.get(edge).len() < 2;
        let non_manifold = edges.iter().copied().filter(|&e| !manifold[e as usize]);
        match non_manifold.collect::<SmallVec<[u32; 4]>>()[..] {
            [] => !faces.is_empty() && !self.is_single_fan(vertex, manifold),
            [from, to] if faces.len() > edges.len() && !edges.iter().any(is_boundary) => {
                !self.fans_span(vertex, [from, to], manifold)
            }
            _ => true,
        }
    }

    /// Whether the faces around `vertex` hang together across its edges, all of which are manifold.
    fn is_single_fan(&self, vertex: u32, manifold: &[bool]) -> bool {
        let corners = self.vertex_faces.get(vertex);
        let face = corners[0].face;
        let [a, b] = self.edges_at(face, vertex);
        let (mut met, end) = self.sweep(vertex, face, a, manifold);
        if end != a {
            met += self.sweep(vertex, face, b, manifold).0 - 1;
        }
        met == corners.len()
    }

    /// Whether all fans of faces around `vertex` lead from one of two edges to the other, the only ones there that are no plain inner edges.
    fn fans_span(&self, vertex: u32, [from, to]: [u32; 2], manifold: &[bool]) -> bool {
        let mut met = 0;
        for &face in self.edge_faces.get(from) {
            let (faces, end) = self.sweep(vertex, face, from, manifold);
            if end != to {
                return false;
            }
            met += faces;
        }
        met == self.vertex_faces.get(vertex).len()
    }

    /// The number of faces around `vertex` that follow each other from `face` on, away from its edge `from`, and the edge at which they end: `from` itself
    /// where they close.
    fn sweep(&self, vertex: u32, face: u32, from: u32, manifold: &[bool]) -> (usize, u32) {
        let [a, b] = self.edges_at(face, vertex);
        let mut at = (face, if a == from { b } else { a });
        let mut met = 1;
        while at.1 != from && manifold[at.1 as usize] {
            let Some(next) = self.step(vertex, at.0, at.1) else {
                break;
            };
            at = next;
            met += 1;
        }
        (met, at.1)
    }
}

/// The faces around a vertex are few up to so many: they are searched one by one.
const FEW: usize = 8;
