//! What is shown, how it is cut, and what it is compared with.

use std::mem::discriminant;

use egui::{Slider, Ui};
use hullform::gpu::{Backend, Residence};
use hullform::tessellation::Spacing;

use super::super::command::{BACKENDS, Command, SCHEMES, SHADINGS, methods};
use super::super::orbit::Preset;
use super::super::viewer::{Beside, Cull, Cutting, ErrorKind, Intent, Viewer};
use super::{choice, heading, row};
use crate::adaptive::Adaptive;

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    files(ui, viewer);
    heading(ui, "look");
    camera(ui, viewer);
    let all: Vec<_> = SHADINGS
        .iter()
        .map(|&(s, words)| (s, words.to_string()))
        .collect();
    choice(ui, "colours", &mut viewer.look.shading, &all);
    row(ui, "bumps", |ui| {
        let slider = Slider::new(&mut viewer.look.displace, -0.1..=0.1);
        ui.add(slider.fixed_decimals(3));
    });
    ui.horizontal_wrapped(|ui| {
        ui.toggle_value(&mut viewer.look.wireframe, "wires");
        ui.toggle_value(&mut viewer.look.cage, "cage");
        ui.toggle_value(&mut viewer.look.numbers, "numbers");
    });
    heading(ui, "cut");
    cut(ui, viewer);
    heading(ui, "compare");
    compare(ui, viewer);
}

/// What is shown, and what was: files can also be dropped on the window.
fn files(ui: &mut Ui, viewer: &mut Viewer) {
    let names: Vec<String> = viewer.parts.iter().map(|part| part.name()).collect();
    let mut chosen = None;
    ui.horizontal(|ui| {
        if ui.small_button("◀").clicked() {
            chosen = Some(Command::Neighbour(false));
        }
        if ui.small_button("▶").clicked() {
            chosen = Some(Command::Neighbour(true));
        }
        let list = egui::ComboBox::from_id_salt("files").selected_text(names.join(", "));
        let list = list.width(168.0).truncate();
        let recent = viewer.recent.clone();
        let shown = list.show_ui(ui, |ui| {
            for path in recent {
                let shown = viewer.parts.len() == 1 && viewer.parts[0].path() == Some(&path);
                let label = ui.selectable_label(shown, path.to_string_lossy());
                if !shown {
                    viewer.places.entry("recent").or_insert(label.rect);
                }
                if label.clicked() {
                    viewer.intend(Intent::Open(vec![Some(path)]));
                }
            }
        });
        viewer.places.insert("files", shown.response.rect);
    });
    if let Some(command) = chosen {
        viewer.obey(command);
    }
}

fn camera(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal_wrapped(|ui| {
        let presets = [
            ("fit", Command::Fit),
            ("front", Command::Look(Preset::Front)),
            ("side", Command::Look(Preset::Side)),
            ("top", Command::Look(Preset::Top)),
            ("¾", Command::Look(Preset::ThreeQuarter)),
        ];
        for (words, command) in presets {
            if ui.small_button(words).clicked() {
                viewer.obey(command);
            }
        }
        ui.toggle_value(&mut viewer.orbit.orthographic, "parallel");
    });
}

fn cut(ui: &mut Ui, viewer: &mut Viewer) {
    let cutting = &mut viewer.cutting;
    let name = |method: Option<&'static str>| method.unwrap_or("by model").to_string();
    let all: Vec<_> = methods().into_iter().map(|m| (m, name(m))).collect();
    choice(ui, "method", &mut cutting.method, &all);
    let name = |scheme: Option<hullform::mesh::Scheme>| {
        scheme.map_or("by model".to_string(), |scheme| scheme.name().to_string())
    };
    let all = SCHEMES.map(|scheme| (scheme, name(scheme)));
    choice(ui, "scheme", &mut cutting.scheme, &all);
    let all = BACKENDS.map(|backend| (backend, backend.name().to_string()));
    choice(ui, "back-end", &mut cutting.backend, &all);
    if cutting.backend == Backend::Geometry {
        cutting.level = cutting.level.min(Backend::Geometry.greatest_level());
    }
    let all = [Residence::Cache, Residence::Ring].map(|r| (r, r.name().to_string()));
    choice(ui, "residence", &mut cutting.residence, &all);
    let all = [Spacing::FractionalEven, Spacing::Equal].map(|s| (s, s.name().to_string()));
    choice(ui, "spacing", &mut cutting.spacing, &all);
    let most = cutting.backend.greatest_level();
    let level = row(ui, "level", |ui| {
        let slider = Slider::new(&mut cutting.level, 1.0..=most).logarithmic(true);
        // Not drawn to round numbers: levels between them are what is to be seen.
        ui.add(slider.max_decimals(2).smart_aim(false))
    });
    viewer.places.insert("level", level.rect);
    levels(ui, cutting);
    culling(ui, cutting);
    let mut frozen = viewer.frozen.is_some();
    ui.horizontal_wrapped(|ui| {
        ui.toggle_value(&mut frozen, "freeze")
            .on_hover_text("cut by this camera, look with another");
        ui.toggle_value(&mut viewer.cutting.amplify, "amplify cracks");
    });
    if frozen != viewer.frozen.is_some() {
        viewer.obey(Command::Freeze);
    }
}

