//! Pipelines that have been made, and as many of them kept as are worth their memory.

use std::sync::Arc;

use hullform::gpu::shaders::{Embedded, Modules};
use hullform::gpu::{Fill, Pipelines};
use hullform::host::{Owned, Style};
use hullform::method::Prepared;

/// How many are kept that nothing is drawn with now, for looks that come again: the colours of a surface, twice. A software driver takes some 6 MB
/// for each, and without a bound all looks that one can ask for took gigabytes.
const SPARE: usize = 20;

/// What pipelines are for: the shaders of the passes, and how they are drawn.
pub type Key = (Vec<&'static str>, Style);

/// Pipelines that have been made.
pub type Made = Vec<(Key, Arc<Owned<Pipelines>>)>;

/// Where shaders are from, and which of all that there have been they are.
#[derive(Clone)]
pub struct Shaders {
    /// Grows with each change.
    pub version: u64,
    /// Their modules.
    pub modules: Arc<dyn Modules + Send + Sync>,
}

/// Pipelines with the shaders that all of them are made of.
pub struct Kept {
    /// What they are made of.
    pub shaders: Shaders,
    /// The latest in use come last.
    pipelines: Made,
    /// How many were made so far.
    made: u64,
}

/// What pipelines must be for to draw what was prepared.
pub fn key(prepared: &Prepared, style: Style) -> Key {
    let shaders = prepared.passes.iter().map(|pass| pass.shader);
    (shaders.collect(), style)
}

impl Kept {
    /// None yet, of the shaders that are built in.
    pub fn new() -> Kept {
        Kept {
            shaders: Shaders {
                version: 0,
                modules: Arc::new(Embedded),
            },
            pipelines: Made::new(),
            made: 0,
        }
    }

    /// Those for a key.
    pub fn find(&self, key: &Key) -> Option<Arc<Owned<Pipelines>>> {
        let found = self.pipelines.iter().find(|(other, _)| other == key);
        found.map(|(_, pipelines)| pipelines.clone())
    }

    /// Those that draw the same patches in another look, the latest.
    pub fn find_like(&self, key: &Key) -> Option<Arc<Owned<Pipelines>>> {
        let lines = |fill| fill == Fill::Lines;
        let of = |style: &Style| {
            (
                style.backend,
                style.residence,
                style.spacing,
                lines(style.fill),
            )
        };
        let like = |(shaders, style): &Key| *shaders == key.0 && of(style) == of(&key.1);
        let mut all = self.pipelines.iter().rev();
        let found = all.find(|(other, _)| like(other));
        found.map(|(_, pipelines)| pipelines.clone())
    }

    /// Takes in what was made.
    pub fn add(&mut self, key: Key, made: Arc<Owned<Pipelines>>) {
        self.pipelines.push((key, made));
        self.made += 1;
    }

    /// How many were made so far, those that were given up among them.
    pub fn made(&self) -> u64 {
        self.made
    }

    /// Goes over to other shaders, with what was made of them: what was made of the old ones.
    #[cfg(feature = "shaderc")]
    pub fn exchange(&mut self, modules: Arc<dyn Modules + Send + Sync>, made: Made) -> Made {
        let version = self.shaders.version + 1;
        self.shaders = Shaders { version, modules };
        std::mem::replace(&mut self.pipelines, made)
    }

    /// Gives up all but those that are wanted and so many of the others, the latest.
    pub fn give_up_but(&mut self, wanted: &[Key]) -> Made {
        let spare = later_of(&mut self.pipelines, |(key, _)| wanted.contains(key));
        self.pipelines.drain(..spare).collect()
    }
}

/// Puts what is in use last, all else in its order; how many of the first are too many.
fn later_of<T>(all: &mut [T], in_use: impl Fn(&T) -> bool) -> usize {
    all.sort_by_key(&in_use);
    let idle = all.iter().filter(|one| !in_use(one)).count();
    idle.saturating_sub(SPARE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_in_use_stays_and_of_the_rest_the_latest() {
        let mut all: Vec<usize> = Vec::new();
        let mut gone = Vec::new();
        for number in 0..3 * SPARE {
            all.push(number);
            let first = later_of(&mut all, |&n| n == 1 || n == number);
            gone.extend(all.drain(..first));
            assert!(all.contains(&1) || number < 1);
        }
        assert_eq!(all.len(), SPARE + 2);
        assert_eq!(gone[..3], [0, 2, 3]);
        let first = later_of(&mut all, |&n| n < 3 * SPARE - 1);
        assert_eq!((first, all[0]), (0, 3 * SPARE - 1));
    }
}
