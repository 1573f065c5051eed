//! A word about changes that are in no file, before something would lose them.

use egui::{Context, Key, RichText};

use super::super::viewer::{Intent, Viewer, Wish};

/// Asks; keys and mouse are for nothing else meanwhile.
pub(super) fn show(ctx: &Context, viewer: &mut Viewer) {
    let Some(intent) = viewer.intent.clone() else {
        return;
    };
    let changed = viewer.parts.iter().filter(|part| part.is_changed());
    let names: Vec<String> = changed.map(|part| part.name()).collect();
    let (save, lose) = match intent {
        Intent::Quit => ("save and quit", "quit without"),
        Intent::Open(_) => ("save and open", "open without"),
        Intent::Reload => ("save and read", "read without"),
    };
    let mut chosen = None;
    let modal = egui::Modal::new("unsaved".into()).show(ctx, |ui| {
        ui.set_width(330.0);
        ui.label(RichText::new("Changes are in no file").strong().size(15.0));
        ui.add_space(4.0);
        ui.label(format!("{} was changed. Saving writes a new file beside where the program runs; the model's own file stays as it is.", names.join(", ")));
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            let all = [(save, Choice::Save, "save"), (lose, Choice::Lose, "lose"), ("go back", Choice::Back, "back")];
            for (words, choice, place) in all {
                let enabled = !viewer.saving || choice == Choice::Back;
                let button = ui.add_enabled(enabled, egui::Button::new(words));
                // While egui finds out its size it is not where it will be.
                if !ui.is_sizing_pass() {
                    viewer.places.insert(place, button.rect);
                }
                if button.clicked() {
                    chosen = Some(choice);
                }
            }
        });
    });
    ctx.input(|input| {
        if input.key_pressed(Key::Enter) {
            chosen = Some(Choice::Save);
        }
        if input.key_pressed(Key::Escape) {
            chosen = Some(Choice::Back);
        }
    });
    if modal.backdrop_response.clicked() {
        chosen = Some(Choice::Back);
    }
    match chosen {
        Some(Choice::Save) if !viewer.saving => {
            viewer.saving = true;
            viewer.wishes.push(Wish::SaveAll);
        }
        Some(Choice::Lose) => viewer.perform(intent),
        Some(Choice::Back) => {
            viewer.intent = None;
            viewer.saving = false;
        }
        _ => {}
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Choice {
    Save,
    Lose,
    Back,
}
