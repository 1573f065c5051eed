//! The scene's area: what the mouse does in it, and what is written over it.

use egui::{Color32, Context, FontId, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui};
use glam::DVec2;

use super::super::command::Command;
use super::super::draft::Change;
use super::super::selection::{Sight, Tool, hit};
use super::super::viewer::{Beside, Viewer, Wish};
use super::super::viewport::Area;
use super::Status;

/// How near the mouse must be to the line that parts methods.
const NEAR: f32 = 6.0;
/// How many numbers are written at most: more nobody reads.
const MOST_NUMBERS: usize = 2000;

pub(super) fn show(ctx: &Context, viewer: &mut Viewer, status: &Status<'_>) {
    let panel = egui::CentralPanel::default().frame(egui::Frame::NONE);
    panel.show(ctx, |ui| {
        let rect = ui.max_rect();
        viewer.places.insert("scene", rect);
        let size = ctx.input(|input| input.viewport_rect().size() * input.pixels_per_point);
        let size = [size.x.round() as u32, size.y.round() as u32];
        viewer.scale = ctx.pixels_per_point();
        viewer.area = Area::of(rect, ctx.pixels_per_point(), size);
        let response = ui.interact(rect, ui.id().with("scene"), Sense::click_and_drag());
        let on_line = line(ui, viewer, rect);
        if !on_line {
            mouse(ui, viewer, rect, &response);
        }
        names(ui, viewer, status, rect);
        if viewer.look.numbers {
            numbers(ui, viewer, rect);
        }
        super::legend::show(ui, viewer, status, rect);
    });
}

/// The line between two methods, which can be dragged; whether the mouse is at it.
fn line(ui: &mut Ui, viewer: &mut Viewer, rect: Rect) -> bool {
    let colour = Color32::from_white_alpha(190);
    let whole = |x: f32| [Pos2::new(x, rect.top()), Pos2::new(x, rect.bottom())];
    match viewer.compare.beside {
        Beside::Alone => false,
        Beside::SideBySide => {
            let stroke = Stroke::new(1.0, colour);
            ui.painter().line_segment(whole(rect.center().x), stroke);
            false
        }
        Beside::Split => {
            let x = rect.left() + viewer.compare.at as f32 * rect.width();
            let grip = Rect::from_x_y_ranges(x - NEAR..=x + NEAR, rect.y_range());
            viewer.places.insert("split", grip);
            let response = ui.interact(grip, ui.id().with("split"), Sense::drag());
            if let Some(at) = response
                .interact_pointer_pos()
                .filter(|_| response.dragged())
            {
                let share = (at.x - rect.left()) / rect.width().max(1.0);
                viewer.compare.at = f64::from(share).clamp(0.0, 1.0);
            }
            let held = response.hovered() || response.dragged();
            if held {
                ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
            }
            let stroke = Stroke::new(if held { 2.5 } else { 1.5 }, colour);
            ui.painter().line_segment(whole(x), stroke);
            ui.painter()
                .circle_filled(Pos2::new(x, rect.center().y), 5.0, Color32::WHITE);
            held
        }
    }
}

fn mouse(ui: &mut Ui, viewer: &mut Viewer, rect: Rect, response: &Response) {
    let (modifiers, scroll, pinch) = ui.input(|input| {
        (
            input.modifiers,
            input.smooth_scroll_delta,
            input.zoom_delta(),
        )
    });
    let by = response.drag_delta();
    let by = DVec2::new(f64::from(by.x), f64::from(by.y));
    let left = response.dragged_by(PointerButton::Primary);
    let other =
        response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
    if left && modifiers.command && !viewer.selection.vertices.is_empty() {
        move_picked(viewer, rect, by);
    } else if other || left && modifiers.shift {
        viewer.orbit.pan(by, f64::from(rect.height()));
    } else if left {
        viewer.orbit.turn(by);
    }
    if response.drag_stopped()
        && let Some(part) = viewer.edited()
    {
        part.drop_it();
    }
    let Some(at) = response.hover_pos() else {
        return;
    };
    let place = place(rect, at);
    let factor = f64::from(pinch) * (f64::from(scroll.y) * 0.0035).exp();
    if factor != 1.0 && factor.is_finite() && factor > 0.0 {
        let (aspect, radius) = (viewer.area.aspect(), viewer.sphere().radius);
        viewer
            .orbit
            .dolly(factor.clamp(0.2, 5.0), place, aspect, radius);
    }
    if response.double_clicked() && viewer.selection.tool == Tool::Look {
        viewer.obey(Command::Fit);
    } else if response.clicked() {
        click(viewer, rect, at, modifiers.shift || modifiers.command);
    }
    let moved = ui.input(|input| input.pointer.delta() != egui::Vec2::ZERO);
    if (moved || response.clicked()) && !response.dragged() {
        viewer.wishes.push(Wish::Probe(place.to_array()));
    }
}

/// A place of the picture, -1..1, y up.
fn place(rect: Rect, at: Pos2) -> DVec2 {
    let share = (at - rect.center()) / rect.size().max(egui::Vec2::splat(1.0));
    DVec2::new(f64::from(2.0 * share.x), f64::from(-2.0 * share.y))
}

/// What sees the cage in the picture.
fn sight(viewer: &Viewer, rect: Rect) -> Sight {
    Sight {
        clip: viewer
            .orbit
            .eye()
            .clip_from_world(viewer.area.aspect(), viewer.sphere()),
        size: DVec2::new(f64::from(rect.width()), f64::from(rect.height())),
    }
}

