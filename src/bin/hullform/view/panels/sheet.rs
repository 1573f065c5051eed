//! The keys, all on one sheet.

use egui::{Color32, Context, RichText, Ui};

use super::super::command::{KEYS, key_words};
use super::super::viewer::Viewer;

/// What the mouse does.
pub const MOUSE: [(&str, &str); 6] = [
    ("drag", "turn"),
    ("Shift+drag, right or middle", "move"),
    ("wheel, pinch", "nearer or farther"),
    ("double click", "show all of it"),
    ("click", "pick, or numbers under the cursor"),
    ("Ctrl+drag", "move what is picked"),
];

/// The width of a column, in points, and what of a window surrounds a sheet.
const COLUMN: f32 = 345.0;
const AROUND: egui::Vec2 = egui::vec2(48.0, 96.0);

pub(super) fn show(ctx: &Context, viewer: &mut Viewer) {
    let room = (ctx.content_rect().size() - AROUND).max(egui::vec2(120.0, 60.0));
    let sheet = egui::Area::new("keys and mouse".into())
        .order(egui::Order::Foreground)
        .default_size(room)
        .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO);
    sheet.show(ctx, |ui| {
        egui::Frame::window(&ctx.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(RichText::new("keys and mouse").strong().size(15.0));
                viewer.sheet = !ui.small_button("close").clicked();
            });
            ui.add_space(4.0);
            let fit = ((room.x / COLUMN) as usize).clamp(1, 3);
            // Words tell no width while they may still be broken.
            ui.set_min_width(room.x.min(COLUMN * fit as f32));
            let area = egui::ScrollArea::both()
                .max_width(room.x)
                .max_height(room.y);
            area.show(ui, |ui| columns(ui, fit));
        });
    });
}

/// All keys in as many columns.
fn columns(ui: &mut Ui, fit: usize) {
    let mouse = MOUSE.iter().map(|&(how, what)| (how.to_string(), what));
    let keys = KEYS
        .iter()
        .map(|binding| (key_words(binding), binding.words));
    let all: Vec<_> = mouse.chain(keys).collect();
    let rows = all.len().div_ceil(fit);
    ui.horizontal_top(|ui| {
        for (number, column) in all.chunks(rows).enumerate() {
            let grid = egui::Grid::new(("keys", number)).spacing([14.0, 3.0]);
            grid.show(ui, |ui| {
                for (key, words) in column {
                    let key = RichText::new(key).monospace();
                    ui.label(key.color(Color32::from_rgb(230, 160, 110)));
                    ui.label(*words);
                    ui.end_row();
                }
            });
            ui.add_space(12.0);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;
    use std::path::Path;

    const BEGIN: &str = "<!-- generated: keys -->\n";
    const END: &str = "<!-- end -->";

    /// Mouse and keys as a table; keys that do the same stand together.
    fn table() -> String {
        let mut rows: Vec<(String, &str)> = Vec::new();
        let mouse = MOUSE.iter().map(|&(how, what)| (how.to_string(), what));
        let keys = KEYS
            .iter()
            .map(|binding| (format!("`{}`", key_words(binding)), binding.words));
        for (key, words) in mouse.chain(keys) {
            match rows.iter_mut().find(|(_, other)| *other == words) {
                Some((known, _)) => *known += &format!(", {key}"),
                None => rows.push((key, words)),
            }
        }
        let mut table = String::from("| | | | |\n| --- | --- | --- | --- |\n");
        for pair in rows.chunks(2) {
            for (key, words) in pair {
                write!(table, "| {key} | {words} ").expect("a string takes all");
            }
            writeln!(table, "|").expect("a string takes all");
        }
        table
    }

    #[test]
    fn the_readme_has_the_keys_of_the_window() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
        let old = std::fs::read_to_string(&path).expect("there is a README");
        let (before, rest) = old.split_once(BEGIN).expect("it has a table of keys");
        let (_, after) = rest.split_once(END).expect("the table has an end");
        let new = format!("{before}{BEGIN}\n{}\n{END}{after}", table());
        if std::env::var_os("HULLFORM_UPDATE").is_some() {
            std::fs::write(&path, new).expect("it can be written");
        } else {
            assert!(
                old == new,
                "the table is old; HULLFORM_UPDATE=1 cargo test --bin hullform writes it anew"
            );
        }
    }
}
