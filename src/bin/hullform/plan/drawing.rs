//! Quadtrees as a picture: the face divided into cells, and its tree below.

use std::error::Error;

use hullform::plan::NodeKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::face::{Cell, FacePlan, name};

/// Of the face's square.
const SIDE: i32 = 520;
const MARGIN: i32 = 60;
/// Between two levels of the tree.
const STEP: i32 = 48;
const TITLE: i32 = 44;
const LEGEND: i32 = 40;
/// A sharpness of so much is infinite.
const INFINITE: f32 = 10.0;

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), Box<dyn Error>>;

/// The picture of a face's plans side by side.
pub fn svg(title: &str, plans: &[FacePlan]) -> String {
    let deepest = plans.iter().flat_map(|plan| &plan.cells);
    let deepest = deepest.map(|cell| cell.level).max().unwrap_or(0) as i32;
    let width = plans.len() as i32 * (SIDE + 2 * MARGIN);
    let tree = if deepest == 0 {
        0
    } else {
        (deepest + 1) * STEP
    };
    let height = TITLE + SIDE + 2 * MARGIN + tree + LEGEND;
    let mut text = String::new();
    let drawn = draw(title, plans, (width, height), &mut text);
    drawn.expect("a string takes all");
    text
}

fn draw(title: &str, plans: &[FacePlan], size: (i32, i32), text: &mut String) -> Drawn {
    let root = SVGBackend::with_string(text, (size.0 as u32, size.1 as u32)).into_drawing_area();
    root.fill(&WHITE)?;
    root.draw(&Text::new(
        title.to_owned(),
        (MARGIN, 18),
        ("sans-serif", 20),
    ))?;
    for (number, plan) in (0..).zip(plans) {
        let left = number * (SIDE + 2 * MARGIN) + MARGIN;
        square(&root, plan, (left, TITLE + MARGIN))?;
        tree(&root, plan, (left, TITLE + SIDE + 2 * MARGIN + STEP / 2))?;
    }
    legend(&root, plans, size.1 - LEGEND / 2)?;
    root.present()?;
    Ok(())
}

fn colour(kind: NodeKind) -> RGBColor {
    match kind {
        NodeKind::Internal => RGBColor(225, 225, 225),
        NodeKind::Regular => RGBColor(198, 219, 239),
        NodeKind::Boundary => RGBColor(158, 202, 170),
        NodeKind::Crease => RGBColor(253, 190, 120),
        NodeKind::Terminal => RGBColor(218, 196, 240),
        NodeKind::Extraordinary | NodeKind::Curve => RGBColor(244, 140, 140),
    }
}

/// As in the paper's figure.
fn letter(kind: NodeKind) -> String {
    name(kind)[..1].to_uppercase()
}

fn words(size: i32, across: HPos, down: VPos) -> TextStyle<'static> {
    let style = TextStyle::from(("sans-serif", size).into_font());
    style.pos(Pos::new(across, down))
}

