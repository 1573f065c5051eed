//! What was prepared of a mesh that is edited.

use crate::error::{Error, Misuse, Result};
use crate::mesh::{ChangeSet, Model};
use crate::method::{MacroFaces, Method, MethodOptions, PassChange, Prepared, Update};
use crate::plan::Database;

/// Plans some faces of a model again.
pub(super) trait Edits: Send + Sync {
    /// Gives passes room for patches to come.
    fn spare(&mut self, prepared: &mut Prepared);

    /// Plans those faces again that an edit has changed. Where that fails the passes are as they were, and nothing is edited any more.
    ///
    /// # Errors
    /// As [`Method::prepare`].
    fn edit(
        &mut self,
        prepared: &mut Prepared,
        model: &Model,
        changes: &ChangeSet,
        database: &Database,
    ) -> Result<Vec<PassChange>>;
}

/// What a method prepared of a mesh that is edited: after each edit only what it influences is prepared again, where the method can
/// ([`Method::edits_in_place`]); else, and where that says so, all of it.
///
/// A patch keeps its number in its pass as long as its face is drawn with the same shaders. Patches that are not drawn any more leave a vacant slot
/// ([`Pass::is_vacant`](super::Pass::is_vacant)) that others take later, and there are always some to spare. Plans only ever get more: those that
/// nothing uses any more are let go when there is four times as much as there was at first, see [`is_overgrown`](Editable::is_overgrown).
pub struct Editable {
    method: Method,
    options: MethodOptions,
    prepared: Prepared,
    /// None where the method prepares everything again.
    edits: Option<Box<dyn Edits>>,
    /// The revision of the model that it is of.
    revision: u64,
    /// The words of all tables when everything was prepared last.
    words: usize,
}

impl std::fmt::Debug for Editable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = f.debug_struct("Editable");
        shown.field("method", &self.method.name);
        shown
            .field("revision", &self.revision)
            .finish_non_exhaustive()
    }
}

impl Method {
    /// Whether edits prepare again only what they influence; with [`MacroFaces`] not. Else all of it is prepared again, which is as right.
    pub fn edits_in_place(&self) -> bool {
        self.edits.is_some()
    }

    /// Prepares a model that will be edited; see [`Editable`]. It has all passes that the method may have, those without patches too, and no
    /// [`Prepared::plans`] after an edit. With plans of a database, as for [`prepare_with`](Method::prepare_with).
    ///
    /// # Errors
    /// As [`Method::prepare`].
    pub fn prepare_editable(
        &self,
        model: &Model,
        options: impl Into<MethodOptions>,
        database: &Database,
    ) -> Result<Editable> {
        let options = options.into();
        let (prepared, edits) = self.prepare_whole(model, options, database)?;
        Ok(Editable {
            method: *self,
            options,
            words: prepared.table_words(),
            prepared,
            edits,
            revision: model.revision(),
        })
    }

    fn prepare_whole(
        &self,
        model: &Model,
        options: MethodOptions,
        database: &Database,
    ) -> Result<(Prepared, Option<Box<dyn Edits>>)> {
        // Lines of macro faces lead far from what is edited.
        let is_apart = options.macro_faces == MacroFaces::None;
        let Some(edits) = self.edits.filter(|_| is_apart) else {
            return Ok((self.prepare_with(model, options, database)?, None));
        };
        self.check_model(model)?;
        let (prepared, mut edits) = edits(model, options, database)?;
        let mut prepared = self.completed(prepared, model);
        edits.spare(&mut prepared);
        Ok((prepared, Some(edits)))
    }
}

/// How much more there may be than at first.
const OVERGROWN: usize = 4;
/// So many words are no matter.
const FEW_WORDS: usize = 1 << 18;

impl Editable {
    /// What is drawn.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Brings what was prepared up to an edited model. Changes of one model come in their order; where one was left out, all is prepared anew.
    ///
    /// Costs what the faces around the edit cost, and a pass over the model's arrays, in rayon's current pool.
    ///
    /// # Errors
    /// [`Misuse::OtherMesh`] when the changes did not lead to this model. As [`Method::prepare`]: what is prepared stays as it was then, and the next
    /// update prepares all anew.
    pub fn update(
        &mut self,
        model: &Model,
        changes: &ChangeSet,
        database: &Database,
    ) -> Result<Update> {
        if model.revision() != changes.after() {
            return Err(Error::Misuse(Misuse::OtherMesh));
        }
        self.method.check_model(model)?;
        let is_next = changes.before() == self.revision;
        let most = OVERGROWN * self.words + FEW_WORDS;
        match &mut self.edits {
            Some(_) if !is_next || self.prepared.table_words() > most => {}
            Some(edits) => {
                let before = self.prepared.version();
                let patches = self.prepared.capacities();
                let sides = self.prepared.renumber(changes, model);
                let passes = match changes.faces() {
                    // Positions alone, or tags that say what is so anyhow.
                    [] if !changes.is_reconnected() => Ok(Vec::new()),
                    _ => edits.edit(&mut self.prepared, model, changes, database),
                };
                let passes = passes.inspect_err(|_| {
                    self.edits = None;
                    self.prepared.restore(sides);
                })?;
                if changes.is_reconnected() {
                    self.prepared.surround(model);
                }
                let outline = &mut self.prepared.outline;
                outline.edit_limits(model, changes);
                let is_whole = patches != self.prepared.capacities();
                self.prepared.follow(model, is_whole);
                self.revision = model.revision();
                let passes = if is_whole { Vec::new() } else { passes };
                let is_reconnected = changes.is_reconnected();
                return Ok(Update::new(is_whole, passes, before, is_reconnected));
            }
            None => {}
        }
        self.renew(model, database)
    }

    /// Prepares all anew: what nothing uses any more goes, and patches get other numbers.
    ///
    /// # Errors
    /// As [`Method::prepare`].
    pub fn renew(&mut self, model: &Model, database: &Database) -> Result<Update> {
        let (prepared, edits) = self.method.prepare_whole(model, self.options, database)?;
        self.words = prepared.table_words();
        (self.prepared, self.edits) = (prepared, edits);
        self.revision = model.revision();
        Ok(Update::new(true, Vec::new(), 0, true))
    }

    /// Whether there is more than twice as much as when everything was prepared last: a good time to [`renew`](Self::renew) it, before an update has to.
    pub fn is_overgrown(&self) -> bool {
        self.edits.is_some() && self.prepared.table_words() > 2 * self.words + FEW_WORDS
    }
}
