//! The faces of a mesh, which control mesh, topology and outline share.

use std::collections::BTreeMap;

/// The vertices of faces of any arity, one face after another. A face that was removed has none, and keeps its number.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Faces {
    /// Where each face begins, and at last where the last one ends; empty where all are quads.
    offsets: Vec<u32>,
    vertices: Vec<u32>,
    only_quads: bool,
    /// How many corners each face had that was removed: whatever is numbered by corners keeps its numbers, and a face of as many may take its place.
    removed: BTreeMap<u32, u32>,
}

/// What an edit makes of a face.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slot {
    /// The corners that a face of this number has, or had.
    pub corners: u32,
    /// Its vertices, as many, or none where there is no face any more.
    pub vertices: Vec<u32>,
}

impl Faces {
    /// Of offsets, which begin with 0 and end with the number of vertices, and vertices.
    pub fn new(offsets: Vec<u32>, vertices: Vec<u32>) -> Faces {
        let only_quads = offsets.windows(2).all(|pair| pair[1] - pair[0] == 4);
        Faces {
            offsets: if only_quads { Vec::new() } else { offsets },
            vertices,
            only_quads,
            removed: BTreeMap::new(),
        }
    }

    /// These faces with others in some places, by their numbers; those from the number of faces on are new, without a gap.
    pub fn edited(&self, slots: &BTreeMap<u32, Slot>) -> Faces {
        let last = slots
            .last_key_value()
            .map_or(0, |(&face, _)| face as usize + 1);
        let mut offsets = Vec::with_capacity(self.len().max(last) + 1);
        let mut vertices = Vec::with_capacity(self.vertices.len());
        let mut removed = self.removed.clone();
        offsets.push(0);
        let mut next = 0;
        // What lies between two faces that change is moved as a whole.
        let mut keep = |until: usize, offsets: &mut Vec<u32>, vertices: &mut Vec<u32>| {
            let until = until.min(self.len());
            if next < until {
                let (start, end) = (self.offset(next), self.offset(until));
                let first = vertices.len();
                let ends = (next + 1..=until).map(|face| self.offset(face) - start + first);
                offsets.extend(ends.map(|end| end as u32));
                vertices.extend_from_slice(&self.vertices[start..end]);
            }
            next = until + 1;
        };
        for (&face, slot) in slots {
            keep(face as usize, &mut offsets, &mut vertices);
            vertices.extend_from_slice(&slot.vertices);
            offsets.push(vertices.len() as u32);
            match slot.vertices.is_empty() {
                true => removed.insert(face, slot.corners),
                false => removed.remove(&face),
            };
        }
        keep(self.len(), &mut offsets, &mut vertices);
        Faces {
            removed,
            ..Faces::new(offsets, vertices)
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
        match self.only_quads {
            true => self.vertices.len() / 4,
            false => self.offsets.len().saturating_sub(1),
        }
    }

    /// Where a face begins, or the last one ends.
    fn offset(&self, face: usize) -> usize {
        match self.only_quads {
            true => 4 * face,
            false => self.offsets[face] as usize,
        }
    }

    /// The faces that were removed, with the corners that each had.
    pub fn removed(&self) -> &BTreeMap<u32, u32> {
        &self.removed
    }

    /// The corners that a face has, or had before it was removed.
    pub fn corners(&self, face: usize) -> usize {
        match self.range(face).len() {
            0 => self.removed.get(&(face as u32)).map_or(0, |&n| n as usize),
            own => own,
        }
    }

    /// Where the corners of a face stand in arrays with one entry a corner; nowhere if there is no such face.
    pub fn range(&self, face: usize) -> std::ops::Range<usize> {
        match face < self.len() {
            true => self.offset(face)..self.offset(face + 1),
            false => 0..0,
        }
    }

    /// Where the corners of a face without any would stand: behind those of the one before.
    pub fn start(&self, face: usize) -> std::ops::Range<usize> {
        let start = match self.len() {
            0 => 0,
            count => self.offset(face.min(count)),
        };
        start..start
    }

    /// Those that were not removed.
    pub fn compacted(&self) -> Faces {
        Faces::collect(self.iter().filter(|face| !face.is_empty()))
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
