//! The panels around the scene, and what the mouse does in it.

mod edits;
mod legend;
mod looks;
mod readings;
mod scene;
mod sheet;
mod unsaved;

use egui::{Color32, Context, CornerRadius, Frame, Margin, RichText, Stroke, Ui};

pub use readings::PACINGS;

use super::command::{Command, of_event};
use super::readings::Readings;
use super::viewer::Viewer;

/// How wide panels are, in points.
const WIDTH: f32 = 268.0;

/// The least that panels leave of a window's width for the scene, in points.
const NARROWEST: f32 = 200.0;

/// What panels tell of the program around the viewer.
pub struct Status<'a> {
    /// Measurements.
    pub readings: &'a Readings,
    /// What is being worked on, in words.
    pub busy: Vec<String>,
    /// What is under the cursor.
    pub probe: Option<&'a super::probe::Found>,
    /// What is wrong with the shaders' text.
    pub shaders: Option<&'a str>,
    /// The methods by which the first model is drawn, a side.
    pub methods: Vec<&'static str>,
    /// The scale of the map that is shown.
    pub scale: Option<super::errors::Legend>,
}

/// Colours and roundings, once.
pub fn dress(ctx: &Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.style_mut(|style| {
        let visuals = &mut style.visuals;
        visuals.panel_fill = Color32::from_rgb(30, 32, 36);
        visuals.window_fill = Color32::from_rgb(34, 36, 41);
        visuals.extreme_bg_color = Color32::from_rgb(22, 23, 26);
        visuals.override_text_color = Some(Color32::from_rgb(208, 212, 218));
        visuals.selection.bg_fill = Color32::from_rgb(196, 106, 58);
        visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
        visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(48, 51, 57);
        visuals.widgets.inactive.bg_fill = Color32::from_rgb(58, 61, 68);
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(46, 49, 55));
        visuals.slider_trailing_fill = true;
        for widget in [
            &mut visuals.widgets.inactive,
            &mut visuals.widgets.hovered,
            &mut visuals.widgets.active,
            &mut visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
        style.spacing.item_spacing = egui::vec2(6.0, 5.0);
        style.spacing.slider_width = 96.0;
        style.spacing.combo_width = 150.0;
        // Nothing moves by itself: each frame of an animation costs the drawing of a window.
        style.animation_time = 0.0;
    });
}

/// Shows everything, and does what keys and mouse ask for.
pub fn show(ctx: &Context, viewer: &mut Viewer, status: &Status<'_>) {
    viewer.places.clear();
    if !ctx.wants_keyboard_input() && viewer.intent.is_none() {
        let commands: Vec<Command> =
            ctx.input(|input| input.events.iter().filter_map(of_event).collect());
        for command in commands {
            viewer.obey(command);
        }
    }
    let [left, right] = sides(ctx.content_rect().width());
    if viewer.panels && left {
        side(ctx, "looks", true, |ui| {
            looks::show(ui, viewer);
            edits::show(ui, viewer);
        });
    }
    if viewer.panels && right {
        side(ctx, "readings", false, |ui| {
            readings::show(ui, viewer, status);
        });
    }
    scene::show(ctx, viewer, status);
    notices(ctx, viewer, status);
    if viewer.sheet {
        sheet::show(ctx, viewer);
    }
    unsaved::show(ctx, viewer);
}

/// Which panels fit beside a scene, in so many points: in narrow windows first the readings go, then the rest.
fn sides(width: f32) -> [bool; 2] {
    [1.0, 2.0].map(|panels| width >= panels * WIDTH + NARROWEST)
}

fn side(ctx: &Context, name: &'static str, left: bool, contents: impl FnOnce(&mut Ui)) {
    let panel = match left {
        true => egui::SidePanel::left(name),
        false => egui::SidePanel::right(name),
    };
    let frame = Frame::new()
        .fill(ctx.style().visuals.panel_fill)
        .inner_margin(Margin::symmetric(12, 10));
    panel
        .resizable(false)
        .exact_width(WIDTH)
        .frame(frame)
        .show_separator_line(false)
        .show(ctx, |ui| {
            let area = egui::ScrollArea::vertical().auto_shrink(false);
            area.show(ui, contents);
        });
}

/// A heading with room above.
fn heading(ui: &mut Ui, words: &str) {
    ui.add_space(6.0);
    ui.label(
        RichText::new(words.to_uppercase())
            .size(10.5)
            .color(Color32::from_rgb(132, 138, 148)),
    );
    ui.add_space(1.0);
}

/// A name on the left, and what belongs to it on the right.
fn row<R>(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = egui::vec2(74.0, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(
            size,
            egui::Layout::left_to_right(egui::Align::Center),
            |ui| {
                ui.set_min_width(size.x);
                ui.label(RichText::new(name).color(Color32::from_rgb(160, 165, 174)));
            },
        );
        contents(ui)
    })
    .inner
}

