//! What colours mean that stand for something: in the lower right corner of the scene.

use egui::{Align2, Color32, Pos2, Rect, Ui};

use super::super::errors::Legend;
use super::super::overlay::crease_colour;
use super::super::viewer::Viewer;
use super::Status;
use super::scene::label;
use crate::output::picture::to_srgb;
use crate::render::Shading;

/// The greatest width of a legend, in points.
const WIDTH: f32 = 230.0;
/// How much of the scene's width it leaves, and under which there is none.
const BESIDE: f32 = 40.0;
const NARROWEST: f32 = 90.0;
/// From one legend to the one above it.
const HEIGHT: f32 = 52.0;

/// Node kinds with their colours in linear light: `kind_colour` of `glsl/lib/shading.glsl`.
const NODES: [(&str, [f32; 3]); 5] = [
    ("regular", [0.75, 0.75, 0.72]),
    ("boundary", [0.30, 0.65, 0.45]),
    ("crease", [0.90, 0.62, 0.15]),
    ("terminal", [0.25, 0.45, 0.85]),
    ("extraord.", [0.85, 0.20, 0.25]),
];

/// Valences with their colours in linear light: `valence_colour` of `glsl/surface.frag`.
const VALENCES: [(&str, [f32; 3]); 3] = [
    ("less than 4", [0.9, 0.35, 0.12]),
    ("4", [0.72, 0.72, 0.72]),
    ("more", [0.12, 0.4, 0.85]),
];

/// Sharpness that has a colour.
const SHARP: [(&str, f32); 5] = [
    ("smooth", 0.0),
    ("1", 1.0),
    ("4", 4.0),
    ("7", 7.0),
    ("\u{221e}", 10.0),
];

/// A title, and what it is told by.
struct Table {
    title: String,
    means: Means,
}

enum Means {
    /// Single colours.
    Swatches(Vec<(&'static str, Color32)>),
    /// All between two ends.
    Ramp(String, String),
}

pub(super) fn show(ui: &Ui, viewer: &Viewer, status: &Status<'_>, rect: Rect) {
    let width = WIDTH.min(rect.width() - BESIDE);
    if width < NARROWEST {
        return;
    }
    let shading = match &status.scale {
        Some(legend) => Some(of_errors(legend)),
        None => of_shading(viewer.look.shading),
    };
    let cage = viewer.look.cage.then(|| Table {
        title: "sharpness of the cage".into(),
        means: Means::Swatches(
            SHARP
                .map(|(words, s)| (words, linear(crease_colour(s))))
                .into(),
        ),
    });
    for (place, table) in shading.into_iter().chain(cage).enumerate() {
        let left = rect.right() - width - 0.5 * BESIDE;
        let top = rect.bottom() - 40.0 - HEIGHT * place as f32;
        draw(
            ui,
            &table,
            Rect::from_min_size(Pos2::new(left, top), egui::vec2(width, 12.0)),
        );
    }
}

fn of_errors(legend: &Legend) -> Table {
    let (low, high) = legend.ends();
    Table {
        title: legend.title(),
        means: Means::Ramp(low, high),
    }
}

fn of_shading(shading: Shading) -> Option<Table> {
    let ramp = |low: &str, high: &str| Means::Ramp(low.into(), high.into());
    let (title, means) = match shading {
        Shading::Node => ("node kinds", swatches(&NODES)),
        Shading::Valence => ("valence of the nearest vertex", swatches(&VALENCES)),
        Shading::Level => ("level of the nearest edge", ramp("1", "64")),
        Shading::Depth => ("depth of the tree", ramp("0", "6")),
        Shading::Height => ("height of bumps", ramp("lowest", "highest")),
        Shading::Lit | Shading::Normal | Shading::Patch | Shading::Checker => return None,
    };
    Some(Table {
        title: title.into(),
        means,
    })
}

fn swatches(all: &[(&'static str, [f32; 3])]) -> Means {
    let all = all.iter().map(|&(words, colour)| (words, linear(colour)));
    Means::Swatches(all.collect())
}

/// A colour from linear light.
fn linear([r, g, b]: [f32; 3]) -> Color32 {
    Color32::from_rgb(to_srgb(r), to_srgb(g), to_srgb(b))
}

fn draw(ui: &Ui, table: &Table, bar: Rect) {
    let painter = ui.painter();
    let fill = |at: usize, of: usize, colour| {
        let step = bar.width() / of as f32;
        let corner = Pos2::new(bar.left() + step * at as f32, bar.top());
        let part = Rect::from_min_size(corner, egui::vec2(step + 0.5, bar.height()));
        painter.rect_filled(part, 0.0, colour);
        part
    };
    let above = Pos2::new(bar.right(), bar.top() - 4.0);
    label(ui, above, Align2::RIGHT_BOTTOM, &table.title, 12.0);
    match &table.means {
        Means::Swatches(all) => {
            for (at, (words, colour)) in all.iter().enumerate() {
                let part = fill(at, all.len(), *colour);
                let below = Pos2::new(part.center().x, bar.bottom() + 2.0);
                label(ui, below, Align2::CENTER_TOP, words, 10.5);
            }
        }
        Means::Ramp(low, high) => {
            const STEPS: usize = 64;
            for step in 0..STEPS {
                let share = (step as f64 + 0.5) / STEPS as f64;
                let byte = |c: f64| (255.0 * c).round() as u8;
                let [r, g, b] = crate::compare::scale::colour(share).map(byte);
                fill(step, STEPS, Color32::from_rgb(r, g, b));
            }
            let ends = [
                (bar.left_bottom(), Align2::LEFT_TOP, low),
                (bar.right_bottom(), Align2::RIGHT_TOP, high),
            ];
            for (at, align, words) in ends {
                label(ui, at + egui::vec2(0.0, 2.0), align, words, 12.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swatches_have_the_colours_of_the_shaders() {
        const GLSL: [&str; 2] = [
            include_str!("../../../../../glsl/lib/shading.glsl"),
            include_str!("../../../../../glsl/surface.frag"),
        ];
        // Whatever the number of zeros behind a fraction.
        let numbers = |text: &str| -> Option<Vec<f32>> {
            let inside = text.split_once("vec3(")?.1.split_once(')')?.0;
            inside.split(',').map(|n| n.trim().parse().ok()).collect()
        };
        let text = GLSL.join("\n");
        let pieces = text.match_indices("vec3(").map(|(at, _)| &text[at..]);
        let known: Vec<Vec<f32>> = pieces.filter_map(numbers).collect();
        for (words, colour) in NODES.iter().chain(&VALENCES) {
            let grey = vec![colour[0]];
            let there = known.contains(&colour.to_vec()) || known.contains(&grey);
            assert!(there, "{words}: {colour:?}");
        }
    }
}
