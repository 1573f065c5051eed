//! The faces and vertices that an edit leads to, step by step, before anything of the mesh changes.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rustc_hash::FxHashSet;

use crate::error::{Error, Place, Result};
use crate::mesh::ControlMesh;
use crate::mesh::control_mesh::{check_face, check_position};
use crate::mesh::faces::Slot;

/// See the top of this file.
pub(super) struct Draft<'a> {
    mesh: &'a ControlMesh,
    /// Faces that are other ones than the mesh's, by their numbers.
    pub slots: BTreeMap<u32, Slot>,
    /// Vertices behind the mesh's.
    pub positions: Vec<DVec3>,
    /// The vertices of these, and the ends of their sides, the lesser first; found at the end.
    pub used: FxHashSet<u32>,
    pub sides: FxHashSet<[u32; 2]>,
    /// Numbers of faces that were added, in the order of the steps.
    pub added: Vec<u32>,
    /// How many numbers of faces there are.
    count: u32,
    /// Numbers of removed faces, behind the corners that they had; found when a face is added.
    vacant: Option<BTreeSet<(u32, u32)>>,
}

impl Draft<'_> {
    pub fn new(mesh: &ControlMesh) -> Draft<'_> {
        Draft {
            mesh,
            slots: BTreeMap::new(),
            positions: Vec::new(),
            used: FxHashSet::default(),
            sides: FxHashSet::default(),
            added: Vec::new(),
            count: mesh.face_count() as u32,
            vacant: None,
        }
    }

    /// The vertices of a face as the steps until now have left it.
    pub fn face(&self, face: u32) -> &[u32] {
        match self.slots.get(&face) {
            Some(slot) => &slot.vertices,
            None => self.mesh.face(face as usize),
        }
    }

    /// Where a vertex is, which must be one.
    pub fn position(&self, vertex: u32) -> DVec3 {
        let known = self.mesh.positions();
        match known.get(vertex as usize) {
            Some(&position) => position,
            None => self.positions[vertex as usize - known.len()],
        }
    }

    pub fn vertex_count(&self) -> usize {
        self.mesh.vertex_count() + self.positions.len()
    }

    pub fn add_vertex(&mut self, position: DVec3) -> Result<()> {
        check_position(self.vertex_count(), position, false)?;
        self.positions.push(position);
        Ok(())
    }

    /// Of faces that were removed, that with the least number whose corners were as many makes room.
    pub fn add_face(&mut self, vertices: &[u32]) -> Result<()> {
        let corners = vertices.len() as u32;
        let vacant = self.vacant();
        let free = vacant.range((corners, 0)..=(corners, u32::MAX)).next();
        let free = free.copied();
        let face = free.map_or(self.count, |(_, face)| face);
        self.check_face(face, vertices)?;
        match free {
            Some(free) => _ = self.vacant().remove(&free),
            None => self.count += 1,
        }
        let vertices = vertices.to_vec();
        self.slots.insert(face, Slot { corners, vertices });
        self.added.push(face);
        Ok(())
    }

    pub fn remove_face(&mut self, face: u32) -> Result<()> {
        self.check_is_face(face)?;
        let corners = self.face(face).len() as u32;
        self.vacant().insert((corners, face));
        let vertices = Vec::new();
        self.slots.insert(face, Slot { corners, vertices });
        self.added.retain(|&added| added != face);
        Ok(())
    }

    pub fn reconnect_face(&mut self, face: u32, vertices: &[u32]) -> Result<()> {
        self.check_is_face(face)?;
        self.check_face(face, vertices)?;
        let (before, corners) = (self.face(face).len(), vertices.len());
        if before != corners {
            return Err(Error::input(
                Place::Face(face as usize),
                format!("it has {before} corners, and is to be connected to {corners} vertices"),
                "a face keeps its number with as many corners: remove it, and add another",
            ));
        }
        let (corners, vertices) = (corners as u32, vertices.to_vec());
        self.slots.insert(face, Slot { corners, vertices });
        Ok(())
    }

    /// Refuses a number that no face has, or no more.
    pub fn check_is_face(&self, face: u32) -> Result<()> {
        let place = Place::Face(face as usize);
        let count = self.count;
        if face >= count {
            return Err(Error::input(
                place,
                format!("an edit names it, but the mesh has {count} faces"),
                "face indices must be below the number of faces",
            ));
        }
        if self.face(face).is_empty() {
            return Err(Error::input(
                place,
                "an edit names it, but it was removed",
                "name a face that is there, or add one",
            ));
        }
        Ok(())
    }

    fn check_face(&self, face: u32, vertices: &[u32]) -> Result<()> {
        check_face(face as usize, vertices, self.vertex_count())?;
        let scheme = self.mesh.options().scheme;
        scheme.check_face(face as usize, vertices.len())
    }

    /// Takes down what faces use at last, and refuses what no mesh is: without faces, or with more than have numbers.
    pub fn finish(&mut self) -> Result<()> {
        for slot in self.slots.values() {
            let next = slot.vertices.iter().cycle().skip(1);
            let sides = slot.vertices.iter().zip(next);
            let ends = |(&a, &b): (&u32, &u32)| [a.min(b), a.max(b)];
            self.sides.extend(sides.map(ends));
            self.used.extend(&slot.vertices);
        }
        let (mut faces, mut corners) = (0, 0);
        for (&face, slot) in &self.slots {
            let [before, now] = [self.mesh.face(face as usize), &slot.vertices];
            faces += i64::from(!now.is_empty()) - i64::from(!before.is_empty());
            corners += now.len() as i64 - before.len() as i64;
        }
        let known = self.mesh.shared_faces();
        faces += (known.len() - known.removed().len()) as i64;
        corners += known.vertices().len() as i64;
        if faces == 0 {
            return Err(Error::input(
                Place::Mesh,
                "an edit removes all faces",
                "leave at least one face, or make it a hole",
            ));
        }
        if corners.max(self.vertex_count() as i64) >= i64::from(u32::MAX) {
            return Err(Error::input(
                Place::Mesh,
                format!("an edit leads to {corners} corners of faces"),
                "corners and vertices are numbered by 32 bits: divide the mesh",
            ));
        }
        Ok(())
    }

    fn vacant(&mut self) -> &mut BTreeSet<(u32, u32)> {
        let removed = self.mesh.shared_faces().removed().iter();
        let known = || removed.map(|(&face, &corners)| (corners, face)).collect();
        self.vacant.get_or_insert_with(known)
    }
}
