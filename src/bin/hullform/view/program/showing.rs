//! A frame: something of the scene, where it has changed, and the panels over it.

use std::time::{Duration, Instant};

use hullform::Result;
use hullform::gpu::Cut;
use hullform::host::Shown;

use super::drawing::Drawing;
use super::{Outcome, Program};
use crate::view::canvas::Panels;
use crate::view::context::Key;
use crate::view::haste::Sent;
use crate::view::overlay::Overlay;
use crate::view::stage::Stage;

impl Program {
    /// How long until another picture may be due, where there is one that is coarser.
    pub fn until_full(&self) -> Option<Duration> {
        self.haste.left().filter(|_| !self.is_at_work())
    }

    /// Whether the full picture waits for what may change it at once: a button of the mouse is held, or another surface is prepared.
    pub(super) fn is_at_work(&self) -> bool {
        let held = self.egui.input(|input| input.pointer.any_down());
        held || !self.running.built.is_empty() || !self.running.edited.is_empty()
    }

    /// Whether the full picture is there.
    pub(super) fn is_whole(&self) -> bool {
        let drawn = !self.stage.is_drawing() && !self.haste.is_waiting();
        self.haste.left().is_none() && !self.undrawn && drawn
    }

    /// Whether another frame is to follow at once: something of the scene is left to be drawn, or a picture of the window is to be taken.
    pub fn is_drawing(&self) -> bool {
        self.stage.is_drawing() || self.shooting || self.canvas.is_shooting()
    }

