//! A control mesh that is being changed, and the changes that were made: each can be taken back.

mod change;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::sync::Arc;

use glam::DVec3;
use hullform::Result;
use hullform::mesh::{
    BoundaryInterpolation, ControlMesh, CreaseMethod, Scheme, TriangleSubdivision,
};

pub use change::Change;

/// How many single things all steps that can be taken back have changed, at most: some 60 bytes each.
const GREATEST_PAST: usize = 1 << 20;

/// An edge by its vertices, the smaller number first.
pub type EdgeKey = [u32; 2];

/// The key of an edge.
pub fn edge_key(a: u32, b: u32) -> EdgeKey {
    [a.min(b), a.max(b)]
}

/// What can be changed of a mesh; its faces stay.
#[derive(Clone, Debug)]
pub struct Draft {
    base: Arc<ControlMesh>,
    /// By vertex.
    pub positions: Arc<Vec<DVec3>>,
    /// Sharpness of the edges that have one.
    pub creases: Arc<BTreeMap<EdgeKey, f32>>,
    /// Sharpness of the vertices that have one.
    pub corners: Arc<BTreeMap<u32, f32>>,
    /// Faces without a surface.
    pub holes: Arc<BTreeSet<u32>>,
}

impl Draft {
    /// A mesh as it is.
    pub fn new(mesh: ControlMesh) -> Draft {
        let creases = mesh.creases().iter();
        let creases = creases.map(|c| (edge_key(c.vertices[0], c.vertices[1]), c.sharpness));
        let corners = mesh.corners().iter().map(|c| (c.vertex, c.sharpness));
        Draft {
            positions: Arc::new(mesh.positions().to_vec()),
            creases: Arc::new(creases.collect()),
            corners: Arc::new(corners.collect()),
            holes: Arc::new(mesh.holes().iter().copied().collect()),
            base: Arc::new(mesh),
        }
    }

    /// How many faces it has.
    pub fn face_count(&self) -> usize {
        self.base.face_count()
    }

    /// As a control mesh.
    ///
    /// # Errors
    /// What the builder refuses.
    pub fn mesh(&self) -> Result<ControlMesh> {
        let positions: Vec<[f64; 3]> = self.positions.iter().map(|p| p.to_array()).collect();
        let sizes: Vec<u32> = self.base.faces().map(|face| face.len() as u32).collect();
        let vertices: Vec<u32> = self.base.faces().flatten().copied().collect();
        let mut builder = ControlMesh::builder(&positions, &sizes, &vertices);
        for (&[a, b], &sharpness) in self.creases.iter() {
            builder = builder.crease(a, b, sharpness);
        }
        for (&vertex, &sharpness) in self.corners.iter() {
            builder = builder.corner(vertex, sharpness);
        }
        for &hole in self.holes.iter() {
            builder = builder.hole(hole);
        }
        if let Some(texture) = self.base.texture() {
            builder = builder.texture(texture.clone());
        }
        builder.options(self.base.options()).build()
    }

    /// Makes a change.
    fn apply(&mut self, change: &Change) {
        match change {
            Change::Creases(all) => set_all(Arc::make_mut(&mut self.creases), all),
            Change::Corners(all) => set_all(Arc::make_mut(&mut self.corners), all),
            Change::Holes(all) => {
                let holes = Arc::make_mut(&mut self.holes);
                for (&face, &[_, is_hole]) in all {
                    match is_hole {
                        true => holes.insert(face),
                        false => holes.remove(&face),
                    };
                }
            }
            Change::Positions(all) => {
                let positions = Arc::make_mut(&mut self.positions);
                for (&vertex, &[_, place]) in all {
                    positions[vertex as usize] = place;
                }
            }
        }
    }

    /// Writes it as an OBJ file with subdivision tags. Numbers are the shortest that read back as the same bits.
    pub fn write_obj(&self, out: &mut dyn Write) -> io::Result<()> {
        for position in self.positions.iter() {
            let DVec3 { x, y, z } = position;
            writeln!(out, "v {x} {y} {z}")?;
        }
        let texture = self.base.texture();
        for value in texture.map_or(&[][..], |texture| &texture.values) {
            writeln!(out, "vt {} {}", value.x, value.y)?;
        }
        for (number, face) in self.base.faces().enumerate() {
            write!(out, "f")?;
            let corners = self.base.corner_range(number);
            for (&vertex, corner) in face.iter().zip(corners) {
                // OBJ counts from 1.
                let vertex = u64::from(vertex) + 1;
                match texture {
                    Some(texture) => {
                        write!(out, " {vertex}/{}", u64::from(texture.indices[corner]) + 1)?;
                    }
                    None => write!(out, " {vertex}")?,
                }
            }
            writeln!(out)?;
        }
        self.write_tags(out)
    }

