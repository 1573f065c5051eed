//! The pictures of `compare`, and where they stand on the page.

use glam::Vec3;
use hullform::Result;
use hullform::host::{ColouredTriangles, ColouredVertex, OffscreenTarget};
use hullform::mesh::Model;

use super::errors::Summary;
use super::page::{Face, GREY, INK, Page};
use super::scale::{self, Scale};
use super::{Arguments, Column, Refusal, TRUTH};
use crate::camera::View;
use crate::gpu::Gpu;
use crate::output::{Point, Surface, picture};
use crate::render;

/// Around the page.
const MARGIN: u32 = 24;
/// Between tiles.
const GAP: u32 = 12;
/// The page's title and what stands below it.
const TITLE: u32 = 58;
/// The line above the tiles of a method, and that below.
const LINE: u32 = 28;
/// Colour bars with their words.
const LEGEND: u32 = 62;
/// Where there is nothing to compare with, in linear light.
const UNKNOWN: [f32; 3] = [0.5, 0.5, 0.5];
/// How bright a map is where the surface is seen from the side: enough to see its form, little enough to read its colours.
const SIDE: f32 = 0.6;

/// Draws a surface with a colour an error.
pub fn draw_map(
    gpu: &Gpu,
    target: &OffscreenTarget,
    model: &Model,
    surface: &Surface,
    errors: &[Option<f64>],
    scale: Scale,
    view: &View,
) -> Result<()> {
    let vertices = coloured(model, surface, errors, scale, view);
    let drawn = ColouredTriangles::new(&gpu.device, target, &vertices, &surface.triangles)?;
    // SAFETY: recording on the device that made everything; `drawn` outlives the submission, which is waited for.
    gpu.device.submit(|cmd| unsafe {
        target.begin(cmd, render::CLEAR);
        drawn.cmd_draw(cmd);
        target.end(cmd);
        drawn.cmd_read_back(cmd);
        target.cmd_copy_to_host(cmd);
        Ok(())
    })?;
    drawn.check()
}

/// The points of a surface as seen in a view, each with the colour of its error.
pub fn coloured(
    model: &Model,
    surface: &Surface,
    errors: &[Option<f64>],
    scale: Scale,
    view: &View,
) -> Vec<ColouredVertex> {
    let View {
        clip_from_model,
        eye,
    } = *view;
    let coloured = surface.points.iter().zip(errors).map(|(point, error)| {
        let position = local(model, point);
        let colour = error.map_or(UNKNOWN, |error| {
            scale::colour(scale.share(error)).map(|c| picture::to_linear(c as f32))
        });
        let [r, g, b] = colour.map(|c| c * light(point, (eye - position).normalize_or_zero()));
        ColouredVertex {
            clip: (clip_from_model * position.extend(1.0)).to_array(),
            colour: [r, g, b, 1.0],
        }
    });
    coloured.collect()
}

/// A point in local units, as drawing has it.
pub fn local(model: &Model, point: &Point) -> Vec3 {
    model.placement().local(point.position.into()).as_vec3()
}

/// The share of a colour that is left, by how much the surface turns away. Without a normal all of it.
fn light(point: &Point, to_eye: Vec3) -> f32 {
    let normal = Vec3::from(point.normal);
    if normal == Vec3::ZERO {
        return 1.0;
    }
    SIDE + (1.0 - SIDE) * normal.dot(to_eye).abs()
}

/// Puts all on a page: a row a method, columns of lit pictures and of both maps, and below each map its scale.
pub(super) fn lay_out(
    arguments: &Arguments,
    rows: &[(&Column, Vec<Vec<u8>>)],
    refusals: &[Refusal],
    scales: [Scale; 2],
) -> Page {
    let (width, height) = (arguments.size.width, arguments.size.height);
    let column = |number: u32| MARGIN + number * (width + GAP);
    let row = LINE + height + LINE;
    let refused = refusals.len() as u32 * LINE;
    let tall = MARGIN + TITLE + rows.len() as u32 * row + refused + LEGEND + MARGIN;
    let mut page = Page::new(column(3) - GAP + MARGIN, tall);
    title(&mut page, arguments);
    let mut y = MARGIN + TITLE;
    for (method, tiles) in rows {
        let x = page.words(MARGIN, y, Face::Heading, INK, method.chosen.method.name);
        let counts = format!(
            "  {} triangles, {} patches",
            method.surface.triangles.len(),
            method.patches
        );
        page.words(x, y + 3, Face::Small, GREY, &counts);
        for (number, tile) in (0..).zip(tiles) {
            page.tile(column(number), y + LINE, width, tile);
        }
        let below = y + LINE + height + 5;
        let summaries = [method.errors.position, method.errors.normal];
        for (number, summary) in (1..).zip(summaries) {
            let words = numbers(&summary, width);
            page.words(column(number), below, Face::Small, INK, &words);
        }
        y += row;
    }
    for refusal in refusals {
        let x = page.words(MARGIN, y, Face::Heading, GREY, refusal.name);
        let words = format!("  refused: {}", refusal.reason);
        page.words(x, y + 3, Face::Small, GREY, &words);
        y += LINE;
    }
    legends(&mut page, y + 8, [column(1), column(2)], width, scales);
    page
}

fn title(page: &mut Page, arguments: &Arguments) {
    let against = match arguments.against.as_str() {
        TRUTH => "the limit in double precision",
        method => method,
    };
    let model = arguments.model.as_os_str();
    let name = arguments
        .model
        .file_name()
        .unwrap_or(model)
        .to_string_lossy();
    page.words(MARGIN, MARGIN, Face::Heading, INK, &name);
    let how = format!("tess level {}, against {against}", arguments.steps.level);
    page.words(MARGIN, MARGIN + 22, Face::Small, GREY, &how);
}

/// As many of the numbers as a tile's width has room for.
fn numbers(summary: &Summary, width: u32) -> String {
    let mut words = format!("max {}", short(summary.maximum));
    let more = [
        format!("  mean {}", short(summary.mean)),
        format!("  RMS {}", short(summary.rms)),
    ];
    for more in more {
        if Face::Small.width(&words) + Face::Small.width(&more) <= width {
            words += &more;
        }
    }
    words
}

/// Two or three digits, with a power of ten only where one would have to count zeros.
fn short(number: f64) -> String {
    match number {
        0.0 => "0".into(),
        0.01..1.0 => format!("{number:.3}"),
        1.0..10.0 => format!("{number:.2}"),
        10.0..1000.0 => format!("{number:.0}"),
        _ => format!("{number:.1e}"),
    }
}

fn legends(page: &mut Page, y: u32, columns: [u32; 2], width: u32, scales: [Scale; 2]) {
    let titles = [
        "position error / diagonal, log scale",
        "normal error in degrees, log scale",
    ];
    for ((x, title), scale) in columns.into_iter().zip(titles).zip(scales) {
        let (short, _) = title.split_once(',').unwrap_or((title, ""));
        let fits = Face::Small.width(title) <= width;
        page.words(x, y, Face::Small, INK, if fits { title } else { short });
        page.bar(x, y + 20, width, scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let words = [0.0, 1.25e-7, 0.0126, 5.2, 180.0, 12345.0].map(short);
        assert_eq!(words, ["0", "1.2e-7", "0.013", "5.20", "180", "1.2e4"]);
    }
}