/// One of several, in a list that folds out.
fn choice<T: PartialEq + Clone>(
    ui: &mut Ui,
    name: &str,
    chosen: &mut T,
    all: &[(T, String)],
) -> egui::Response {
    row(ui, name, |ui| {
        let own = all.iter().find(|(value, _)| value == chosen);
        let words = own.map_or(String::new(), |(_, words)| words.clone());
        let list = egui::ComboBox::from_id_salt(name).selected_text(words);
        list.show_ui(ui, |ui| {
            for (value, words) in all {
                ui.selectable_value(chosen, value.clone(), words);
            }
        })
        .response
    })
}

/// What there is to be told, in the lower left corner of the scene.
fn notices(ctx: &Context, viewer: &mut Viewer, status: &Status<'_>) {
    let [beside, _] = sides(ctx.content_rect().width());
    let left = match viewer.panels && beside {
        true => WIDTH + 16.0,
        false => 16.0,
    };
    let offset = egui::vec2(left, -14.0);
    let parts = viewer.parts.iter();
    let errors = parts.filter_map(|part| part.error.clone());
    let errors: Vec<String> = errors.chain(status.shaders.map(String::from)).collect();
    let area = egui::Area::new("notices".into())
        .anchor(egui::Align2::LEFT_BOTTOM, offset)
        .interactable(false);
    area.show(ctx, |ui| {
        ui.set_max_width((ctx.content_rect().width() - 2.0 * left).max(120.0));
        for words in &errors {
            bubble(ui, words, true);
        }
        for notice in viewer.notices.seen() {
            if !errors.contains(&notice.words) {
                bubble(ui, &notice.words, notice.is_error);
            }
        }
        for words in &status.busy {
            bubble(ui, &format!("{words} …"), false);
        }
    });
}

fn bubble(ui: &mut Ui, words: &str, is_error: bool) {
    let fill = if is_error {
        Color32::from_rgba_unmultiplied(120, 34, 28, 235)
    } else {
        Color32::from_rgba_unmultiplied(24, 26, 30, 215)
    };
    let frame = Frame::new()
        .fill(fill)
        .corner_radius(6)
        .inner_margin(Margin::symmetric(10, 6));
    frame.show(ui, |ui| {
        ui.label(RichText::new(words).color(Color32::from_gray(232)))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Event, MouseWheelUnit, RawInput, Rect, pos2, vec2};

    /// Runs the panels on events over the middle of the scene, and lets what they began come to rest.
    fn runs(viewer: &mut Viewer, events: Vec<Event>) {
        let (ctx, readings) = (Context::default(), Readings::default());
        let moved = Event::PointerMoved(pos2(500.0, 350.0));
        let mut all = [vec![moved], events].into_iter();
        for frame in 0..30 {
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(1000.0, 700.0))),
                time: Some(f64::from(frame) / 60.0),
                events: all.next().unwrap_or_default(),
                ..RawInput::default()
            };
            let _ = ctx.run(input, |ctx| {
                let status = Status {
                    readings: &readings,
                    busy: Vec::new(),
                    probe: None,
                    shaders: None,
                    methods: Vec::new(),
                    scale: None,
                };
                show(ctx, viewer, &status);
            });
        }
    }

    #[test]
    fn two_fingers_and_pinches_come_as_near_as_wheels_and_no_nearer_than_they_say() {
        let distance = |events: Vec<Event>| {
            let mut viewer = Viewer::default();
            let before = viewer.orbit.distance;
            runs(&mut viewer, events);
            viewer.orbit.distance / before
        };
        let scroll = |unit, delta: f32| Event::MouseWheel {
            unit,
            delta: vec2(0.0, delta),
            modifiers: egui::Modifiers::NONE,
        };
        let wheel = distance(vec![scroll(MouseWheelUnit::Line, 1.0)]);
        assert!((0.7..0.95).contains(&wheel), "a step of a wheel: {wheel}");
        let fingers = distance(vec![scroll(MouseWheelUnit::Point, 10.0); 4]);
        let at_once = distance(vec![scroll(MouseWheelUnit::Point, 40.0)]);
        assert!((fingers - at_once).abs() < 1e-3, "{fingers} {at_once}");
        assert!((0.8..0.95).contains(&fingers), "forty pixels: {fingers}");
        let pinch = distance(vec![Event::Zoom(1.25)]);
        assert!((pinch - 1.0 / 1.25).abs() < 1e-3, "{pinch}");
        let back = distance(vec![Event::Zoom(1.25), Event::Zoom(0.8)]);
        assert!((back - 1.0).abs() < 1e-3, "{back}");
        let nothing = distance(vec![Event::Zoom(0.0), Event::Zoom(f32::NAN)]);
        assert_eq!(nothing, 1.0, "nonsense moves nothing");
    }
}