    fn write_tags(&self, out: &mut dyn Write) -> io::Result<()> {
        for (&[a, b], sharpness) in self.creases.iter() {
            writeln!(out, "t crease 2/1/0 {a} {b} {sharpness}")?;
        }
        for (vertex, sharpness) in self.corners.iter() {
            writeln!(out, "t corner 1/1/0 {vertex} {sharpness}")?;
        }
        for face in self.holes.iter() {
            writeln!(out, "t hole 1/0/0 {face}")?;
        }
        let options = self.base.options();
        let boundary = match options.boundary {
            BoundaryInterpolation::None => 0,
            BoundaryInterpolation::EdgeAndCorner => 1,
            BoundaryInterpolation::EdgeOnly => 2,
        };
        writeln!(out, "t interpolateboundary 1/0/0 {boundary}")?;
        if options.creasing == CreaseMethod::Chaikin {
            writeln!(out, "t creasemethod 0/0/1 chaikin")?;
        }
        if options.triangles == TriangleSubdivision::Smooth {
            writeln!(out, "t smoothtriangles 0/0/1 smooth")?;
        }
        Ok(())
    }

    /// The scheme that a file of this name must have in its name, so that it is read as what it is.
    pub fn scheme(&self) -> Scheme {
        self.base.options().scheme
    }
}

/// Sharpness as it is to be; none at 0.
fn set_all<K: Ord + Copy>(sharp: &mut BTreeMap<K, f32>, all: &BTreeMap<K, [f32; 2]>) {
    for (&key, &[_, sharpness]) in all {
        if sharpness > 0.0 {
            sharp.insert(key, sharpness);
        } else {
            sharp.remove(&key);
        }
    }
}

/// A draft with its past and future.
#[derive(Clone, Debug)]
pub struct History {
    draft: Draft,
    done: Vec<Change>,
    undone: Vec<Change>,
    /// Whether the next change continues the last one: a drag is one step.
    dragging: bool,
    /// Grows with each change of what plans depend on.
    topology: u64,
    /// Grows with each change.
    revision: u64,
    /// After how many steps it was as it is in a file; None when these steps have been left.
    saved: Option<usize>,
}

impl History {
    /// Nothing has been done yet.
    pub fn new(mesh: ControlMesh) -> History {
        History {
            draft: Draft::new(mesh),
            done: Vec::new(),
            undone: Vec::new(),
            dragging: false,
            topology: 0,
            revision: 0,
            saved: Some(0),
        }
    }

    /// What it is now.
    pub fn draft(&self) -> &Draft {
        &self.draft
    }

    /// A number that changes with what plans depend on.
    pub fn topology(&self) -> u64 {
        self.topology
    }

    /// A number that changes with anything.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Steps that can be taken back, and made again.
    pub fn steps(&self) -> [usize; 2] {
        [self.done.len(), self.undone.len()]
    }

    /// Whether something was changed that is in no file.
    pub fn is_changed(&self) -> bool {
        self.saved != Some(self.done.len())
    }

    /// All is in a file, if it is still as it was at a revision.
    pub fn was_saved(&mut self, revision: u64) {
        if self.revision == revision {
            self.saved = Some(self.done.len());
        }
    }

    /// Makes a change; while something is dragged, as a part of the last one if it is of the same things.
    pub fn change(&mut self, change: Change, dragging: bool) {
        self.make(&change);
        self.undone.clear();
        if self.saved.is_some_and(|steps| steps > self.done.len()) {
            self.saved = None;
        }
        let continues = self.dragging && dragging;
        self.dragging = dragging;
        let absorbed = continues
            && self
                .done
                .last_mut()
                .is_some_and(|last| last.absorb(&change));
        if !absorbed {
            self.done.push(change);
            self.forget(GREATEST_PAST);
        } else if self.saved == Some(self.done.len()) {
            self.saved = None;
        }
    }

    /// Forgets the first steps where all together have changed more than so many things; the last one stays.
    fn forget(&mut self, greatest: usize) {
        let mut rest = greatest;
        let late = self.done.iter().rev().take_while(|change| {
            let fits = change.size() <= rest;
            rest -= change.size().min(rest);
            fits
        });
        let early = self.done.len().saturating_sub(late.count().max(1));
        self.done.drain(..early);
        // What is in a file may lie before all that can be taken back.
        self.saved = self.saved.and_then(|steps| steps.checked_sub(early));
    }

    /// What is dragged is let go.
    pub fn drop_it(&mut self) {
        self.dragging = false;
    }

    /// Whether something is being dragged.
    pub fn is_dragging(&self) -> bool {
        self.dragging
    }

    /// Takes the last step back, if there is one.
    pub fn undo(&mut self) -> bool {
        self.dragging = false;
        let Some(change) = self.done.pop() else {
            return false;
        };
        self.make(&change.reversed());
        self.undone.push(change);
        true
    }

