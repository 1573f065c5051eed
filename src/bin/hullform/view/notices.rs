//! What there is to be told, for a while.

use std::time::{Duration, Instant};

use hullform::error::visible;

/// How long words stay.
const STAY: Duration = Duration::from_secs(6);
/// How long warnings stay.
const WARNING_STAYS: Duration = Duration::from_secs(20);
/// How many are shown at once.
const MOST: usize = 6;

/// Something that happened.
#[derive(Clone, Debug)]
pub struct Notice {
    /// In words.
    pub words: String,
    /// Whether something is wrong.
    pub is_error: bool,
    since: Instant,
}

/// What happened lately.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    all: Vec<Notice>,
    errors: u64,
}

impl Notices {
    /// Tells that something was done.
    pub fn tell(&mut self, words: impl Into<String>) {
        self.add(words.into(), false);
    }

    /// Tells that something is wrong.
    pub fn warn(&mut self, words: impl Into<String>) {
        self.errors += 1;
        self.add(words.into(), true);
    }

    fn add(&mut self, words: String, is_error: bool) {
        let words = words.lines().map(visible).collect::<Vec<_>>().join("\n");
        self.all.retain(|notice| notice.words != words);
        self.all.push(Notice {
            words,
            is_error,
            since: Instant::now(),
        });
        let over = self.all.len().saturating_sub(MOST);
        self.all.drain(..over);
    }

    /// What has been read.
    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// What is to be seen now.
    pub fn seen(&mut self) -> &[Notice] {
        self.all
            .retain(|notice| notice.since.elapsed() < notice.stay());
        &self.all
    }

    /// The latest.
    pub fn last(&self) -> Option<&Notice> {
        self.all.last()
    }

    /// How many warnings there have been.
    pub fn errors(&self) -> u64 {
        self.errors
    }

    /// How long nothing changes.
    pub fn until_change(&self) -> Option<Duration> {
        let left = self
            .all
            .iter()
            .map(|n| n.stay().saturating_sub(n.since.elapsed()));
        left.min()
    }
}

impl Notice {
    fn stay(&self) -> Duration {
        if self.is_error { WARNING_STAYS } else { STAY }
    }
}
