//! How far the triangles of each method are from the limit, and what a frame of them costs, over their number.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use glam::{DVec3, Vec2};
use hullform::gpu::Cut;
use hullform::mesh::Model;
use hullform::method::{IsolationOptions, METHODS, Method, Pass, to_ptex};
use hullform::subdivision::LimitSurface;
use hullform::tessellation::{Domain, Spacing};
use plotters::prelude::*;
use serde_json::Value;

use super::figure::{Curves, Results};
use super::make::name;
use super::run::{self, Words};
use crate::options::{Global, Shape, Triangulate};
use crate::{model, output};

/// Segments of a face's edge.
const LEVELS: [u32; 5] = [1, 2, 4, 8, 16];
const QUICK: [u32; 3] = [1, 4, 8];
/// The triangles that are looked at, of each method and level: the truth takes its time.
const TRIANGLES: usize = 4000;
const QUICK_TRIANGLES: usize = 500;

/// A method at a level.
struct Point {
    method: &'static str,
    level: u32,
    triangles: usize,
    /// The root of the mean square of the distances, over the diagonal.
    rms: f64,
    /// The greatest of them.
    maximum: f64,
    milliseconds: Option<f64>,
}

/// Measures all methods that can draw the model, and writes a plot and a table; their names.
pub fn make(curves: &Curves, words: &Words, global: &Global) -> Result<Vec<String>, String> {
    let (levels, most): (&[u32], _) = match words.quick {
        true => (&QUICK, QUICK_TRIANGLES),
        false => (&LEVELS, TRIANGLES),
    };
    let named = words.arguments(curves.model)?.remove(0);
    let shape = Shape {
        scheme: Some(curves.scheme.into()),
        triangulate: Triangulate::ShortestDiagonal,
    };
    let mesh = model::load(Some(Path::new(&named)), &shape).map_err(|error| error.to_string())?;
    let model = Model::new(mesh);
    let truth = LimitSurface::new(model.mesh());
    let mut points = Vec::new();
    for method in METHODS {
        for &level in levels {
            points.extend(measure(method, &model, &truth, [level as usize, most]));
        }
    }
    let costs = costs(curves, &named, levels, words, global)?;
    for point in &mut points {
        let row = costs.row("bench", point.method, Some(f64::from(point.level)), None);
        point.milliseconds = row.and_then(|row| costs.milliseconds("bench", row));
    }
    let device = costs.0["bench"]["device"].as_str().unwrap_or_default();
    let title = format!("{}, {}, {device}", name(Path::new(&named)), curves.scheme);
    let drawn = svg(&title, &points).map_err(|error| error.to_string())?;
    let stem = format!("methods-{}", curves.name);
    let mut names = Vec::new();
    for (ending, text) in [("svg", drawn), ("csv", table(&points))] {
        let path = words.output.join(format!("{stem}.{ending}"));
        let written = output::replace(&path, text.as_bytes());
        written.map_err(|error| format!("{}: {error}", path.display()))?;
        names.push(name(&path));
    }
    Ok(names)
}

/// What frames cost, from patterns: so a level has as many triangles whatever cuts them.
fn costs(
    curves: &Curves,
    named: &str,
    levels: &[u32],
    words: &Words,
    global: &Global,
) -> Result<Results, String> {
    let levels: Vec<String> = levels.iter().map(u32::to_string).collect();
    let frames = if words.quick { "2" } else { "5" };
    let arguments = [
        "bench",
        named,
        "--scheme",
        curves.scheme,
        "--backend",
        "pattern",
        "--residence",
        "cache",
        "--levels",
        &levels.join(","),
        "--frames",
        frames,
    ];
    let arguments = arguments.map(String::from);
    let value: Value = run::run(global, &arguments, &[], true)?;
    Ok(Results([("bench", value)].into()))
}