    /// Makes the step again that was taken back last.
    pub fn redo(&mut self) -> bool {
        self.dragging = false;
        let Some(change) = self.undone.pop() else {
            return false;
        };
        self.make(&change);
        self.done.push(change);
        true
    }

    fn make(&mut self, change: &Change) {
        self.draft.apply(change);
        self.revision += 1;
        if !change.is_of_positions() {
            self.topology += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hullform::mesh::{builtin, read_obj_bytes};

    fn history() -> History {
        History::new(builtin("hull").expect("there is a hull"))
    }

    fn crease(history: &History, to: f32) -> Change {
        let (&key, &was) = history.draft().creases.iter().next().expect("a crease");
        Change::Creases([(key, [was, to])].into())
    }

    #[test]
    fn what_is_undone_is_as_it_was_and_can_be_made_again() {
        let mut history = history();
        let before = history.draft().mesh().expect("a mesh");
        let change = crease(&history, 0.0);
        history.change(change, false);
        let moved = [history.draft().positions[3], DVec3::ONE];
        history.change(Change::Positions([(3, moved)].into()), false);
        history.change(Change::Holes([(2, [false, true])].into()), false);
        let after = history.draft().mesh().expect("a mesh");
        assert_eq!(history.steps(), [3, 0]);
        while history.undo() {}
        assert_eq!(history.draft().mesh().expect("a mesh"), before);
        while history.redo() {}
        assert_eq!(history.draft().mesh().expect("a mesh"), after);
        assert!(!history.redo());
    }

    #[test]
    fn a_drag_is_one_step_and_the_next_drag_another() {
        let mut history = history();
        for to in [1.0, 2.0, 3.0] {
            let change = crease(&history, to);
            history.change(change, true);
        }
        history.drop_it();
        let change = crease(&history, 4.0);
        history.change(change, true);
        assert_eq!(history.steps(), [2, 0]);
        history.undo();
        assert_eq!(history.draft().creases.values().next(), Some(&3.0));
        history.undo();
        let was = self::history();
        assert_eq!(history.draft().creases, was.draft().creases);
    }

    #[test]
    fn what_is_undone_to_what_is_in_a_file_is_unchanged_and_another_way_there_is_not() {
        let mut history = history();
        let change = |history: &mut History, to| {
            let change = crease(history, to);
            history.change(change, false);
        };
        change(&mut history, 3.0);
        change(&mut history, 4.0);
        history.was_saved(history.revision());
        assert!(!history.is_changed());
        history.undo();
        assert!(history.is_changed());
        history.redo();
        assert!(!history.is_changed());
        history.undo();
        history.undo();
        change(&mut history, 5.0);
        change(&mut history, 6.0);
        assert!(history.is_changed());
        let before = history.revision();
        change(&mut history, 7.0);
        history.was_saved(before);
        assert!(history.is_changed(), "more was done while it was written");
    }

    #[test]
    fn the_past_is_bounded_and_what_is_in_a_file_may_lie_before_it() {
        let mut history = history();
        let step = |history: &mut History, vertices: std::ops::Range<u32>| {
            let was = history.draft().positions.clone();
            let moved = vertices.map(|v| (v, [was[v as usize], DVec3::ONE]));
            history.change(Change::Positions(moved.collect()), false);
        };
        (0..4).for_each(|_| step(&mut history, 0..10));
        history.was_saved(history.revision());
        history.forget(25);
        assert_eq!((history.steps(), history.is_changed()), ([2, 0], false));
        step(&mut history, 0..1);
        history.forget(5);
        assert_eq!((history.steps(), history.is_changed()), ([1, 0], true));
        assert!(history.undo());
        assert!(!history.is_changed(), "that is how it was saved");
        step(&mut history, 0..10);
        step(&mut history, 0..10);
        history.forget(3);
        assert_eq!(history.steps(), [1, 0], "the last step stays");
        history.undo();
        assert!(
            history.is_changed(),
            "the way to what was saved is forgotten"
        );
    }

    #[test]
    fn places_alone_leave_plans_as_they_are() {
        let mut history = history();
        let moved = [history.draft().positions[3], DVec3::ONE];
        history.change(Change::Positions([(3, moved)].into()), false);
        assert_eq!((history.topology(), history.revision()), (0, 1));
        assert!(history.is_changed());
    }

    #[test]
    fn what_is_saved_is_read_as_the_same_mesh() {
        for name in ["hull", "creased-torus", "ngons", "cube"] {
            let mut history = History::new(builtin(name).expect(name));
            history.change(Change::Corners([(1, [0.0, 2.5])].into()), false);
            let mut bytes = Vec::new();
            let draft = history.draft();
            draft.write_obj(&mut bytes).expect("memory does not fail");
            let read = read_obj_bytes("saved.obj", &bytes).expect("it is read");
            let (read, mesh) = (Draft::new(read), draft.mesh().expect("a mesh"));
            assert_eq!(read.mesh().expect("a mesh"), mesh, "{name}");
        }
    }
}
