//! A frame: the scene, where it has changed, and the panels over it.

use std::time::{Duration, Instant};

use hullform::Result;
use hullform::gpu::Cut;
use hullform::host::Shown;

use super::{Outcome, Program};
use crate::view::canvas::Panels;
use crate::view::context::Key;

impl Program {
    /// How long until another picture may be due, where there is one that is coarser or of earlier edits.
    pub fn until_full(&self) -> Option<Duration> {
        let full = self.haste.left().filter(|_| !self.is_at_work());
        let both = [full, self.haste.breather()];
        both.into_iter().flatten().min()
    }

    /// Whether the full picture waits for what may change it at once: a button of the mouse is held, or another surface is prepared.
    pub(super) fn is_at_work(&self) -> bool {
        let held = self.egui.input(|input| input.pointer.any_down());
        held || !self.running.built.is_empty()
    }

    /// Whether the full picture is there.
    pub(super) fn is_whole(&self) -> bool {
        self.haste.left().is_none() && !self.undrawn
    }

    /// Shows a frame, with the scene drawn anew if it has changed. Only when the canvas is not busy.
    pub fn show(&mut self, panels: &Panels) -> Result<Outcome> {
        let started = Instant::now();
        if let Some(seconds) = self.stage.device_seconds() {
            self.readings.device.add(seconds);
            // Software draws pixels when it has told the time, and while the picture is handed over.
            self.haste.took(seconds.max(self.handed_over));
        }
        // Events tell sizes that the window's images may not have yet.
        self.viewer.area = self.viewer.area.within(self.canvas.size());
        let drawing = self.drawing();
        let area = self.viewer.area;
        // A picture that is saved is the full one.
        let shooting = self.canvas.is_shooting();
        let left = self.haste.left();
        let due = |left: Duration| left.is_zero() && !self.is_at_work();
        let rested = left.is_some_and(|left| due(left) || shooting);
        let moved = self.fresh || self.drawn.as_ref() != Some(&drawing);
        let changed = moved || rested;
        let running = |key: &Key| self.running.piped.contains(key);
        // The last picture stays meanwhile, if it still is one of this window.
        let waits = !self.anew && self.stage.waits(&self.viewer, &self.context, running);
        // Of edits the panels tell at once.
        let last = self.drawn.as_ref().filter(|_| !self.fresh);
        let held = last.is_some_and(|last| drawing.is_edit_of(last))
            && self.haste.breather().is_some()
            && !shooting;
        let mut scene = changed && !area.is_empty() && !waits && !held;
        let full = self.viewer.cutting.cut();
        let cut = match moved && !self.anew && !shooting {
            true => Cut {
                level: self.haste.level(full.level),
                ..full
            },
            false => full,
        };
        if scene {
            let overlay = self.overlay(f64::from(panels.scale), drawing.legend());
            let stage = &mut self.stage;
            if let Err(error) = stage.decide(&self.viewer, cut, &overlay, &self.context) {
                self.fails(error)?;
                scene = false;
            }
        }
        self.canvas.confine(area);
        let (stage, viewer, context) = (&mut self.stage, &self.viewer, &self.context);
        let mut cost = None;
        let mut record = |cmd, target: &_| {
            cost = Some(stage.record(cmd, target, viewer, context)?);
            Ok(())
        };
        let sent = Instant::now();
        let shown = match scene {
            true => self.canvas.show(panels, area, Some(&mut record)),
            false => self.canvas.show(panels, area, None),
        }?;
        if shown == Shown::Yes {
            self.readings.frames[0] += 1;
            self.readings.host.add(started.elapsed().as_secs_f64());
            if let Some(cost) = cost {
                self.handed_over = sent.elapsed().as_secs_f64();
                self.readings.frames[1] += 1;
                self.haste.drawn(cut.level < full.level);
                self.readings.cost = cost;
            }
        }
        self.undrawn = held || waits || scene && !matches!(shown, Shown::Yes | Shown::Hidden);
        if held {
            // It is drawn after a moment.
        } else if waits {
            // It is drawn when they are there.
            self.drawn = None;
        } else if shown == Shown::Yes || shown == Shown::Hidden || !scene {
            self.drawn = Some(drawing);
            self.fresh &= !scene && changed;
            self.anew &= !scene;
        }
        Ok(Outcome { shown, scene })
    }
}