/// What levels go by.
fn levels(ui: &mut Ui, cutting: &mut Cutting) {
    let [screen, distance, curvature] = Adaptive::ALL.map(|by| match cutting.adaptive {
        Some(own) if discriminant(&own) == discriminant(&by) => own,
        _ => by,
    });
    let all = [
        (None, "none".to_string()),
        (Some(screen), "by pixels".to_string()),
        (Some(distance), "by distance".to_string()),
        (Some(curvature), "by curvature".to_string()),
    ];
    choice(ui, "adaptive", &mut cutting.adaptive, &all);
    let Some(by) = &mut cutting.adaptive else {
        return;
    };
    row(ui, "", |ui| match by {
        Adaptive::Screen(pixels) => {
            let slider = Slider::new(pixels, 1.0..=64.0).logarithmic(true);
            ui.add(slider.max_decimals(1).suffix(" px"));
        }
        Adaptive::Curvature(degrees) => {
            let slider = Slider::new(degrees, 1.0..=45.0).logarithmic(true);
            ui.add(slider.max_decimals(1).suffix("°"));
        }
        Adaptive::Distance(units) => {
            let mut nearest = units.is_none();
            ui.checkbox(&mut nearest, "full at the nearest");
            match (&mut *units, nearest) {
                (Some(units), false) => {
                    let value = egui::DragValue::new(units).range(1e-3..=1e6);
                    ui.add(value.speed(0.02).max_decimals(2));
                }
                _ => *units = (!nearest).then_some(1.0),
            }
        }
    });
}

/// What is left out.
fn culling(ui: &mut Ui, cutting: &mut Cutting) {
    let names = [
        (Cull::None, "none"),
        (Cull::Back, "backs"),
        (Cull::Front, "fronts"),
    ];
    let all = names.map(|(cull, words)| (cull, words.to_string()));
    choice(ui, "culling", &mut cutting.culling.triangles, &all);
    let able = cutting.may_decide();
    row(ui, "", |ui| {
        let why = "patches are left out by the device: with the tessellator and the cache";
        let all = [
            (
                &mut cutting.culling.frustum,
                "outside",
                "patches outside of the picture",
            ),
            (
                &mut cutting.culling.small,
                "small",
                "patches between samples",
            ),
        ];
        for (on, words, what) in all {
            let toggle = ui
                .add_enabled_ui(able, |ui| ui.toggle_value(on, words))
                .inner;
            toggle.on_hover_text(what).on_disabled_hover_text(why);
        }
    });
}

fn compare(ui: &mut Ui, viewer: &mut Viewer) {
    let compare = &mut viewer.compare;
    let all = [
        (Beside::Alone, "alone".to_string()),
        (Beside::Split, "split".to_string()),
        (Beside::SideBySide, "side by side".to_string()),
    ];
    choice(ui, "beside", &mut compare.beside, &all);
    let name = |method: Option<&'static str>| method.unwrap_or("by model").to_string();
    let all: Vec<_> = methods().into_iter().map(|m| (m, name(m))).collect();
    ui.add_enabled_ui(compare.beside != Beside::Alone, |ui| {
        choice(ui, "with", &mut compare.other, &all);
    });
    let all = [
        (None, "none".to_string()),
        (Some(ErrorKind::Position), "position".to_string()),
        (Some(ErrorKind::Normal), "normal".to_string()),
    ];
    choice(ui, "error map", &mut compare.map, &all);
}