/// The distance between the middles of triangles and the limit there, of so many triangles at most; None where the method refuses the model.
fn measure(
    method: &Method,
    model: &Model,
    truth: &LimitSurface,
    [level, most]: [usize; 2],
) -> Option<Point> {
    let isolation = IsolationOptions {
        level: IsolationOptions::level_for(level as f32),
        ..IsolationOptions::default()
    };
    let prepared = method.prepare(model, isolation).ok()?;
    let controls = prepared.controls(model.positions());
    let triangles: Vec<(&Pass, usize, [Vec2; 3])> = prepared
        .passes
        .iter()
        .flat_map(|pass| (0..pass.patches.len()).map(move |patch| (pass, patch)))
        .flat_map(|(pass, patch)| {
            let cut = Cut {
                level: level as f32,
                spacing: Spacing::Equal,
            };
            let levels = cut.levels(pass, patch);
            let segments = levels.map_or(0, |levels| levels.inside as u32);
            lattice(pass.domain, segments)
                .into_iter()
                .map(move |corners| (pass, patch, corners))
        })
        .collect();
    let step = triangles.len().div_ceil(most).max(1);
    // A stride that shares nothing with the size of a patch would do; an odd one nearly does.
    let chosen: Vec<_> = triangles.iter().step_by(step | 1).collect();
    let places: Vec<(usize, [f64; 2])> = chosen
        .iter()
        .map(|(pass, patch, corners)| {
            let record = &pass.patches[*patch];
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let uv = to_ptex(record, middle.to_array());
            (record.ptex as usize, uv.map(f64::from))
        })
        .collect();
    let (mut squares, mut maximum, mut count) = (0.0, 0.0f64, 0);
    for ((pass, patch, corners), sample) in chosen.into_iter().zip(truth.evaluate_all(&places)) {
        let Some(sample) = sample else { continue };
        let at = |uv: &Vec2| pass.evaluate(&controls, *patch, *uv).position.as_dvec3();
        let middle = corners.iter().map(at).sum::<DVec3>() / 3.0;
        let right = model.placement().local(sample.position);
        let distance = middle.distance(right) / model.diagonal().max(f64::MIN_POSITIVE);
        squares += distance * distance;
        maximum = maximum.max(distance);
        count += 1;
    }
    (count > 0).then(|| Point {
        method: method.name,
        level: level as u32,
        triangles: triangles.len(),
        rms: (squares / f64::from(count)).sqrt(),
        maximum,
        milliseconds: None,
    })
}

/// The triangles of a patch whose edges have so many segments.
fn lattice(domain: Domain, segments: u32) -> Vec<[Vec2; 3]> {
    let at = |i: u32, j: u32| Vec2::new(i as f32, j as f32) / segments as f32;
    let mut triangles = Vec::new();
    for j in 0..segments {
        let row = match domain {
            Domain::Quads => segments,
            Domain::Triangles => segments - j,
        };
        for i in 0..row {
            triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if domain == Domain::Quads || i + 1 < row {
                triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    triangles
}

fn table(points: &[Point]) -> String {
    let mut text = String::from("method,level,triangles,rms,maximum,milliseconds\n");
    for point in points {
        let milliseconds = point
            .milliseconds
            .map_or(String::new(), |ms| ms.to_string());
        let _ = writeln!(
            text,
            "{},{},{},{:e},{:e},{milliseconds}",
            point.method, point.level, point.triangles, point.rms, point.maximum
        );
    }
    text
}

/// Whole decades of errors, and of costs above them: both in one plot with lines that do not cross.
struct Decades {
    errors: [f64; 2],
    costs: [f64; 2],
}

impl Decades {
    fn of(points: &[Point]) -> Decades {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = values
                .filter(|&value| value > 0.0)
                .fold((f64::INFINITY, 0.0f64), |(low, high), x| {
                    (low.min(x), high.max(x))
                });
            match low.is_finite() {
                true => [low.log10().floor(), (high.log10().floor() + 1.0)],
                false => [0.0, 1.0],
            }
        };
        Decades {
            errors: range(&mut points.iter().map(|point| point.rms)),
            costs: range(&mut points.iter().filter_map(|point| point.milliseconds)),
        }
    }

    /// What both axes show: a decade is as long on either.
    fn axes(&self) -> [std::ops::Range<f64>; 2] {
        let all = self.errors[1] - self.errors[0] + self.costs[1] - self.costs[0];
        let of = |low: f64| 10f64.powf(low)..10f64.powf(low + all);
        [of(self.errors[0]), of(self.costs[1] - all)]
    }
}

const WIDTH: u32 = 1100;
const HEIGHT: u32 = 760;
/// Of the names of methods, beside the plot.
const NAMES: u32 = 120;
const FONT: (&str, u32) = ("sans-serif", 15);

/// Errors and costs in one plot, all axes logarithmic: two lines a method, that of its costs dashed.
fn svg(title: &str, points: &[Point]) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (WIDTH, HEIGHT)).into_drawing_area();
        root.fill(&WHITE)?;
        let root = root.titled(title, ("sans-serif", 18))?;
        let (plotted, names) = root.split_horizontally(WIDTH - NAMES);
        let drawn: Vec<(usize, &str)> = (0..)
            .zip(METHODS.iter().map(|method| method.name))
            .filter(|(_, name)| points.iter().any(|point| point.method == *name))
            .collect();
        plot(&plotted, points, &drawn)?;
        for (place, &(number, name)) in (0..).zip(&drawn) {
            let y = 30 + 24 * place;
            let line = vec![(4, y), (28, y)];
            names.draw(&PathElement::new(line, colour(number).stroke_width(3)))?;
            names.draw(&Text::new(name, (34, y - 8), ("sans-serif", 16)))?;
        }
        root.present()?;
    }
    Ok(text)
}

