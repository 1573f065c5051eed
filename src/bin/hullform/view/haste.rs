//! Coarser pictures while something moves, on devices that are slow at what is to be drawn: the window answers, and the full picture follows.

use std::time::{Duration, Instant};

/// A scene that takes longer is drawn coarser while it changes.
const SLOW: f64 = 0.1;
/// What a coarser one is to take.
const QUICK: f64 = 0.04;
/// How long nothing must change before the full picture is drawn.
const REST: Duration = Duration::from_millis(250);

/// What scenes took, and whether the last one was coarser.
#[derive(Clone, Copy, Debug, Default)]
pub struct Haste {
    /// Seconds that the device took for the last full scene.
    full: Option<f64>,
    /// Since when there is nothing but a coarser one.
    since: Option<Instant>,
    /// When the last scene was seen to be done, and what it took.
    last: Option<(Instant, Duration)>,
}

impl Haste {
    /// Tells what the device took for the scene that was drawn last.
    pub fn took(&mut self, seconds: f64) {
        let taken = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.last = Some((Instant::now(), taken)).filter(|_| seconds > QUICK);
        if self.since.is_none() {
            self.full = Some(seconds);
        }
    }

    /// The level at which a scene is drawn that has changed, instead of a greater one.
    pub fn level(&self, level: f32) -> f32 {
        match self.full.filter(|_| self.is_slow()) {
            // Vertices go by the square.
            Some(full) => (level * (QUICK / full).sqrt() as f32)
                .floor()
                .max(1.0)
                .min(level),
            None => level,
        }
    }

    /// Whether the full scene takes long.
    pub fn is_slow(&self) -> bool {
        self.full.is_some_and(|full| full > SLOW)
    }

    /// Tells that a scene was drawn, coarser or not.
    pub fn drawn(&mut self, coarser: bool) {
        self.since = coarser.then(Instant::now);
    }

    /// How long panels have the window for themselves, where scenes that follow one another would leave them none: as long as the last one took.
    pub fn breather(&self) -> Option<Duration> {
        let (done, taken) = self.last?;
        Some(taken.checked_sub(done.elapsed())?).filter(|left| !left.is_zero())
    }

    /// How long it takes until the full picture is due; None when it is there.
    pub fn left(&self) -> Option<Duration> {
        Some(REST.saturating_sub(self.since?.elapsed()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_slow_is_coarser_and_its_own_time_does_not_count() {
        let mut haste = Haste::default();
        assert_eq!(haste.level(8.0), 8.0);
        haste.took(0.05);
        assert_eq!(haste.level(8.0), 8.0);
        assert!(!haste.is_slow());
        haste.took(1.0);
        assert!(haste.is_slow());
        assert_eq!((haste.level(8.0), haste.level(1.5)), (1.0, 1.0));
        haste.took(0.16);
        assert_eq!(haste.level(64.0), 32.0);
        haste.drawn(true);
        haste.took(0.01);
        assert_eq!(haste.level(64.0), 32.0);
        assert!(haste.left().is_some_and(|left| left <= REST));
        assert_eq!(haste.breather(), None);
        haste.drawn(false);
        assert_eq!(haste.left(), None);
        haste.took(50.0);
        assert!(haste.breather().is_some_and(|left| left > REST));
    }
}
