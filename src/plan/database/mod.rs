//! The database of plans: every configuration that was met, and its plan, each once (Brainerd et al. 2016, section 4.3).
//!
//! Plans of all kinds are in one store that only ever grows, with numbers that never change: models share it, edits of a model extend it, and threads use it
//! at once. It may be kept in a file, which any number of processes share.

mod check;
mod entry;
mod file;
mod records;
mod words;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::error::{Error, Result};
use crate::plan::configuration::Configuration;
use crate::plan::level::StepsPool;
use crate::plan::options::PlanOptions;
use crate::plan::row_pool::SharedPool;
use crate::plan::stencils::Stencils;

pub use entry::{Entry, Key, Kind};
pub use file::GREATEST_BYTES;
use file::PlanFile;
pub use records::VERSION;

/// Plans by number, each once.
#[derive(Debug, Default)]
pub struct Database {
    known: RwLock<Known>,
    /// The weights of all plans.
    pool: SharedPool,
    file: Option<Mutex<PlanFile>>,
    /// One whose plans are found here as well.
    under: Option<Arc<Database>>,
}

/// So many plans are on their way at a time: before they share their weights they take several times the memory.
const AT_A_TIME: usize = 1 << 9;

/// The numbers of plans that are over those of another database begin here.
const OVER: u32 = 1 << 31;

/// Numbers of configurations.
type Numbers = FxHashMap<Configuration, u32>;

#[derive(Debug, Default)]
struct Known {
    numbers: FxHashMap<(Kind, PlanOptions), Numbers>,
    entries: Vec<Arc<Entry>>,
}

/// What a database's file is like.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileState {
    /// Its bytes.
    pub bytes: u64,
    /// Bytes that belong to no entry: what an interrupted writer left, or damage.
    pub lost_bytes: u64,
    /// Entries that repeat earlier ones.
    pub repeated: usize,
    /// Entries of each kind, in the order of [`Kind::ALL`].
    pub entries: [usize; 5],
    /// Entries that are read without fault and make no sense nevertheless. Filled in by [`Database::verify`] alone.
    pub unsound: usize,
}

impl Known {
    fn get(
        &self,
        kind: Kind,
        options: PlanOptions,
        of: &Configuration,
    ) -> Option<(u32, Arc<Entry>)> {
        let &number = self.numbers.get(&(kind, options))?.get(of)?;
        Some((number, self.entries[number as usize].clone()))
    }

    /// Appends a plan, unless there is one.
    fn add(&mut self, key: Key, entry: Entry) -> (u32, Arc<Entry>) {
        let next = self.entries.len() as u32;
        let numbers = self.numbers.entry((key.kind, key.options)).or_default();
        let number = *numbers.entry(key.configuration).or_insert(next);
        if number == next {
            self.entries.push(Arc::new(entry));
        }
        (number, self.entries[number as usize].clone())
    }
}

/// A lock's content, which no panic leaves half-written: all is built before it is taken.
fn whole<T>(locked: std::result::Result<T, PoisonError<T>>) -> T {
    locked.unwrap_or_else(PoisonError::into_inner)
}

impl Database {
    /// One that is kept in a file, which is begun where there is none.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read or written; [`Error::Input`] for a file that is something else.
    pub fn open(path: impl AsRef<Path>) -> Result<Database> {
        Ok(Database {
            known: RwLock::default(),
            pool: SharedPool::default(),
            file: Some(Mutex::new(PlanFile::open(path.as_ref())?)),
            under: None,
        })
    }

    /// One over another: it finds what that has, and keeps what is new for itself, as long as it lives. For what passes, as each sharpness that an edge
    /// has while it is dragged: neither the other's memory nor its file grows by plans that nobody meets again.
    pub fn over(under: Arc<Database>) -> Database {
        Database {
            under: Some(under),
            ..Database::default()
        }
    }

    /// How many plans were asked for so far.
    pub fn len(&self) -> usize {
        whole(self.known.read()).entries.len()
    }

    /// Whether there were none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers and plans of configurations, which are read or built, in parallel, where they are new. A file that cannot be written any more costs
    /// a warning and nothing else.
    ///
    /// # Errors
    /// As [`Plan::build`](crate::plan::Plan::build) and its like.
    pub fn plans(
        &self,
        kind: Kind,
        options: PlanOptions,
        configurations: &[&Configuration],
    ) -> Result<Vec<(u32, Arc<Entry>)>> {
        let find = || self.find(kind, options, configurations);
        let mut found = find();
        let mut seen = FxHashSet::default();
        let missing: Vec<Key> = found
            .iter()
            .zip(configurations)
            .filter(|(found, configuration)| found.is_none() && seen.insert(**configuration))
            .map(|(_, &configuration)| Key {
                kind,
                options,
                configuration: configuration.clone(),
            })
            .collect();
        if !missing.is_empty() {
            self.add(missing)?;
            found = find();
        }
        let all = found.into_iter();
        Ok(all.map(|found| found.expect("it was added")).collect())
    }

    /// What is known of configurations.
    fn find(
        &self,
        kind: Kind,
        options: PlanOptions,
        configurations: &[&Configuration],
    ) -> Vec<Option<(u32, Arc<Entry>)>> {
        let all = configurations.iter();
        let known = whole(self.known.read());
        let Some(under) = &self.under else {
            return all.map(|of| known.get(kind, options, of)).collect();
        };
        // What was found here once has the same number again, even where the other has it by now.
        let found = under.find(kind, options, configurations);
        let own = |of: &Configuration| {
            let (number, entry) = known.get(kind, options, of)?;
            Some((number | OVER, entry))
        };
        all.zip(found)
            .map(|(of, found)| own(of).or(found))
            .collect()
    }

