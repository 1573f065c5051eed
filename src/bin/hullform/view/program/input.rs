//! What comes in from mouse and keys goes to the panels.

use super::Program;
use crate::view::command::of_event;
use crate::view::panels::{self, Status};

impl Program {
    /// Runs the panels on what came in. What a button of the mouse does stands between what came before it and what after: else a drag that begins
    /// and ends within one slow frame would be none.
    pub fn panels(&mut self, mut input: egui::RawInput) -> egui::FullOutput {
        let _span = tracing::debug_span!("panels").entered();
        self.take_tabs(&mut input.events);
        let runs = runs(std::mem::take(&mut input.events));
        let mut output = egui::FullOutput::default();
        for events in runs {
            let one = egui::RawInput {
                events,
                ..input.take()
            };
            output.append(self.panels_once(one));
        }
        output
    }

    /// Takes Tab for our own where nothing is written: egui would give the keys to one of its widgets, and all others would be dead.
    fn take_tabs(&mut self, events: &mut Vec<egui::Event>) {
        if self.egui.wants_keyboard_input() || self.viewer.intent.is_some() {
            return;
        }
        let is_tab = |event: &egui::Event| {
            matches!(
                event,
                egui::Event::Key {
                    key: egui::Key::Tab,
                    ..
                }
            )
        };
        let tabs: Vec<egui::Event> = events.extract_if(.., |event| is_tab(event)).collect();
        for command in tabs.iter().filter_map(of_event) {
            self.viewer.obey(command);
        }
    }

    fn panels_once(&mut self, input: egui::RawInput) -> egui::FullOutput {
        self.look_under_cursor();
        let legend = self.legend();
        let staged = self.stage.parts.first();
        let sides = staged.map_or(&[][..], |staged| &staged.sides);
        let methods = sides.iter().map(|drawn| drawn.surface.prepared().method);
        let methods: Vec<&'static str> = methods.collect();
        let egui = self.egui.clone();
        let busy = self.busy();
        let (viewer, found) = (&mut self.viewer, self.found.as_ref());
        let (readings, shaders) = (&self.readings, self.live.error.as_deref());
        egui.run(input, |ctx| {
            let status = Status {
                readings,
                busy: busy.clone(),
                probe: found,
                shaders,
                methods: methods.clone(),
                scale: legend.clone(),
            };
            panels::show(ctx, viewer, &status);
        })
    }
}

/// Events in their order, those of the mouse's buttons by themselves; one run at least.
fn runs(events: Vec<egui::Event>) -> Vec<Vec<egui::Event>> {
    let mut runs = vec![Vec::new()];
    for event in events {
        let alone = matches!(event, egui::Event::PointerButton { .. });
        let last_alone = runs.last().is_some_and(|run: &Vec<egui::Event>| {
            matches!(run.last(), Some(egui::Event::PointerButton { .. }))
        });
        if (alone || last_alone) && runs.last().is_some_and(|run| !run.is_empty()) {
            runs.push(Vec::new());
        }
        runs.last_mut().expect("there is one").push(event);
    }
    runs
}
