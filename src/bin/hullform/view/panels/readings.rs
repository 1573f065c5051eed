//! Counts, times and memory.

use egui::{Color32, RichText, Sense, Stroke, Ui};

use hullform::host::Pacing;

use super::super::readings::{Series, bytes, grouped};
use super::super::viewer::Viewer;
use super::{Status, heading, row};

/// How pictures follow one another, with what that means.
pub const PACINGS: [(Pacing, &str, &str); 3] = [
    (Pacing::Display, "display", "with the display"),
    (Pacing::Latest, "latest", "the latest at each refresh"),
    (Pacing::Immediate, "immediate", "at once, perhaps torn"),
];

/// How many buffers are told.
const MOST: usize = 8;

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer, status: &Status<'_>) {
    let readings = status.readings;
    for (name, facts) in &readings.models {
        heading(ui, name);
        table(ui, name, facts.iter().map(|(a, b)| (a.as_str(), b.clone())));
    }
    if let Some(found) = status.probe {
        heading(ui, "under the cursor");
        table(ui, "probe", found.facts().into_iter());
    }
    heading(ui, "frame");
    let cost = &readings.cost;
    let counts = [
        ("vertices", grouped(cost.vertices)),
        (
            "draws, batches",
            format!("{}, {}", cost.draws, cost.batches),
        ),
        ("points computed", grouped(cost.points)),
    ];
    table(ui, "frame", counts.into_iter());
    if let Some(outcome) = &readings.outcome {
        let rows = [
            ("patches drawn", outcome.drawn),
            ("outside, left out", outcome.frustum),
            ("backs, left out", outcome.back),
            ("small, left out", outcome.small),
        ];
        let rows = rows.into_iter().map(|(name, count)| (name, grouped(count)));
        table(ui, "decided", rows);
    }
    graph(
        ui,
        "device",
        &readings.device,
        Color32::from_rgb(222, 140, 86),
    );
    graph(ui, "host", &readings.host, Color32::from_rgb(112, 164, 214));
    if readings.edits.last().is_some() {
        let colour = Color32::from_rgb(140, 184, 120);
        graph(ui, "edit to picture", &readings.edits, colour);
    }
    heading(ui, "memory");
    let rows = readings.memory.iter().take(MOST);
    table(
        ui,
        "memory",
        rows.map(|(name, size)| (name.as_str(), bytes(*size))),
    );
    heading(ui, "device");
    table(
        ui,
        "device",
        readings
            .device_facts
            .iter()
            .map(|(a, b)| (a.as_str(), b.clone())),
    );
    pacing(ui, viewer);
    let words = match readings.validation {
        None => "validation is off".to_string(),
        Some(0) => "no validation message".to_string(),
        Some(count) => format!("{count} validation messages"),
    };
    let wrong = readings.validation.is_some_and(|count| count > 0);
    let colour = if wrong {
        Color32::from_rgb(240, 110, 90)
    } else {
        Color32::from_gray(140)
    };
    ui.label(RichText::new(words).color(colour));
}

/// How pictures follow one another: a short choice, all of it to be seen.
fn pacing(ui: &mut Ui, viewer: &mut Viewer) {
    row(ui, "frames", |ui| {
        for (pacing, name, words) in PACINGS {
            let label = ui.selectable_value(&mut viewer.pacing, pacing, name);
            viewer.places.insert(name, label.rect);
            label.on_hover_text(words);
        }
    });
}

fn table<'a>(ui: &mut Ui, name: &str, rows: impl Iterator<Item = (&'a str, String)>) {
    let grid = egui::Grid::new(("table", name))
        .num_columns(2)
        .min_row_height(14.0)
        .spacing([8.0, 1.0]);
    grid.show(ui, |ui| {
        for (name, value) in rows {
            ui.label(
                RichText::new(name)
                    .small()
                    .color(Color32::from_rgb(150, 155, 164)),
            );
            let value = RichText::new(value)
                .small()
                .color(Color32::from_rgb(214, 218, 224));
            ui.add(egui::Label::new(value).truncate());
            ui.end_row();
        }
    });
}

/// Times of the last frames as bars; the greatest fills the height.
fn graph(ui: &mut Ui, name: &str, series: &Series, colour: Color32) {
    let last = series
        .last()
        .map_or(String::from("–"), |s| format!("{:.1} ms", 1e3 * s));
    ui.horizontal(|ui| {
        ui.label(
            RichText::new(name)
                .small()
                .color(Color32::from_rgb(150, 155, 164)),
        );
        ui.label(RichText::new(last).small());
    });
    let size = egui::vec2(ui.available_width(), 26.0);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    ui.painter()
        .rect_filled(rect, 3.0, Color32::from_rgb(23, 24, 28));
    let greatest = series.all().fold(1e-4, f64::max);
    let count = series.all().len().max(1) as f32;
    let step = rect.width() / count.max(45.0);
    for (place, seconds) in series.all().enumerate() {
        let x = rect.left() + (place as f32 + 0.5) * step;
        let height = (seconds / greatest) as f32 * (rect.height() - 3.0);
        let bar = [
            egui::pos2(x, rect.bottom()),
            egui::pos2(x, rect.bottom() - height),
        ];
        ui.painter()
            .line_segment(bar, Stroke::new((step - 1.0).max(1.0), colour));
    }
}