/// A method's.
fn colour(number: usize) -> RGBAColor {
    Palette99::pick(number).to_rgba()
}

fn plot(
    area: &DrawingArea<SVGBackend, plotters::coord::Shift>,
    points: &[Point],
    drawn: &[(usize, &str)],
) -> Result<(), Box<dyn Error>> {
    let triangles = || points.iter().map(|point| point.triangles as f64);
    let most = triangles().fold(10.0, f64::max) * 1.2;
    let across = triangles().fold(most, f64::min) / 1.2..most;
    let [errors, costs] = Decades::of(points).axes();
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .right_y_label_area_size(70)
        .build_cartesian_2d(across.clone().log_scale(), errors.log_scale())?
        .set_secondary_coord(across.log_scale(), costs.log_scale());
    let power = |value: &f64| format!("1e{:.0}", value.log10());
    chart
        .configure_mesh()
        .x_desc("triangles")
        .y_desc("distance from the limit over the diagonal, RMS (full lines)")
        .y_label_formatter(&power)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .x_labels(5)
        .light_line_style(TRANSPARENT)
        .label_style(FONT)
        .draw()?;
    chart
        .configure_secondary_axes()
        .y_desc("milliseconds a frame, the least (dashed)")
        .y_label_formatter(&power)
        .label_style(FONT)
        .draw()?;
    for &(number, name) in drawn {
        let style = colour(number).stroke_width(2);
        let line = |value: fn(&Point) -> Option<f64>| -> Vec<(f64, f64)> {
            let own = points.iter().filter(|point| point.method == name);
            own.filter_map(|point| Some((point.triangles as f64, value(point)?)))
                .filter(|&(_, value)| value > 0.0)
                .collect()
        };
        let errors = line(|point| Some(point.rms));
        chart.draw_series(LineSeries::new(errors, style).point_size(3))?;
        let costs = line(|point| point.milliseconds);
        chart.draw_secondary_series(DashedLineSeries::new(costs.clone(), 6, 4, style))?;
        let dots = costs.into_iter().map(|at| Circle::new(at, 3, style));
        chart.draw_secondary_series(dots)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_below_costs_and_decades_are_as_long() {
        let point = |rms, milliseconds| Point {
            method: METHODS[0].name,
            level: 1,
            triangles: 2,
            rms,
            maximum: rms,
            milliseconds,
        };
        let points = [point(3e-5, Some(20.0)), point(4e-3, Some(150.0))];
        let [errors, costs] = Decades::of(&points).axes();
        let place = |range: &std::ops::Range<f64>, value: f64| {
            (value / range.start).log10() / (range.end / range.start).log10()
        };
        assert!(place(&errors, 4e-3) < place(&costs, 20.0));
        assert!(place(&errors, 3e-5) > 0.0 && place(&costs, 150.0) < 1.0);
        let decades = [&errors, &costs].map(|range| (range.end / range.start).log10());
        assert!((decades[0] - decades[1]).abs() < 1e-9, "{decades:?}");
    }

    #[test]
    fn lattices_cover_their_domain() {
        for (domain, area, each) in [(Domain::Quads, 1.0, 2), (Domain::Triangles, 0.5, 1)] {
            let triangles = lattice(domain, 4);
            assert_eq!(triangles.len(), each * 16);
            let of = |[a, b, c]: &[Vec2; 3]| 0.5 * (b - a).perp_dot(c - a);
            assert!(triangles.iter().all(|triangle| of(triangle) > 0.0));
            assert!((triangles.iter().map(of).sum::<f32>() - area).abs() < 1e-6);
        }
    }
}
