//! Changes of the control mesh, and its motion.

use egui::{RichText, Slider, Ui};

use super::super::command::Command;
use super::super::deform::{Deform, Kind};
use super::super::selection::Tool;
use super::super::viewer::Viewer;
use super::{choice, heading, row};

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    heading(ui, "change");
    ui.horizontal_wrapped(|ui| {
        for tool in Tool::ALL {
            let chosen = viewer.selection.tool == tool;
            if ui.selectable_label(chosen, tool.name()).clicked() {
                viewer.obey(Command::Pick(tool));
            }
        }
    });
    let picked = viewer.selection.count();
    if picked > 0 {
        ui.label(RichText::new(format!("{picked} picked")).small().weak());
    }
    sharpness(ui, viewer);
    ui.horizontal_wrapped(|ui| {
        let steps = viewer
            .edited()
            .and_then(|part| part.history())
            .map(|history| history.steps());
        let [back, ahead] = steps.unwrap_or_default();
        let buttons = [
            ("undo", Command::Undo, back > 0),
            ("redo", Command::Redo, ahead > 0),
            ("hole", Command::Hole, !viewer.selection.faces.is_empty()),
            ("save", Command::Save, !viewer.parts.is_empty()),
        ];
        for (words, command, enabled) in buttons {
            if ui
                .add_enabled(enabled, egui::Button::new(words).small())
                .clicked()
            {
                viewer.obey(command);
            }
        }
    });
    heading(ui, "motion");
    let time = motion(ui, &mut viewer.deform);
    viewer.places.insert("time", time);
}

/// The sharpness of what is picked. A drag of it is one step.
fn sharpness(ui: &mut Ui, viewer: &mut Viewer) {
    let picked = viewer.picked_sharpness();
    let mut sharpness = picked.unwrap_or(0.0);
    let response = row(ui, "sharpness", |ui| {
        let slider = Slider::new(&mut sharpness, 0.0..=10.0).max_decimals(2);
        ui.add_enabled(picked.is_some(), slider)
    });
    viewer.places.insert("sharpness", response.rect);
    if response.changed() {
        let held = response.dragged() || response.is_pointer_button_down_on();
        viewer.sharpen(|_| sharpness, held);
    }
    if response.drag_stopped()
        && let Some(part) = viewer.edited()
    {
        part.drop_it();
    }
}

/// The motion; where its time is scrubbed.
fn motion(ui: &mut Ui, deform: &mut Deform) -> egui::Rect {
    let all = Kind::ALL.map(|kind| (kind, kind.name().to_string()));
    choice(ui, "kind", &mut deform.kind, &all);
    ui.add_enabled_ui(deform.kind != Kind::None, |ui| {
        row(ui, "amount", |ui| {
            ui.add(Slider::new(&mut deform.amount, 0.0..=1.0))
        });
        let time = row(ui, "time", |ui| {
            let slider = Slider::new(&mut deform.time, 0.0..=Deform::TURN);
            ui.add(slider.fixed_decimals(2).suffix(" s"))
        });
        let words = if deform.playing { "pause" } else { "play" };
        if ui.small_button(words).clicked() {
            deform.play();
        }
        time.rect
    })
    .inner
}