    /// Shows a frame, with something of the scene if that has changed. Only when the canvas is not busy.
    pub fn show(&mut self, panels: &Panels) -> Result<Outcome> {
        let started = Instant::now();
        // Events tell sizes that the window's images may not have yet.
        self.viewer.area = self.viewer.area.within(self.canvas.size());
        let drawing = self.drawing();
        self.leave_what_is_late(&drawing);
        if !self.stage.is_drawing() {
            self.begin(drawing, f64::from(panels.scale))?;
        }
        let most = match self.canvas.keeps_scene() {
            true => self.haste.most(),
            false => f64::INFINITY,
        };
        let sliced = self.stage.slice(most);
        let (full, scene) = (self.viewer.cutting.cut().level, self.stage.scene());
        let is_coarser = scene.is_some_and(|scene| scene.level < full);
        let is_part = scene.is_some_and(|scene| scene.part.is_some());
        // A picture that is saved is the full one.
        let is_full = sliced.map_or(self.is_whole(), |sliced| sliced.is_last && !is_coarser);
        if self.shooting && is_full {
            self.shoot()?;
        }
        let whole = scene_area(&self.stage).filter(|_| sliced.is_some_and(|s| s.is_last));
        let (stage, context) = (&mut self.stage, &self.context);
        let mut cost = None;
        let mut record = |cmd, target: &_| {
            // SAFETY: the canvas is recording, outside of any render pass, and the frame before is done.
            cost = unsafe { stage.record(cmd, target, context) }?;
            Ok(())
        };
        let sent = Instant::now();
        let scene = sliced.map(|_| (&mut record as &mut crate::view::canvas::Record<'_>, whole));
        let shown = self.canvas.show(panels, scene)?;
        let seconds = sent.elapsed().as_secs_f64();
        if shown == Shown::Yes {
            self.readings.frames[0] += 1;
            self.readings.host.add(started.elapsed().as_secs_f64());
            match sliced {
                Some(sliced) => self.haste.sent(Sent {
                    work: sliced.work,
                    seconds,
                    is_last: sliced.is_last,
                    is_coarser,
                    is_part,
                }),
                None => self.haste.idle(seconds),
            }
        }
        if let Some(cost) = cost {
            self.readings.frames[1] += 1;
            self.readings.parts += u64::from(is_part);
            self.readings.cost = cost;
            self.anew = false;
            self.take_followed();
        }
        let scene = cost.is_some();
        Ok(Outcome { shown, scene })
    }

    /// Takes what the last frame tells now that it is done.
    pub(super) fn take_times(&mut self) {
        let device = self.stage.device_seconds();
        let Some(seconds) = self.haste.done(device) else {
            return;
        };
        self.readings.device.add(seconds);
        self.readings.outcome = self.stage.outcome();
        if let Some(outcome) = &self.readings.outcome {
            self.readings.cost.vertices = outcome.vertices;
        }
    }

    /// Leaves a scene that is not whole where there is another window, or one may have a coarser one sooner.
    fn leave_what_is_late(&mut self, drawing: &Drawing) {
        let Some(scene) = self.stage.scene() else {
            return;
        };
        let moved = self.drawn.as_ref() != Some(drawing);
        let level = self.haste.level(self.viewer.cutting.cut().level);
        // What another edit has changed is drawn behind a part.
        let known = self.drawn.as_ref();
        let is_followed = scene.part.is_some() && known.is_some_and(|d| drawing.is_edited(d));
        let is_slow = scene.level > level && self.haste.is_slow() && !self.shooting;
        let is_late = moved && !is_followed && is_slow;
        if is_late || scene.area != self.viewer.area {
            self.stage.abandon();
            self.drawn = None;
        }
    }

    /// Begins a scene if there is another one to be seen.
    fn begin(&mut self, drawing: Drawing, scale: f64) -> Result<()> {
        let left = self.haste.left();
        let due = |left: Duration| left.is_zero() && !self.is_at_work();
        let rested = left.is_some_and(|left| due(left) || self.shooting);
        let moved = self.fresh || self.drawn.as_ref() != Some(&drawing);
        let running = |key: &Key| self.running.piped.contains(key);
        // The last picture stays meanwhile, if it still is one of this window.
        let waits = !self.anew && self.stage.waits(&self.viewer, &self.context, running);
        self.undrawn = waits;
        if waits {
            // It is drawn when they are there.
            self.drawn = None;
            return Ok(());
        }
        if !(moved || rested) || self.viewer.area.is_empty() {
            return Ok(());
        }
        let edited = self.drawn.as_ref().is_some_and(|d| drawing.is_edited(d));
        if edited && !self.fresh && !self.running.edited.is_empty() {
            // Surfaces follow in a moment, and the cage with them.
            self.undrawn = true;
            return Ok(());
        }
        let full = self.viewer.cutting.cut();
        let overlay = self.overlay(scale, drawing.legend());
        let may_be_coarser = moved && !self.shooting;
        self.drawn = Some(drawing);
        self.fresh = false;
        if edited && !rested && self.amend(full, &overlay)? {
            return Ok(());
        }
        self.canvas.confine(self.viewer.area);
        // Once more where only what was decided shows how much it is.
        for _ in 0..2 {
            let level = match may_be_coarser {
                true => self.haste.level(full.level),
                false => full.level,
            };
            let known = self.stage.scene().map(|scene| scene.level);
            if known.is_some_and(|known| known <= level) {
                break;
            }
            let (stage, viewer, context) = (&mut self.stage, &self.viewer, &self.context);
            let cut = Cut { level, ..full };
            let decided = stage.decide(viewer, cut, &overlay, context);
            if let Err(error) = decided.and_then(|_| stage.begin(viewer, level, context)) {
                return self.fails(error);
            }
            let work = stage.scene().map_or(0.0, |scene| scene.work());
            self.haste.begins(work, level >= full.level);
        }
        Ok(())
    }

    /// Draws what edits have changed of the picture, at the level that it has; whether that is possible, and a frame has time for it.
    fn amend(&mut self, full: Cut, overlay: &Overlay) -> Result<bool> {
        let (stage, viewer, context) = (&mut self.stage, &self.viewer, &self.context);
        let Some(level) = stage.amendable(viewer).filter(|level| *level <= full.level) else {
            return Ok(false);
        };
        let cut = Cut { level, ..full };
        if let Err(error) = stage.decide(viewer, cut, overlay, context) {
            return self.fails(error).map(|()| true);
        }
        let haste = self.haste;
        let coarser = Cut {
            level: haste.level(full.level),
            ..full
        };
        // A part is not coarser, and behind it nothing is left to be drawn.
        let is_soon = |work, stage: &Stage| {
            let is_soon = haste.is_quick(work) || work <= stage.work(coarser)?;
            Ok(is_soon)
        };
        match stage.amend(viewer, level, is_soon, context) {
            Ok(false) => return Ok(false),
            Ok(true) => {}
            Err(error) => return self.fails(error).map(|()| true),
        }
        if let Some(part) = stage.scene().and_then(|scene| scene.part) {
            self.canvas.confine(part);
        }
        self.haste.begins(0.0, false);
        Ok(true)
    }

    /// Takes a picture of the window by the next frame.
    fn shoot(&mut self) -> Result<()> {
        self.shooting = false;
        if !self.canvas.shoot()? {
            let words = "the display does not give its pictures back";
            self.viewer.notices.warn(words);
        }
        Ok(())
    }
}

/// Where the scene is that is being drawn.
fn scene_area(stage: &crate::view::stage::Stage) -> Option<crate::view::viewport::Area> {
    stage.scene().map(|scene| scene.area)
}
