//! A model that is edited in place: each edit prepares again what it influences, and nothing else (`src/manual/edits.md`).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use hullform::Result;
use hullform::mesh::{Edit, Model};
use hullform::method::{Editable, Update};
use hullform::plan::Database;

use super::draft::Draft;

/// What is edited, as it was prepared last.
pub struct Live {
    model: Model,
    /// One a side.
    sides: Vec<Editable>,
    draft: Draft,
}

/// What followed from an edit.
pub struct Followed {
    /// What has changed of each side.
    pub updates: Vec<Update>,
    /// Vertices around all that may look different in the control cage.
    pub vertices: Vec<u32>,
}

impl Live {
    /// A model that was prepared for all sides as a draft has it; None where its faces are others, whose numbers say nothing.
    pub fn new(model: &Model, sides: Vec<Editable>, draft: Draft) -> Option<Live> {
        let same = model.mesh().face_count() == draft.face_count();
        same.then(|| Live {
            model: model.clone(),
            sides,
            draft,
        })
    }

    /// What is drawn of a side.
    pub fn side(&self, side: usize) -> &Editable {
        &self.sides[side]
    }

    /// Brings what was prepared up to a draft. Places are no part of that. Takes its time: for workers.
    ///
    /// # Errors
    /// What the library refuses. It is of no use afterwards.
    pub fn follow(&mut self, draft: &Draft, database: &Database) -> Result<Followed> {
        let _span = tracing::debug_span!("edit").entered();
        let mut edit = self.model.mesh().edit();
        let mut vertices = Vec::new();
        for (&[a, b], sharpness) in changed(&self.draft.creases, &draft.creases) {
            edit.crease(a, b, sharpness);
            vertices.extend([a, b]);
        }
        for (&vertex, sharpness) in changed(&self.draft.corners, &draft.corners) {
            edit.corner(vertex, sharpness);
            vertices.push(vertex);
        }
        turn(&mut edit, &self.draft.holes, &draft.holes);
        let changes = self.model.apply(&edit)?;
        self.draft = draft.clone();
        let sides = self.sides.iter_mut();
        let updates = sides.map(|side| side.update(&self.model, &changes, database));
        Ok(Followed {
            updates: updates.collect::<Result<_>>()?,
            vertices,
        })
    }
}

/// Sharpness that is another one now; 0 where there is none any more.
fn changed<'d, K: Ord>(
    was: &'d Arc<BTreeMap<K, f32>>,
    is: &'d Arc<BTreeMap<K, f32>>,
) -> impl Iterator<Item = (&'d K, f32)> {
    let same = Arc::ptr_eq(was, is);
    let gone = was.keys().filter(|key| !is.contains_key(key));
    let gone = gone.map(|key| (key, 0.0));
    let other = is.iter().filter(|(key, now)| was.get(key) != Some(now));
    let other = other.map(|(key, &now)| (key, now));
    gone.chain(other).take(if same { 0 } else { usize::MAX })
}

fn turn(edit: &mut Edit, was: &BTreeSet<u32>, is: &BTreeSet<u32>) {
    for &face in was.symmetric_difference(is) {
        edit.hole(face, is.contains(&face));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::draft::{Change, History};
    use hullform::mesh::builtin;
    use hullform::method::{METHODS, MethodOptions};

    #[test]
    fn what_follows_a_draft_there_and_back_is_what_the_draft_is() {
        let mut history = History::new(builtin("hull").expect("there is a hull"));
        let start = history.draft().clone();
        let model = Model::new(start.mesh().expect("a mesh"));
        let database = Database::default();
        let able = METHODS.iter().find(|method| method.edits_in_place());
        let able = able.expect("there is a method that edits");
        let editable = able.prepare_editable(&model, MethodOptions::default(), &database);
        let editable = editable.expect("it is prepared");
        let mut live = Live::new(&model, vec![editable], start.clone()).expect("the same faces");
        let (&edge, &was) = start.creases.iter().next().expect("a crease");
        history.change(Change::Creases([(edge, [was, 0.0])].into()), false);
        history.change(Change::Corners([(1, [0.0, 2.5])].into()), false);
        history.change(Change::Holes([(2, [false, true])].into()), false);
        let changed = history.draft().clone();
        for draft in [&changed, &start, &changed] {
            let followed = live.follow(draft, &database).expect("it follows");
            let update = &followed.updates[0];
            assert!(!update.is_whole && update.words() > 0);
            assert!(
                [edge[0], edge[1], 1]
                    .iter()
                    .all(|v| followed.vertices.contains(v))
            );
            let came = Draft::new(live.model.mesh().clone());
            let tags = |of: &Draft| (of.creases.clone(), of.corners.clone(), of.holes.clone());
            assert_eq!(tags(&came), tags(draft));
        }
        let none = live.follow(&changed, &database).expect("it follows");
        assert_eq!(none.updates[0].words(), 0, "nothing is left to do");
        assert!(none.vertices.is_empty());
    }
}