    /// Reads or builds plans, and keeps them.
    fn add(&self, keys: Vec<Key>) -> Result<()> {
        let mut keys = keys.into_iter();
        let steps = StepsPool::default();
        loop {
            let some: Vec<Key> = keys.by_ref().take(AT_A_TIME).collect();
            if some.is_empty() {
                return Ok(());
            }
            self.add_some(some, &steps)?;
        }
    }

    fn add_some(&self, keys: Vec<Key>, steps: &StepsPool) -> Result<()> {
        let under = self.under.as_deref().unwrap_or(self);
        let stored: Vec<Option<Vec<u32>>> = match &under.file {
            None => vec![None; keys.len()],
            Some(file) => {
                let words: Vec<Vec<u32>> = keys.iter().map(words::of_key).collect();
                whole(file.lock()).find_all(&words)
            }
        };
        let made: Result<Vec<(Entry, Option<bool>)>> = keys
            .par_iter()
            .zip(stored)
            .map_init(
                || steps.rounded(),
                |steps, (key, stored)| {
                    let read = stored.map(|stored| words::entry(&stored, key));
                    let sound = read.as_ref().map(Option::is_some);
                    let entry = match read.flatten() {
                        Some(entry) => entry,
                        None => key.kind.build(&key.configuration, key.options, steps)?,
                    };
                    Ok((entry, sound))
                },
            )
            .collect();
        let made = made?;
        if let Some(file) = &self.file {
            let mut file = whole(file.lock());
            write(&mut file, &keys, &made);
        }
        let rows: Vec<_> = made
            .iter()
            .map(|(entry, _)| entry.plan().packed_stencils())
            .collect();
        let pooled = self.pool.keep(rows.iter().map(|rows| &**rows));
        drop(rows);
        let mut known = whole(self.known.write());
        for ((key, (mut entry, _)), rows) in keys.into_iter().zip(made).zip(pooled) {
            let plan = entry.plan_mut();
            plan.stencils = Stencils::pooled(plan.ring_size, rows);
            known.add(key, entry);
        }
        Ok(())
    }

    /// What its file is like; nothing without one.
    pub fn state(&self) -> Option<FileState> {
        let file = whole(self.file.as_ref()?.lock());
        Some(state_of(&file))
    }

    /// Reads every entry of the file, and tells what is wrong with it.
    pub fn verify(&self) -> Option<FileState> {
        let mut file = whole(self.file.as_ref()?.lock());
        let mut state = state_of(&file);
        for key in file.keys() {
            let sound = file.find(&key).is_some_and(|entry| is_sound(&key, &entry));
            state.unsound += usize::from(!sound);
        }
        Some(state)
    }

    /// Writes the file anew without what is damaged, repeated or makes no sense, and of the rest only the latest entries that take up to so many bytes.
    ///
    /// # Errors
    /// [`Error::Write`]; the file stays as it was then.
    pub fn prune(&self, most_bytes: u64) -> Result<()> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let mut file = whole(file.lock());
        let keys = file.keys();
        let sizes: Vec<u64> = keys
            .iter()
            .map(|key| {
                let entry = file.find(key);
                entry.map_or(0, |entry| 16 + 4 * (key.len() + entry.len()) as u64)
            })
            .collect();
        let mut rest = most_bytes.saturating_sub(records::HEADER as u64);
        let latest = sizes.iter().rev().take_while(|&&size| {
            let fits = size <= rest;
            rest -= size.min(rest);
            fits
        });
        let mut early = keys.len() - latest.count();
        let kept = file.rewrite(|key, entry| {
            let is_late = early == 0;
            early = early.saturating_sub(1);
            is_late && is_sound(key, entry)
        });
        kept.map_err(|source| Error::Write {
            path: file.path().into(),
            source,
        })
    }

    /// Every entry of the file that makes sense, in the order in which they were written.
    pub fn entries(&self) -> Vec<(Key, Entry)> {
        let Some(file) = &self.file else {
            return Vec::new();
        };
        let mut file = whole(file.lock());
        let keys = file.keys().into_iter();
        let entries = keys.filter_map(|words| {
            let key = words::key(&words)?;
            let entry = words::entry(&file.find(&words)?, &key)?;
            Some((key, entry))
        });
        entries.collect()
    }
}

fn is_sound(key: &[u32], entry: &[u32]) -> bool {
    words::key(key).is_some_and(|key| words::entry(entry, &key).is_some())
}

fn state_of(file: &PlanFile) -> FileState {
    let (bytes, lost_bytes, repeated) = file.state();
    let mut state = FileState {
        bytes,
        lost_bytes,
        repeated,
        ..FileState::default()
    };
    for key in file.keys() {
        match key
            .first()
            .and_then(|&kind| state.entries.get_mut(kind as usize))
        {
            Some(count) => *count += 1,
            None => state.unsound += 1,
        }
    }
    state
}

/// Appends what was built.
fn write(file: &mut PlanFile, keys: &[Key], made: &[(Entry, Option<bool>)]) {
    let mut new = Vec::new();
    for (key, (entry, sound)) in keys.iter().zip(made) {
        if *sound == Some(true) {
            continue;
        }
        let key = words::of_key(key);
        if sound.is_some() {
            file.forget(&key);
        }
        new.push((key, words::of_entry(entry)));
    }
    if new.is_empty() {
        return;
    }
    if let Err(error) = file.append(&new) {
        tracing::warn!(
            "{}: {error}: {} plans are not kept; `hullform db prune` makes room in it",
            file.path().display(),
            new.len()
        );
    }
}
