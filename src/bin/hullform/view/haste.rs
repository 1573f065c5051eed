//! How much of a scene a frame draws, and how coarse it is while something moves: on devices that are slow at it the window answers all the same.

use std::time::{Duration, Instant};

/// A scene that takes longer is drawn coarser while it changes.
const SLOW: f64 = 0.1;
/// What a coarser one is to take.
const QUICK: f64 = 0.04;
/// What a slice of a scene is to take: a frame of the window comes between two.
const SLICE: f64 = 0.04;
/// Of less work no pace can be told.
const LITTLE: f64 = 2000.0;
/// How long nothing must change before the full picture is drawn.
const REST: Duration = Duration::from_millis(250);

/// What scenes took, and whether the last one was coarser.
#[derive(Clone, Copy, Debug, Default)]
pub struct Haste {
    /// Seconds that a vertex takes, by the last slices.
    pace: f64,
    /// Seconds that the device takes for the full scene.
    full: Option<f64>,
    /// What it took for the scene that is being drawn, so far.
    so_far: f64,
    /// Since when there is nothing but a coarser one.
    since: Option<Instant>,
    /// Seconds that a frame takes which draws panels alone.
    panels: f64,
    /// What was handed over last.
    sent: Option<Sent>,
}

/// A slice that was handed over to the device.
#[derive(Clone, Copy, Debug)]
pub struct Sent {
    /// What it draws, in vertices.
    pub work: f64,
    /// Seconds for which the window waited for that.
    pub seconds: f64,
    /// Whether the scene is whole by that.
    pub is_last: bool,
    /// Whether it is coarser than the full one.
    pub is_coarser: bool,
    /// Whether it is a part of the picture, of which nothing can be told about all of it.
    pub is_part: bool,
}

impl Haste {
    /// One that knows of a device that it is slow.
    pub fn new(is_software: bool) -> Haste {
        Haste {
            pace: if is_software { 2e-6 } else { 0.0 },
            ..Haste::default()
        }
    }

    /// Tells of a frame without anything of a scene: the seconds for which the window waited until it was handed over.
    pub fn idle(&mut self, seconds: f64) {
        self.panels = match self.panels {
            0.0 => seconds,
            panels => 0.8 * panels + 0.2 * seconds,
        };
    }

    /// Tells that a slice is on its way.
    pub fn sent(&mut self, sent: Sent) {
        self.sent = Some(sent);
        if sent.is_last {
            self.since = sent.is_coarser.then(Instant::now);
        }
    }

    /// Whether nobody has told yet that what was sent last is done.
    pub fn is_waiting(&self) -> bool {
        self.sent.is_some()
    }

    /// Tells that what was sent last is done, and what the device says it took; the seconds of the whole scene where that was the last of it.
    pub fn done(&mut self, device: Option<f64>) -> Option<f64> {
        let sent = self.sent.take()?;
        // Software draws pixels when it has told the time, and while the picture is handed over.
        let waited = sent.seconds - self.panels;
        let seconds = device.unwrap_or(0.0).max(waited);
        if sent.work > LITTLE {
            let pace = seconds / sent.work;
            // Slower at once, faster by and by.
            self.pace = pace.max(0.5 * (self.pace + pace));
        }
        self.so_far += seconds;
        if !sent.is_last {
            return None;
        }
        let whole = std::mem::take(&mut self.so_far);
        if !sent.is_coarser && !sent.is_part {
            self.full = Some(whole);
        }
        Some(whole)
    }

    /// Tells that a scene is begun, the work that it is, and whether it is the full one.
    pub fn begins(&mut self, work: f64, is_full: bool) {
        self.so_far = 0.0;
        if is_full && self.full.is_none() && self.pace > 0.0 {
            self.full = Some(self.pace * work);
        }
    }

    /// Tells that there is another scene, of which nothing is known.
    pub fn forget(&mut self) {
        self.full = None;
    }

    /// The work that a slice is to be at most.
    pub fn most(&self) -> f64 {
        match self.pace > 0.0 {
            true => SLICE / self.pace,
            false => f64::INFINITY,
        }
    }

    /// Whether so much work is done in the time of a frame that is not slow.
    pub fn is_quick(&self, work: f64) -> bool {
        self.pace * work <= SLOW
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

    /// How long it takes until the full picture is due; None when it is there.
    pub fn left(&self) -> Option<Duration> {
        Some(REST.saturating_sub(self.since?.elapsed()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent(seconds: f64, is_last: bool, is_coarser: bool) -> Sent {
        Sent {
            work: 1e5,
            seconds,
            is_last,
            is_coarser,
            is_part: false,
        }
    }

    #[test]
    fn only_what_is_slow_is_coarser_and_its_own_time_does_not_count() {
        let mut haste = Haste::new(false);
        let mut took = |seconds: f64, is_coarser: bool| {
            haste.sent(sent(seconds, true, is_coarser));
            assert_eq!(haste.done(None), Some(seconds));
            haste
        };
        assert_eq!(took(0.05, false).level(8.0), 8.0);
        let slow = took(1.0, false);
        assert!(slow.is_slow());
        assert_eq!((slow.level(8.0), slow.level(1.5)), (1.0, 1.0));
        assert_eq!(took(0.16, false).level(64.0), 32.0);
        let coarser = took(0.01, true);
        assert_eq!(coarser.level(64.0), 32.0);
        assert!(coarser.left().is_some_and(|left| left <= REST));
        assert_eq!(took(0.16, false).left(), None);
        let part = Sent {
            is_part: true,
            ..sent(0.01, true, false)
        };
        haste.sent(part);
        haste.done(None);
        assert!(haste.is_slow(), "a part tells nothing of the whole");
        // It is faster by and by: 1.2 microseconds a piece of work after these.
        assert!(haste.is_quick(8e4) && !haste.is_quick(9e4));
    }

    #[test]
    fn slices_take_as_long_as_they_may_and_the_scene_as_long_as_all_of_them() {
        let mut haste = Haste::new(false);
        assert_eq!(haste.most(), f64::INFINITY, "nothing is known yet");
        haste.idle(0.01);
        haste.sent(sent(0.21, false, false));
        assert_eq!(haste.done(Some(0.1)), None);
        assert!((haste.most() / 2e4 - 1.0).abs() < 1e-9, "{}", haste.most());
        haste.sent(sent(0.05, true, false));
        let whole = haste.done(None).unwrap_or(0.0);
        assert!((whole - 0.24).abs() < 1e-9, "{whole}");
        assert!(haste.is_slow());
    }
}
