//! The keys, all on one sheet.

use egui::{Color32, Context, RichText};

use super::super::command::{KEYS, key_words};
use super::super::viewer::Viewer;

/// What the mouse does.
pub const MOUSE: [(&str, &str); 6] = [
    ("drag", "turn"),
    ("Shift+drag, right or middle", "move"),
    ("wheel, pinch", "nearer or farther"),
    ("double click", "turn around that point"),
    ("click", "pick, or numbers under the cursor"),
    ("Ctrl+drag", "move what is picked"),
];

pub(super) fn show(ctx: &Context, viewer: &mut Viewer) {
    let mut open = true;
    let window = egui::Window::new("keys and mouse")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO);
    window.show(ctx, |ui| {
        let mouse = MOUSE.iter().map(|&(how, what)| (how.to_string(), what));
        let keys = KEYS
            .iter()
            .map(|binding| (key_words(binding), binding.words));
        let all: Vec<_> = mouse.chain(keys).collect();
        let rows = all.len().div_ceil(3);
        ui.horizontal_top(|ui| {
            for (number, column) in all.chunks(rows).enumerate() {
                let grid = egui::Grid::new(("keys", number)).spacing([14.0, 3.0]);
                grid.show(ui, |ui| {
                    for (key, words) in column {
                        ui.label(
                            RichText::new(key)
                                .monospace()
                                .color(Color32::from_rgb(230, 160, 110)),
                        );
                        ui.label(*words);
                        ui.end_row();
                    }
                });
                ui.add_space(12.0);
            }
        });
    });
    viewer.sheet = open;
}