fn click(viewer: &mut Viewer, rect: Rect, at: Pos2, more: bool) {
    let tool = viewer.selection.tool;
    if tool == Tool::Look {
        return;
    }
    let sight = sight(viewer, rect);
    let at = DVec2::new(f64::from(at.x - rect.left()), f64::from(at.y - rect.top()));
    let hits = viewer.parts.iter().filter_map(|part| {
        let (hit, depth) = hit(tool, part.model.as_ref()?, part.points(), sight, at)?;
        Some((part.number(), hit, depth))
    });
    let nearest = hits.min_by(|a, b| a.2.total_cmp(&b.2));
    match nearest {
        Some((part, hit, _)) => viewer.selection.pick(part, Some(hit), more),
        None => {
            let part = viewer.selection.part().unwrap_or(0);
            viewer.selection.pick(part, None, more);
        }
    }
}

/// Moves the vertices that are picked along the picture.
fn move_picked(viewer: &mut Viewer, rect: Rect, by: DVec2) {
    let sight = sight(viewer, rect);
    let back = sight.clip.inverse();
    let vertices = viewer.selection.vertices.clone();
    let Some(part) = viewer.edited() else { return };
    let Some(history) = part.history() else {
        return;
    };
    let positions = &history.draft().positions;
    let moved = |vertex: &u32| {
        let was = *positions.get(*vertex as usize)?;
        let clip = sight.clip.project_point3(was);
        let off = DVec2::new(by.x, by.y) * 2.0 / sight.size;
        let to = back.project_point3(clip + off.extend(0.0));
        to.is_finite().then_some((*vertex, [was, to]))
    };
    let all: std::collections::BTreeMap<_, _> = vertices.iter().filter_map(moved).collect();
    if !all.is_empty() && by != DVec2::ZERO {
        part.change(Change::Positions(all), true);
    }
}

/// The names of methods that are compared.
fn names(ui: &Ui, viewer: &Viewer, status: &Status<'_>, rect: Rect) {
    if viewer.compare.beside == Beside::Alone {
        return;
    }
    let at = match viewer.compare.beside {
        Beside::Split => viewer.compare.at as f32,
        _ => 0.5,
    };
    let x = rect.left() + at * rect.width();
    let sides = [
        (viewer.cutting.method, egui::Align2::RIGHT_TOP, -12.0),
        (viewer.compare.other, egui::Align2::LEFT_TOP, 12.0),
    ];
    for (number, (method, align, off)) in sides.into_iter().enumerate() {
        let drawn = status.methods.get(number).copied();
        let words = drawn.or(method).unwrap_or("by model");
        let place = Pos2::new(x + off, rect.top() + 12.0);
        label(ui, place, align, words, 14.0);
    }
}

/// Words over the picture, with a shade behind them.
pub(super) fn label(ui: &Ui, at: Pos2, align: egui::Align2, words: &str, size: f32) {
    let font = FontId::proportional(size);
    let shade = Color32::from_black_alpha(150);
    let painter = ui.painter();
    painter.text(at + egui::vec2(1.0, 1.0), align, words, font.clone(), shade);
    painter.text(at, align, words, font, Color32::WHITE);
}

/// Numbers of vertices and faces, the nearest first, where they leave one another room.
fn numbers(ui: &Ui, viewer: &Viewer, rect: Rect) {
    let sight = sight(viewer, rect);
    let mut all = Vec::new();
    let mut add = |point, words: String, vertex: bool| {
        let Some((at, depth)) = sight.place(point) else {
            return;
        };
        let at = rect.min + egui::vec2(at.x as f32, at.y as f32);
        if rect.contains(at) {
            all.push((depth, at, words, vertex));
        }
    };
    for part in &viewer.parts {
        let Some(model) = &part.model else { continue };
        let points = part.points();
        if points.len() != model.mesh().vertex_count() {
            continue;
        }
        for (number, &point) in points.iter().enumerate() {
            add(point, number.to_string(), true);
        }
        for (number, face) in model.mesh().faces().enumerate() {
            let sum: glam::DVec3 = face.iter().map(|&v| points[v as usize]).sum();
            add(sum / face.len() as f64, format!("f{number}"), false);
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut taken = Taken::default();
    let free = all
        .iter()
        .filter(|(_, at, words, _)| taken.take(*at, words.len()));
    for (_, at, words, vertex) in free.take(MOST_NUMBERS) {
        let (size, align) = match vertex {
            true => (11.0, egui::Align2::LEFT_BOTTOM),
            false => (12.0, egui::Align2::CENTER_CENTER),
        };
        label(ui, *at, align, words, size);
    }
}

/// Where words stand, in cells as high as they are.
#[derive(Default)]
struct Taken(std::collections::HashSet<[i32; 2]>);

impl Taken {
    /// Takes the room for so many signs around a place, if it is free.
    fn take(&mut self, at: Pos2, signs: usize) -> bool {
        const CELL: f32 = 8.0;
        let cell = |x: f32| (x / CELL).floor() as i32;
        // Twice as high as wide, or higher.
        let columns = cell(at.x) - 1..=cell(at.x) + signs as i32;
        let rows = cell(at.y) - 1..=cell(at.y);
        let cells = columns.flat_map(|x| rows.clone().map(move |y| [x, y]));
        let cells: Vec<[i32; 2]> = cells.collect();
        let is_free = cells.iter().all(|cell| !self.0.contains(cell));
        if is_free {
            self.0.extend(cells);
        }
        is_free
    }
}