fn square(root: &Area<'_>, plan: &FacePlan, (left, top): (i32, i32)) -> Drawn {
    // v runs upwards.
    let at = |[u, v]: [f64; 2]| {
        let x = left + (u * f64::from(SIDE)).round() as i32;
        (x, top + ((1.0 - v) * f64::from(SIDE)).round() as i32)
    };
    for cell in plan.cells.iter().filter(|cell| cell.children.is_empty()) {
        let [u, v] = cell.low;
        let corners = [at([u, v]), at([u + cell.size, v + cell.size])];
        root.draw(&Rectangle::new(corners, colour(cell.kind).filled()))?;
        root.draw(&Rectangle::new(corners, BLACK))?;
        let vertex = cell.corner.unwrap_or([u, v]);
        for level in 0..cell.levels as i32 {
            // What the terminal node divides at this level: towards the vertex from the middle on.
            let size = cell.size * 0.5f64.powi(level);
            let away = |axis: usize| {
                let is_low = vertex[axis] < cell.low[axis] + 0.5 * cell.size;
                if is_low { size } else { -size }
            };
            let [du, dv] = [away(0), away(1)];
            let [x, y] = vertex;
            let across = [[x, y + 0.5 * dv], [x + du, y + 0.5 * dv]].map(at);
            let down = [[x + 0.5 * du, y], [x + 0.5 * du, y + dv]].map(at);
            for line in [across, down] {
                root.draw(&PathElement::new(line, BLACK.mix(0.4)))?;
            }
        }
        if cell.corner.is_some() {
            root.draw(&Circle::new(at(vertex), 4, RED.filled()))?;
        }
        // Beside the middle in a terminal node, where its lines cross.
        let share = if cell.levels > 0 { 0.75 } else { 0.5 };
        let toward = |axis: usize| {
            let is_low = vertex[axis] <= cell.low[axis] + 0.5 * cell.size;
            let share = if is_low { share } else { 1.0 - share };
            cell.low[axis] + share * cell.size
        };
        let size = (cell.size * f64::from(SIDE) * 0.4).clamp(0.0, 26.0) as i32;
        if size >= 5 {
            let style = words(size, HPos::Center, VPos::Center);
            let middle = at([toward(0), toward(1)]);
            root.draw(&Text::new(letter(cell.kind), middle, style))?;
        }
    }
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for (i, &sharpness) in plan
        .sharpness
        .iter()
        .enumerate()
        .filter(|edge| *edge.1 > 0.0)
    {
        let ends = [corners[i], corners[(i + 1) % 4]];
        let line = ShapeStyle::from(&RGBColor(200, 90, 0)).stroke_width(5);
        root.draw(&PathElement::new(ends.map(at), line))?;
        let middle = [0, 1].map(|axis| (ends[0][axis] + ends[1][axis]) / 2.0);
        let (x, y) = at(middle);
        let [dx, dy] = [[0, 16], [30, 0], [0, -16], [-30, 0]][i];
        let tag = match sharpness {
            INFINITE.. => "sharp".to_owned(),
            sharpness => format!("{sharpness}"),
        };
        let style = words(15, HPos::Center, VPos::Center);
        root.draw(&Text::new(tag, (x + dx, y + dy), style))?;
    }
    for (i, (vertex, valence)) in plan.vertices.iter().enumerate() {
        let (x, y) = at(corners[i]);
        let across = if i == 0 || i == 3 {
            HPos::Left
        } else {
            HPos::Right
        };
        let (dy, down) = if i < 2 {
            (26, VPos::Top)
        } else {
            (-26, VPos::Bottom)
        };
        let tag = format!("vertex {vertex}, valence {valence}");
        root.draw(&Text::new(tag, (x, y + dy), words(15, across, down)))?;
    }
    if !plan.corners.is_empty() {
        let corners: Vec<String> = plan.corners.iter().map(u32::to_string).take(12).collect();
        let more = if plan.corners.len() > 12 { ", ..." } else { "" };
        let tag = format!("corners {}{more}", corners.join(", "));
        root.draw(&Text::new(tag, (left, top - 50), ("sans-serif", 15)))?;
    }
    Ok(())
}

/// The tree: each leaf has a place of its own, and each inner node is above its children's middle.
fn tree(root: &Area<'_>, plan: &FacePlan, (left, top): (i32, i32)) -> Drawn {
    if plan.cells.len() < 2 {
        return Ok(());
    }
    let leaves = plan.cells.iter().filter(|cell| cell.children.is_empty());
    let step = f64::from(SIDE) / leaves.count() as f64;
    let mut places = vec![0.0; plan.cells.len()];
    let mut next = 0.5;
    // Children come behind their parents, and leaves from left to right.
    for cell in plan.cells.iter().filter(|cell| cell.children.is_empty()) {
        places[cell.node] = next;
        next += 1.0;
    }
    for cell in plan
        .cells
        .iter()
        .rev()
        .filter(|cell| !cell.children.is_empty())
    {
        let sum: f64 = cell.children.iter().map(|&child| places[child]).sum();
        places[cell.node] = sum / cell.children.len() as f64;
    }
    let at = |node: usize, level: u32| {
        let x = left + (places[node] * step).round() as i32;
        (x, top + level as i32 * STEP)
    };
    for cell in &plan.cells {
        for &child in &cell.children {
            let line = [at(cell.node, cell.level), at(child, cell.level + 1)];
            root.draw(&PathElement::new(line, BLACK.mix(0.5)))?;
        }
    }
    let radius = (0.45 * step).clamp(2.0, 13.0) as i32;
    for cell in &plan.cells {
        let place = at(cell.node, cell.level);
        root.draw(&Circle::new(place, radius, colour(cell.kind).filled()))?;
        root.draw(&Circle::new(place, radius, BLACK))?;
        if radius >= 6 {
            let style = words(radius + 3, HPos::Center, VPos::Center);
            root.draw(&Text::new(letter(cell.kind), place, style))?;
        }
    }
    Ok(())
}

/// The kinds that there are.
fn legend(root: &Area<'_>, plans: &[FacePlan], y: i32) -> Drawn {
    let cells = || plans.iter().flat_map(|plan| &plan.cells);
    let mut kinds: Vec<NodeKind> = cells().map(|cell: &Cell| cell.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let mut x = MARGIN;
    for kind in kinds {
        let count = cells().filter(|cell| cell.kind == kind).count();
        let tag = format!("{}: {count} {}", letter(kind), name(kind));
        let corners = [(x, y - 7), (x + 14, y + 7)];
        root.draw(&Rectangle::new(corners, colour(kind).filled()))?;
        root.draw(&Rectangle::new(corners, BLACK))?;
        let style = words(15, HPos::Left, VPos::Center);
        root.draw(&Text::new(tag.clone(), (x + 20, y), style))?;
        x += 40 + 8 * tag.len() as i32;
    }
    Ok(())
}
