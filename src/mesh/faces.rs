//! The faces of a mesh, which control mesh, topology and outline share.

/// The vertices of faces of any arity, one face after another.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Faces {
    /// Where each face begins, and at last where the last one ends.
    offsets: Vec<u32>,
    vertices: Vec<u32>,
    only_quads: bool,
}

impl Faces {
    /// Of offsets, which begin with 0 and end with the number of vertices, and vertices.
    pub fn new(offsets: Vec<u32>, vertices: Vec<u32>) -> Faces {
        let only_quads = offsets.windows(2).all(|pair| pair[1] - pair[0] == 4);
        Faces {
            offsets,
            vertices,
            only_quads,
        }
    }

    /// Of faces one by one.
    pub fn collect<'a>(faces: impl Iterator<Item = &'a [u32]> + Clone) -> Faces {
        let mut offsets = Vec::with_capacity(faces.size_hint().0 + 1);
        let mut vertices = Vec::with_capacity(faces.clone().map(<[u32]>::len).sum());
        offsets.push(0);
        for face in faces {
            vertices.extend_from_slice(face);
            offsets.push(vertices.len() as u32);
        }
        Faces::new(offsets, vertices)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Where the corners of a face stand in arrays with one entry a corner; nowhere if there is no such face.
    pub fn range(&self, face: usize) -> std::ops::Range<usize> {
        match self.offsets.get(face..) {
            Some(&[start, end, ..]) => start as usize..end as usize,
            _ => 0..0,
        }
    }

    /// The vertices of a face; none where there is no such face.
    pub fn get(&self, face: usize) -> &[u32] {
        &self.vertices[self.range(face)]
    }

    /// The vertices of each face.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.len()).map(|face| self.get(face))
    }

    /// The vertices of all faces.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// The vertices of all faces, if all are quads.
    pub fn quads(&self) -> Option<&[u32]> {
        self.only_quads.then_some(&self.vertices[..])
    }
}
